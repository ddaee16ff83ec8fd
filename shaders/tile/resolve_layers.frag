// Resolves a supersampled tile and the content behind its floor (layer_floor.frag) to its place in
// the page, as two layers. The front shows the samples above the floor. If samples of the tile are
// below the floor, the layer behind shows those, so that front over behind is the result of
// resolve_tile.frag. Elsewhere it shows everything that the front hides. A texel of the layer
// behind holds five bits a colour, four of coverage and the depth code. FACTOR: samples of a texel
// each way.
precision highp float;
precision highp int;
uniform sampler2D u_color;
uniform sampler2D u_depth;
uniform sampler2D u_floor;
uniform sampler2D u_behind_color;
uniform sampler2D u_behind_depth;
uniform ivec2 u_origin;  // of the tile in the page
precise layout(location = 0) out vec4 o_color;
precise layout(location = 1) out vec4 o_depth;
precise layout(location = 2) out vec4 o_behind;

float code_of(float depth) { return 1.0 + floor(clamp(depth, 0.0, 1.0) * 254.0 + 0.5); }

vec3 srgb_from_linear(vec3 c) {
  return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, greaterThan(c, vec3(0.0031308)));
}

void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy) - u_origin;
  ivec2 base = texel * FACTOR;
  float bottom = texelFetch(u_floor, texel, 0).r;
  vec4 front = vec4(0.0), open = vec4(0.0), hidden = vec4(0.0);
  float nearest = 2.0, open_nearest = 2.0, hidden_nearest = 2.0, fronts = 0.0;
  for (int y = 0; y < FACTOR; ++y) {
    for (int x = 0; x < FACTOR; ++x) {
      ivec2 at = base + ivec2(x, y);
      vec4 c = texelFetch(u_color, at, 0), b = texelFetch(u_behind_color, at, 0);
      float depth = texelFetch(u_depth, at, 0).r;
      if (c.a > 0.0 && depth <= bottom) {
        front += c;
        fronts += 1.0;
        nearest = min(nearest, depth);
      } else if (c.a > 0.0) {
        open += c;
        open_nearest = min(open_nearest, depth);
      }
      hidden += b;
      hidden_nearest = min(hidden_nearest, b.a > 0.0 ? texelFetch(u_behind_depth, at, 0).r : 2.0);
    }
  }
  const float kSamples = float(FACTOR * FACTOR);
  o_color = front / kSamples;
  o_depth = vec4(nearest > 1.5 ? 0.0 : code_of(nearest) / 255.0);
  bool is_open = open.a > 0.0;
  vec4 behind = is_open ? open / (kSamples - fronts) : hidden / kSamples;
  float code = is_open ? open_nearest : hidden_nearest;
  code = code > 1.5 ? 0.0 : code_of(code);
  vec3 color = floor(srgb_from_linear(clamp(behind.rgb, 0.0, 1.0)) * 31.0 + 0.5);
  float cover = code > 0.0 ? clamp(floor(behind.a * 15.0 + 0.5), 1.0, 15.0) : 0.0;
  float high = floor(cover / 2.0);
  o_behind = vec4(color * 8.0 + vec3(high, (cover - 2.0 * high) * 4.0, 0.0), code) / 255.0;
}
