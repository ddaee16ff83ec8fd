// Resolves a supersampled frame of a bake to its place in a strip of frames, as floats. Colour is
// averaged premultiplied and linear, normals and materials over the covered samples. Depth is that
// of the nearest covered sample. FACTOR: samples of a texel each way.
precision highp float;
precision highp int;
uniform sampler2D u_color;
uniform sampler2D u_normal;    // in the drawn space
uniform sampler2D u_material;  // metallic, roughness, occlusion
uniform sampler2D u_depth;     // orthographic: 0 at the near end of the sphere, 1 at its far end
uniform sampler2D u_fronts;    // the same of blended surfaces, for where u_depth has nothing
uniform ivec2 u_origin;        // of the frame in the strip
precise layout(location = 0) out vec4 o_color;
precise layout(location = 1) out vec4 o_normal;
precise layout(location = 2) out vec4 o_material;
precise layout(location = 3) out vec4 o_height;  // above the plane through the centre, in radii

void main() {
  ivec2 base = (ivec2(gl_FragCoord.xy) - u_origin) * FACTOR;
  vec4 color = vec4(0.0);
  vec3 normal = vec3(0.0), material = vec3(0.0);
  float nearest = 2.0;
  for (int y = 0; y < FACTOR; ++y) {
    for (int x = 0; x < FACTOR; ++x) {
      vec4 c = texelFetch(u_color, base + ivec2(x, y), 0);
      float depth = texelFetch(u_depth, base + ivec2(x, y), 0).r;
      if (depth == 1.0) depth = texelFetch(u_fronts, base + ivec2(x, y), 0).r;
      color += c;
      // Blended surfaces too faint to count are in the middle.
      if (c.a > 0.0) nearest = min(nearest, depth < 1.0 ? depth : 0.5);
      normal += texelFetch(u_normal, base + ivec2(x, y), 0).xyz * c.a;
      material += texelFetch(u_material, base + ivec2(x, y), 0).xyz * c.a;
    }
  }
  float l = length(normal);
  bool covered = color.a > 0.0;
  o_color = color / float(FACTOR * FACTOR);
  o_normal = vec4(covered && l > 1e-4 ? normal / l : vec3(0.0), 0.0);
  o_material = vec4(covered ? material / color.a : vec3(0.0, 1.0, 1.0), 0.0);
  o_height = vec4(nearest > 1.5 ? 0.0 : 1.0 - 2.0 * nearest);
}
