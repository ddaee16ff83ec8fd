#pragma once
// Need scenes: small scenes for need analysis: a ball of 8 x 12 facets with every attribute, and
// changes that may be neutral.

#include <functional>
#include <string>
#include <vector>

#include "server/prepare/prepared_scene.h"

namespace mirage::test {

/// Returns 2 x 2 texels of one value; `odd` replaces the last texel.
inline Image small_image(glm::u8vec4 value, glm::u8vec4 odd, bool srgb) {
  Image image;
  image.width = image.height = 2;
  image.srgb = srgb;
  for (int i = 0; i < 4; ++i) {
    const glm::u8vec4 texel = i == 3 ? odd : value;
    for (int c = 0; c < 4; ++c) image.rgba.push_back(texel[c]);
  }
  return image;
}
inline Image solid_image(glm::u8vec4 value, bool srgb) { return small_image(value, value, srgb); }

inline Mesh ball() {
  constexpr int kRings = 8, kSides = 12;
  Mesh mesh;
  for (int y = 0; y <= kRings; ++y) {
    for (int x = 0; x <= kSides; ++x) {
      const float a = 6.2831853f * static_cast<float>(x) / kSides;
      const float b = 3.1415927f * static_cast<float>(y) / kRings;
      Vertex v;
      v.normal = {std::sin(b) * std::cos(a), std::cos(b), std::sin(b) * std::sin(a)};
      v.position = v.normal * 0.7f;
      v.tangent = glm::vec4(-std::sin(a), 0, std::cos(a), 1);
      v.uv0 = {static_cast<float>(x) / kSides, static_cast<float>(y) / kRings};
      mesh.vertices.push_back(v);
    }
  }
  for (std::uint32_t y = 0; y < kRings; ++y) {
    for (std::uint32_t x = 0; x < kSides; ++x) {
      const std::uint32_t i = y * (kSides + 1) + x, below = i + kSides + 1;
      mesh.indices.insert(mesh.indices.end(), {i, i + 1, below, i + 1, below + 1, below});
    }
  }
  mesh.primitives = {
      {PrimitiveKind::kTriangles, 0, static_cast<std::uint32_t>(mesh.indices.size()), 0}};
  return mesh;
}

/// Returns one ball of a reddish material, half rough and half metal, under a sun.
inline Scene ball_scene() {
  Scene scene;
  scene.name = "ball";
  scene.objects.push_back({"ball", ball()});
  Material m;
  m.base_color = {0.7f, 0.4f, 0.3f, 1};
  m.metallic = 0.5f;
  m.roughness = 0.6f;
  scene.materials = {m};
  scene.instances.resize(1);
  Light sun;
  sun.color = {0.6f, 0.55f, 0.5f};
  sun.direction = glm::normalize(glm::vec3(-0.4f, -0.8f, -0.3f));
  scene.lighting.ambient = glm::vec3(0.2f);
  scene.lighting.lights = {sun};
  return scene;
}

using Change = std::function<void(Scene&)>;

/// Returns a change that gives the ball an image as one of its maps.
inline Change with_map(TextureRef Material::*map, Image image) {
  return [=](Scene& scene) {
    scene.images.push_back(image);
    (scene.materials[0].*map).image = static_cast<std::int32_t>(scene.images.size()) - 1;
  };
}

inline std::shared_ptr<const PreparedScene> prepared(const std::vector<Change>& changes) {
  Scene scene = ball_scene();
  for (const Change& change : changes) change(scene);
  return prepare_scene(std::move(scene), {.keep_imported = true}).take();
}

struct NamedChange {
  const char* name;
  NeedRule rule;
  Change change;
};

/// Changes that add nothing: no pixel, no key, no byte.
inline std::vector<NamedChange> neutral_changes() {
  const auto white = [](bool srgb) { return solid_image({255, 255, 255, 255}, srgb); };
  return {
      {"blending with an alpha of 1", NeedRule::kBlending,
       [](Scene& s) { s.materials[0].alpha_mode = AlphaMode::kBlend; }},
      {"an alpha test that all passes", NeedRule::kBlending,
       [](Scene& s) { s.materials[0].alpha_mode = AlphaMode::kMask; }},
      {"a white base colour map", NeedRule::kSolidColor,
       with_map(&Material::base_color_map, white(true))},
      {"a white metal-rough map", NeedRule::kMaps,
       with_map(&Material::metal_rough_map, white(false))},
      {"a normal map of scale 0", NeedRule::kMaps,
       [](Scene& s) {
         with_map(&Material::normal_map, solid_image({200, 90, 220, 255}, false))(s);
         s.materials[0].normal_scale = 0;
       }},
      {"a white occlusion map", NeedRule::kMaps, with_map(&Material::occlusion_map, white(false))},
      {"an occlusion map of strength 0", NeedRule::kMaps,
       [](Scene& s) {
         with_map(&Material::occlusion_map, solid_image({90, 90, 90, 255}, false))(s);
         s.materials[0].occlusion_strength = 0;
       }},
      {"an emissive map of factor 0", NeedRule::kEmission,
       with_map(&Material::emissive_map, solid_image({90, 200, 90, 255}, true))},
      {"a black emissive map", NeedRule::kEmission,
       [](Scene& s) {
         with_map(&Material::emissive_map, solid_image({0, 0, 0, 255}, true))(s);
         s.materials[0].emissive = glm::vec3(1);
       }},
      {"lobes of factor 0, and a dark one", NeedRule::kExtensions,
       [](Scene& s) {
         Lobes& l = s.materials[0].lobes;
         l.clearcoat_roughness = 0.4f;
         l.sheen_roughness = 0.7f;
         l.volume_tint = {0.2f, 0.9f, 0.4f};
         l.transmission = 0.8f;
         l.anisotropy_rotation = 0.6f;
         s.images.push_back(solid_image({0, 90, 90, 255}, false));
         l.map(LobeMap::kTransmission).image = static_cast<std::int32_t>(s.images.size()) - 1;
         s.images.push_back(solid_image({40, 60, 90, 255}, false));
         l.map(LobeMap::kClearcoat).image = static_cast<std::int32_t>(s.images.size()) - 1;
       }},
      {"a grain of strength 0 in every texel", NeedRule::kExtensions,
       [](Scene& s) {
         Lobes& l = s.materials[0].lobes;
         l.anisotropy = 0.9f;
         l.anisotropy_rotation = 0.6f;
         s.images.push_back(solid_image({200, 90, 0, 255}, false));
         l.map(LobeMap::kAnisotropy).image = static_cast<std::int32_t>(s.images.size()) - 1;
       }},
      {"white maps of reflection", NeedRule::kExtensions,
       [=](Scene& s) {
         s.images.push_back(solid_image({9, 9, 9, 255}, false));
         s.materials[0].lobes.map(LobeMap::kSpecular).image =
             static_cast<std::int32_t>(s.images.size()) - 1;
         s.images.push_back(white(true));
         s.materials[0].lobes.map(LobeMap::kSpecularColor).image =
             static_cast<std::int32_t>(s.images.size()) - 1;
       }},
      {"texture coordinates nobody reads", NeedRule::kAttributes,
       [](Scene& s) {
         for (Vertex& v : s.objects[0].mesh.vertices) v.uv1 = v.uv0 * 3.0f;
       }},
      {"an image nobody uses", NeedRule::kMaps,
       [](Scene& s) {
         s.images.push_back(solid_image({1, 2, 3, 4}, true));
       }},
  };
}

/// A change that is nearly neutral but shows, and what leaving it out would do.
struct NeededChange {
  const char* name;
  NeedRule rule;
  Change change, left_out;
};

inline std::vector<NeededChange> needed_changes() {
  const auto nearly = [](bool srgb) {
    return small_image({255, 255, 255, 255}, {250, 250, 250, 255}, srgb);
  };
  const auto drop = [](TextureRef Material::*map) {
    return [=](Scene& s) { s.materials[0].*map = {}; };
  };
  const Change opaque = [](Scene& s) { s.materials[0].alpha_mode = AlphaMode::kOpaque; };
  return {
      {"blending", NeedRule::kBlending,
       [](Scene& s) {
         s.materials[0].alpha_mode = AlphaMode::kBlend;
         s.materials[0].base_color.a = 0.99f;
       },
       opaque},
      {"alpha test", NeedRule::kBlending,
       [](Scene& s) {
         with_map(&Material::base_color_map,
                  small_image({255, 255, 255, 255}, {255, 255, 255, 0}, true))(s);
         s.materials[0].alpha_mode = AlphaMode::kMask;
       },
       opaque},
      {"base colour map", NeedRule::kSolidColor, with_map(&Material::base_color_map, nearly(true)),
       drop(&Material::base_color_map)},
      {"metal-rough map", NeedRule::kMaps, with_map(&Material::metal_rough_map, nearly(false)),
       drop(&Material::metal_rough_map)},
      {"normal map", NeedRule::kMaps,
       with_map(&Material::normal_map, solid_image({131, 128, 255, 255}, false)),
       drop(&Material::normal_map)},
      {"occlusion map", NeedRule::kMaps, with_map(&Material::occlusion_map, nearly(false)),
       drop(&Material::occlusion_map)},
      {"emissive map", NeedRule::kEmission,
       [=](Scene& s) {
         with_map(&Material::emissive_map, solid_image({0, 0, 60, 255}, true))(s);
         s.materials[0].emissive = glm::vec3(1);
       },
       [](Scene& s) {
         s.materials[0].emissive_map = {};
         s.materials[0].emissive = glm::vec3(0);
       }},
      {"clearcoat", NeedRule::kExtensions, [](Scene& s) { s.materials[0].lobes.clearcoat = 0.2f; },
       [](Scene& s) { s.materials[0].lobes.clearcoat = 0; }},
      {"sheen", NeedRule::kExtensions,
       [](Scene& s) {
         s.materials[0].lobes.sheen_color = {0, 0, 0.1f};
       },
       [](Scene& s) { s.materials[0].lobes.sheen_color = glm::vec3(0); }},
      {"transmission", NeedRule::kExtensions,
       [](Scene& s) {
         s.materials[0].lobes.transmission = 0.1f;
         s.materials[0].alpha_mode = AlphaMode::kBlend;
       },
       [](Scene& s) {
         s.materials[0].lobes.transmission = 0;
         s.materials[0].alpha_mode = AlphaMode::kOpaque;
       }},
      {"anisotropy", NeedRule::kExtensions,
       [](Scene& s) { s.materials[0].lobes.anisotropy = 0.3f; },
       [](Scene& s) { s.materials[0].lobes.anisotropy = 0; }},
      {"rotation of the grain", NeedRule::kExtensions,
       [](Scene& s) {
         s.materials[0].lobes.anisotropy = 0.3f;
         s.materials[0].lobes.anisotropy_rotation = 0.2f;
       },
       [](Scene& s) { s.materials[0].lobes.anisotropy_rotation = 0; }},
      {"a grain of strength 0 in all texels but one", NeedRule::kExtensions,
       [](Scene& s) {
         s.materials[0].lobes.anisotropy = 1;
         s.images.push_back(small_image({255, 128, 0, 255}, {255, 128, 255, 255}, false));
         s.materials[0].lobes.map(LobeMap::kAnisotropy).image =
             static_cast<std::int32_t>(s.images.size()) - 1;
       },
       [](Scene& s) { s.materials[0].lobes.anisotropy = 0; }},
      {"index of refraction", NeedRule::kExtensions,
       [](Scene& s) { s.materials[0].lobes.ior = 1.7f; },
       [](Scene& s) { s.materials[0].lobes.ior = 1.5f; }},
      {"specular map", NeedRule::kExtensions,
       [](Scene& s) {
         s.images.push_back(small_image({9, 9, 9, 255}, {9, 9, 9, 0}, false));
         s.materials[0].lobes.map(LobeMap::kSpecular).image =
             static_cast<std::int32_t>(s.images.size()) - 1;
       },
       [](Scene& s) { s.materials[0].lobes.map(LobeMap::kSpecular) = {}; }},
      {"vertex colours", NeedRule::kAttributes,
       [](Scene& s) {
         s.objects[0].mesh.vertices[30].color = {60000, 60000, 60000, 65535};
       },
       [](Scene& s) { s.objects[0].mesh.vertices[30].color = glm::u16vec4(65535); }},
      {"lighting", NeedRule::kLighting, [](Scene&) {},
       [](Scene& s) { s.materials[0].unlit = true; }},
      {"a lamp that reaches", NeedRule::kLights,
       [](Scene& s) {
         Light lamp;
         lamp.kind = LightKind::kPoint;
         lamp.color = glm::vec3(0.5f);
         lamp.position = {0, 2, 0};
         lamp.range = 1.9f;
         s.lighting.lights.push_back(lamp);
       },
       [](Scene& s) { s.lighting.lights.pop_back(); }},
      {"a spot whose cone grazes it", NeedRule::kLights,
       [](Scene& s) {
         Light spot;
         spot.kind = LightKind::kSpot;
         spot.color = glm::vec3(20.0f);
         spot.position = {0, 3, 0};
         spot.direction = glm::normalize(glm::vec3(0.35f, -1, 0));
         spot.cos_inner = 0.995f;
         spot.cos_outer = 0.97f;
         s.lighting.lights.push_back(spot);
       },
       [](Scene& s) { s.lighting.lights.pop_back(); }},
  };
}

}  // namespace mirage::test
