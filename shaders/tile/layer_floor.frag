// Writes the floor of each texel's front layer: the nearest depth of its samples plus a step, one
// texel of the target each. FACTOR: samples of a texel each way.
precision highp float;
precision highp int;
uniform sampler2D u_depth;
uniform float u_step;  // window depth
precise layout(location = 0) out float o_floor;  // at least 1 if there is nothing

void main() {
  ivec2 base = ivec2(gl_FragCoord.xy) * FACTOR;
  float nearest = 1.0;
  for (int y = 0; y < FACTOR; ++y) {
    for (int x = 0; x < FACTOR; ++x) {
      nearest = min(nearest, texelFetch(u_depth, base + ivec2(x, y), 0).r);
    }
  }
  o_floor = nearest + u_step;
}
