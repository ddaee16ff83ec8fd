// Shades a relit tile's texel with the equations of the mesh. Lights and positions are relative to
// the eye in world axes, as for meshes: one set for all impostors.
#define SPREAD
#include "common/lighting.glsl"
#include "common/octahedral.glsl"

uniform sampler2DArray u_surface;

// The surface data of a tile, filtered and blended like colour.
struct Stored {
  vec2 normal;     // octahedral about the axis towards the capture eye
  float roughness;
  vec3 rest;       // metallic, occlusion, spread of the normals
};

Stored stored_surface(vec2 texel, float layer) {
  vec4 s = textureLod(u_surface, vec3(texel / vec2(textureSize(u_surface, 0).xy), layer), 0.0);
  // The byte holds two numbers, so it must not be filtered.
  float both = floor(texelFetch(u_surface, ivec3(texel, layer), 0).a * 255.0 + 0.5);
  float kind = floor(both / 16.0);
  vec3 rest = vec3(max(kind - 7.0, 0.0) / 8.0, (both - 16.0 * kind) / 15.0,
                   kind < 7.5 ? kind / 7.0 : 0.0);
  return Stored(s.xy * 2.0 - 1.0, s.z, rest);
}

// `color` is premultiplied base colour; `position` is relative to the eye; `right` and `up` are the
// capture basis, turned to the world by `rotation`.
vec4 relit(vec4 color, Stored stored, vec3 position, vec3 right, vec3 up, vec4 rotation) {
  if (color.a <= 0.0) return color;
  vec3 about = from_octahedral(stored.normal);
  vec3 normal = right * about.x + up * about.y + cross(right, up) * about.z;
  Surface s;
  s.position = position;
  s.normal = rotate(rotation, normal);
  s.albedo = color.rgb / color.a;
  s.metallic = stored.rest.x;
  s.roughness = stored.roughness;
  s.occlusion = stored.rest.y;
  s.spread = stored.rest.z;
#ifdef SHADOW
  s.sun = 1.0;  // the shadow tile that it wears darkens it (worn_shadow.glsl)
#endif
  return vec4(shown(shade(s)) * color.a, color.a);
}
