#pragma once
// The drawable content of an object: mesh, materials, images. Both ends agree on it because the
// server renders tiles from it and may send it whole as geometry.

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace mirage {

/// One interleaved vertex, 64 bytes, uploaded as it is.
struct Vertex {
  glm::vec3 position{0};          ///< object space, metres
  glm::vec3 normal{0, 0, 1};      ///< object space, unit length
  glm::vec4 tangent{1, 0, 0, 1};  ///< xyz unit length, w = bitangent sign
  glm::vec2 uv0{0};
  glm::vec2 uv1{0};
  glm::u16vec4 color{65535};  ///< linear RGBA, unorm16
};
static_assert(sizeof(Vertex) == 64);

enum class PrimitiveKind : std::uint8_t { kTriangles, kLines, kPoints };

/// A run of `indices` drawn with one material. Strips, fans and loops are expanded on import.
struct Primitive {
  PrimitiveKind kind = PrimitiveKind::kTriangles;
  std::uint32_t first_index = 0;
  std::uint32_t index_count = 0;
  std::uint32_t material = 0;
};

struct Mesh {
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;
  std::vector<Primitive> primitives;
};

enum class Wrap : std::uint8_t { kRepeat, kClamp, kMirror };

/// A texture as a material sees it: image, coordinates, transform (KHR_texture_transform), sampler.
struct TextureRef {
  std::int32_t image = -1;  ///< index into the image list; -1: none
  std::uint8_t uv_set = 0;  ///< 0 or 1
  Wrap wrap_s = Wrap::kRepeat;
  Wrap wrap_t = Wrap::kRepeat;
  bool nearest = false;  ///< magnification filter NEAREST
  glm::vec2 offset{0};
  glm::vec2 scale{1};
  float rotation = 0;  ///< radians, counter-clockwise as in KHR_texture_transform

  bool present() const { return image >= 0; }
};

enum class AlphaMode : std::uint8_t { kOpaque, kMask, kBlend };

/// Texture maps of lobes, each with the components that are read.
enum class LobeMap : std::uint8_t {
  kSpecular,            ///< A
  kSpecularColor,       ///< sRGB
  kClearcoat,           ///< R
  kClearcoatRoughness,  ///< G
  kClearcoatNormal,     ///< tangent space
  kSheenColor,          ///< sRGB
  kTransmission,        ///< R
  kAnisotropy,          ///< RG: direction in tangent space, -1 to 1; B: share of the strength
};
inline constexpr std::size_t kLobeMaps = 8;
/// Radians. A larger rotation repeats: the grain has no sign.
inline constexpr float kMaxGrainRotation = 3.1415927f;

/// Lobes that KHR_materials_* extensions add to metal-rough; the defaults add nothing. Factors are
/// linear.
struct Lobes {
  float specular = 1;           ///< strength of a dielectric's reflection, 0 to 1
  glm::vec3 specular_color{1};  ///< colour of that reflection at normal incidence
  float ior = 1.5f;             ///< >= 1
  float clearcoat = 0;          ///< share covered, 0 to 1
  float clearcoat_roughness = 0;
  glm::vec3 sheen_color{0};
  float sheen_roughness = 0;
  float transmission = 0;    ///< share of the unreflected light that passes through, 0 to 1
  glm::vec3 volume_tint{1};  ///< share of that light left after passing through the volume
  /// KHR_materials_anisotropy: the strength, 0 to 1, by which the surface is rougher along the
  /// tangent than across. The rotation turns that direction from the tangent towards the bitangent,
  /// 0 to kMaxGrainRotation.
  float anisotropy = 0;
  float anisotropy_rotation = 0;
  std::array<TextureRef, kLobeMaps> maps;

  TextureRef& map(LobeMap which) { return maps[static_cast<std::size_t>(which)]; }
  const TextureRef& map(LobeMap which) const { return maps[static_cast<std::size_t>(which)]; }
};

/// glTF 2.0 metallic-roughness material; factors are linear.
struct Material {
  glm::vec4 base_color{1};
  glm::vec3 emissive{0};
  float metallic = 1;
  float roughness = 1;
  float normal_scale = 1;
  float occlusion_strength = 1;
  float alpha_cutoff = 0.5f;
  AlphaMode alpha_mode = AlphaMode::kOpaque;
  bool double_sided = false;
  bool unlit = false;
  TextureRef base_color_map;
  TextureRef metal_rough_map;  ///< G = roughness, B = metallic
  TextureRef normal_map;       ///< tangent space
  TextureRef occlusion_map;    ///< R
  TextureRef emissive_map;
  Lobes lobes;

  /// True if it is drawn with the tangents of its vertices.
  bool reads_tangents() const {
    return normal_map.present() || lobes.map(LobeMap::kClearcoatNormal).present() ||
           lobes.anisotropy > 0;
  }
  /// Calls `visit` for each map, present or not: the five above, then those of lobes.
  template <typename Visit>
  void each_map(const Visit& visit) {
    each_map_of(*this, visit);
  }
  template <typename Visit>
  void each_map(const Visit& visit) const {
    each_map_of(*this, visit);
  }

 private:
  template <typename Self, typename Visit>
  static void each_map_of(Self& m, const Visit& visit) {
    for (auto* map : {&m.base_color_map, &m.metal_rough_map, &m.normal_map, &m.occlusion_map,
                      &m.emissive_map}) {
      visit(*map);
    }
    for (auto& map : m.lobes.maps) visit(map);
  }
};

/// 8-bit RGBA pixels, first row at v = 0 (the top row of a glTF image).
struct Image {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  bool srgb = true;  ///< colour (decode to linear on sampling) or data
  std::vector<std::uint8_t> rgba;
};

}  // namespace mirage
