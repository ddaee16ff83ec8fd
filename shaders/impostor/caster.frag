// Writes the stored depth of a caster tile, along the light of the map.
precision highp float;
precision highp int;
precision highp sampler2DArray;
in vec2 v_texel;
in vec2 v_tangent;
flat in vec4 v_center_scale;
flat in vec4 v_right_distance;
flat in vec4 v_up_near;
flat in vec2 v_far_layer;

uniform sampler2DArray u_codes;
uniform mat4 u_clip_from_relative;

PRECISE_BUILT_IN(gl_FragDepth)

void main() {
  float code = floor(texelFetch(u_codes, ivec3(v_texel, v_far_layer.y), 0).r * 255.0 + 0.5);
  if (code < 0.5) discard;
  float near = v_up_near.w, far = v_far_layer.x;
  float z = near * far / (far - (code - 1.0) / 254.0 * (far - near));
  vec3 right = v_right_distance.xyz, up = v_up_near.xyz, ahead = -cross(right, up);
  vec3 p = (right * v_tangent.x + up * v_tangent.y) * z + ahead * (z - v_right_distance.w);
  vec4 clip = u_clip_from_relative * vec4(v_center_scale.xyz + v_center_scale.w * p, 1.0);
  gl_FragDepth = clamp(clip.z * 0.5 + 0.5, 0.0, 1.0);
}
