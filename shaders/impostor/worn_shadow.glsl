// The shadow tile that an impostor wears. Any capture of the instance will do, because its texels
// are found by the points they show.
uniform highp sampler2DArray u_shadow;
// share that full shadow takes of each colour, relative to that of luminance
uniform vec3 u_shadow_tint;
// from the axes of the point to the capture axes (right, up, towards its eye)
flat in vec4 v_shadow_rotation;
flat in vec4 v_shadow_view;      // distance Dc, texels per tangent, texel of tangent 0, 0
flat in vec4 v_shadow_place;     // first texel of the crop, its size (w + 4096 h), layer; -1: none

// `color` is premultiplied, without shadow; `point` is relative to the centre in object units.
vec4 shadowed(vec4 color, vec3 point) {
  if (v_shadow_place.w < 0.0) return color;
  vec3 p = rotate(vec4(-v_shadow_rotation.xyz, v_shadow_rotation.w), point);
  float z = max(v_shadow_view.x - p.z, 1e-6);
  vec2 texel = v_shadow_view.zw + vec2(p.x, -p.y) * (v_shadow_view.y / z);
  float h = floor(v_shadow_place.z / 4096.0);
  vec2 size = vec2(v_shadow_place.z - 4096.0 * h, h);
  texel = clamp(texel, v_shadow_place.xy, v_shadow_place.xy + size);
  vec2 uv = texel / vec2(textureSize(u_shadow, 0).xy);
  float left = textureLod(u_shadow, vec3(uv, v_shadow_place.w), 0.0).r;
  return vec4(color.rgb * max(1.0 - u_shadow_tint * (1.0 - left), 0.0), color.a);
}
