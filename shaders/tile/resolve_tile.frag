// Supersampled tile -> its place in the page: colour averaged in linear light, depth of the nearest covered
// sample as a code 1..255 (hyperbolic over the object's depth range, which is what the capture
// projection's depth buffer holds), 0 where nothing is.
precision highp float;
precision highp int;
uniform sampler2D u_color;
uniform sampler2D u_depth;
uniform int u_factor;
uniform ivec2 u_origin;  // of the tile in the page
layout(location = 0) out vec4 o_color;
layout(location = 1) out vec4 o_depth;

void main() {
  ivec2 base = (ivec2(gl_FragCoord.xy) - u_origin) * u_factor;
  vec4 sum = vec4(0.0);
  float nearest = 2.0;
  for (int y = 0; y < u_factor; ++y) {
    for (int x = 0; x < u_factor; ++x) {
      vec4 c = texelFetch(u_color, base + ivec2(x, y), 0);
      sum += c;
      if (c.a > 0.0) nearest = min(nearest, texelFetch(u_depth, base + ivec2(x, y), 0).r);
    }
  }
  o_color = sum / float(u_factor * u_factor);
  // Blended surfaces write no depth: they count as lying in the middle of the range.
  float d = nearest >= 1.0 ? 0.5 : nearest;
  float code = nearest > 1.5 ? 0.0 : 1.0 + floor(clamp(d, 0.0, 1.0) * 254.0 + 0.5);
  o_depth = vec4(code / 255.0);
}
