// Resolves a supersampled reference to display size. Colour is averaged in linear light. Depth (eye
// depth in metres, 0 = none) and id + 1 are those of the sample at (factor/2, factor/2), for the
// geometric error.
precision highp float;
precision highp int;
precision highp usampler2D;
uniform sampler2D u_color;
uniform sampler2D u_depth;
uniform usampler2D u_id;
uniform int u_factor;
uniform vec2 u_window_depth;  // window depth = x + y / eye depth
uniform float u_farthest;     // window depth where nothing is drawn
precise layout(location = 0) out vec4 o_color;
precise layout(location = 1) out float o_depth;
precise layout(location = 2) out uint o_id;

void main() {
  ivec2 base = ivec2(gl_FragCoord.xy) * u_factor;
  vec4 sum = vec4(0.0);
  for (int y = 0; y < u_factor; ++y) {
    for (int x = 0; x < u_factor; ++x) sum += texelFetch(u_color, base + ivec2(x, y), 0);
  }
  o_color = sum / float(u_factor * u_factor);
  ivec2 at = base + ivec2(u_factor / 2);
  float d = texelFetch(u_depth, at, 0).r;
  o_depth = d == u_farthest ? 0.0 : u_window_depth.y / (d - u_window_depth.x);
  o_id = d == u_farthest ? 0u : texelFetch(u_id, at, 0).r + 1u;
}
