// Lays a picture into what somebody else has drawn, by depth. Where the picture shows no object, it
// is as far away as the depth of the target can say.
precision highp float;
precision highp sampler2D;
uniform sampler2D u_color;  // linear light, premultiplied; alpha: share that objects cover
uniform sampler2D u_depth;
uniform vec2 u_corner;      // of the picture in the target, px
uniform vec2 u_texels;      // of the picture in a pixel of the target
uniform vec2 u_own;         // window depth in u_depth = x + y / eye depth
uniform vec4 u_host;        // the same of the target; z: half the logarithmic factor, 0: none; w: the farthest
uniform int u_background;   // 1: the picture has one, and hides everything behind it
uniform int u_encode;       // 1: as sRGB values
precise layout(location = 0) out vec4 o_color;

vec3 encoded(vec3 c) {  // IEC 61966-2-1
  vec3 power = 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055;
  return mix(power, 12.92 * c, lessThanEqual(c, vec3(0.0031308)));
}

// Where a soft outline covers a pixel in part, its one sample of depth may be of nothing: the nearest one around counts then.
float eye_depth(ivec2 at) {
  float nothing = u_own.y > 0.0 ? 0.0 : 1.0;  // reversed or forward
  ivec2 last = textureSize(u_depth, 0) - 1;
  float there = texelFetch(u_depth, at, 0).r;
  bool none = there == nothing;
  for (int i = 0; i < 9 && none; ++i) {
    float around = texelFetch(u_depth, clamp(at + ivec2(i % 3, i / 3) - 1, ivec2(0), last), 0).r;
    there = nothing > 0.5 ? min(there, around) : max(there, around);
  }
  return u_own.y / (there - u_own.x);
}

void main() {
  vec2 at = (gl_FragCoord.xy - u_corner) * u_texels;
  vec4 c = u_texels == vec2(1.0) ? texelFetch(u_color, ivec2(at), 0)
                                 : texture(u_color, at / vec2(textureSize(u_color, 0)));
  if (u_background == 0 && c.a <= 0.0) discard;
  if (u_encode == 1) {
    float cover = u_background == 1 ? 1.0 : c.a;
    c.rgb = encoded(c.rgb / cover) * cover;
  }
  o_color = u_background == 1 ? vec4(c.rgb, 1.0) : c;
  if (c.a <= 0.0) {
    gl_FragDepth = u_host.w;
    return;
  }
  float d = eye_depth(ivec2(at));
  gl_FragDepth = clamp(u_host.z > 0.0 ? u_host.z * log2(1.0 + d) : u_host.x + u_host.y / d, 0.0, 1.0);
}
