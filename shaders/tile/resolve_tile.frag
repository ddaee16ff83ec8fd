// Resolves a supersampled tile to its place in the page. Colour is averaged in linear light. Depth
// is that of the nearest covered sample as a code 1..255, 0: no content. The code is hyperbolic
// over the object's depth range, like the capture projection's depth buffer. FACTOR: samples of a
// texel each way.
//
// RELIT adds the surface as tile.h describes it. SHADOW writes the share of the texel's light that
// shadows leave, in place of depth. CASTER makes a texel present or absent; an ordered dither keeps
// the coverage of partly filled texels.
precision highp float;
precision highp int;
uniform sampler2D u_color;
uniform sampler2D u_depth;
uniform ivec2 u_origin;  // of the tile in the page
precise layout(location = 0) out vec4 o_color;
precise layout(location = 1) out vec4 o_depth;
#ifdef RELIT
uniform sampler2D u_normal;    // in the object's space
uniform sampler2D u_material;  // metallic, roughness, occlusion
uniform vec3 u_right;          // capture basis
uniform vec3 u_up;
precise layout(location = 2) out vec4 o_surface;

#include "common/octahedral.glsl"

// `normal` is the mean over the covered samples; the more they differ, the shorter it is.
vec4 surface_code(vec3 normal, vec3 material) {
  vec3 about = vec3(dot(normal, u_right), dot(normal, u_up), dot(normal, cross(u_right, u_up)));
  float l = length(about);
  vec2 map = octahedral(l > 1e-3 ? about / l : vec3(0.0, 0.0, 1.0));
  float metal = floor(material.x * 8.0 + 0.5);
  float kind = metal > 0.0 ? 7.0 + metal : floor((1.0 - min(l, 1.0)) * 7.0 + 0.5);
  float both = kind * 16.0 + floor(material.z * 15.0 + 0.5);
  return vec4(map * 0.5 + 0.5, material.y, both / 255.0);
}
#endif

#ifdef BLENDED
uniform sampler2D u_range;  // of blended surfaces: 1 less the nearest depth, the farthest; 0: none
// number of codes behind its depth at which the texel still shows something
precise layout(location = 2) out vec4 o_behind;
#endif
#ifdef SHADOW
uniform sampler2D u_darkened;
#endif
#ifdef CASTER
#include "common/dither.glsl"
#endif

void main() {
  ivec2 base = (ivec2(gl_FragCoord.xy) - u_origin) * FACTOR;
  vec4 sum = vec4(0.0);
  float nearest = 2.0;
#ifdef BLENDED
  float front = 2.0, back = -1.0;  // range of samples that show a blended surface
#endif
#ifdef RELIT
  vec3 normal = vec3(0.0), material = vec3(0.0);
#endif
#ifdef SHADOW
  vec3 darkened = vec3(0.0);
#endif
  for (int y = 0; y < FACTOR; ++y) {
    for (int x = 0; x < FACTOR; ++x) {
      vec4 c = texelFetch(u_color, base + ivec2(x, y), 0);
      sum += c;
      float depth = texelFetch(u_depth, base + ivec2(x, y), 0).r;
#ifdef BLENDED
      vec2 range = texelFetch(u_range, base + ivec2(x, y), 0).rg;
      if (range.r > 0.0) {
        front = min(front, 1.0 - range.r);
        back = max(back, depth < 1.0 ? depth : range.g);
        depth = 1.0 - range.r;
      }
#endif
      nearest = min(nearest, c.a > 0.0 ? depth : 2.0);
#ifdef RELIT
      normal += texelFetch(u_normal, base + ivec2(x, y), 0).xyz;
      material += texelFetch(u_material, base + ivec2(x, y), 0).xyz;
#endif
#ifdef SHADOW
      darkened += texelFetch(u_darkened, base + ivec2(x, y), 0).rgb;
#endif
    }
  }
  o_color = sum / float(FACTOR * FACTOR);
#ifdef RELIT
  o_surface = sum.a > 0.0 ? surface_code(normal / sum.a, material / sum.a) : vec4(0.0);
#endif
  // Faint blended texels have no depth; they count as the middle of the range.
  float d = nearest >= 1.0 ? 0.5 : nearest;
  float code = nearest > 1.5 ? 0.0 : 1.0 + floor(clamp(d, 0.0, 1.0) * 254.0 + 0.5);
#ifdef SHADOW
  const vec3 kLuminance = vec3(0.2126, 0.7152, 0.0722);
  float whole = dot(sum.rgb, kLuminance);
  float left = whole > 1e-5 ? clamp(dot(darkened, kLuminance) / whole, 0.0, 1.0) : 1.0;
  // The light is rounded to 64 steps, because noise of foliage is most of the bytes sent.
  code = sum.a > 0.0 ? 1.0 + floor(floor(left * 63.0 + 0.5) / 63.0 * 254.0 + 0.5) : 0.0;
#endif
#ifdef CASTER
  if (dithered_away(ivec2(gl_FragCoord.xy) - u_origin, o_color.a)) code = 0.0;
  code = min(floor(code / 4.0) * 4.0 + 2.0, 254.0) * sign(code);  // 64 steps, for the same reason
  o_color = vec4(code > 0.0 ? 1.0 : 0.0);
#endif
  o_depth = vec4(code / 255.0);
#ifdef BLENDED
  o_behind = vec4(back < 0.0 ? 0.0 : ceil(clamp(back - d, 0.0, 1.0) * 254.0) / 255.0);
#endif
#ifdef FINE_DEPTH
  // Writes all bits of the depth buffer, for proofs; 0: no content.
  uint fine = code > 0.0 ? 1u + uint(clamp(d, 0.0, 1.0) * 16777213.0 + 0.5) : 0u;
  o_depth.rgb = vec3(fine >> 16u, (fine >> 8u) & 255u, fine & 255u) / 255.0;
#endif
}
