#pragma once
// glTF materials, textures and samplers -> Material and Image lists.

#include <compare>
#include <cstdint>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include "protocol/model/model.h"
#include "server/scene/gltf/document.h"
#include "server/scene/gltf/image_import.h"
#include "server/scene/gltf/tally.h"

namespace mirage::gltf {

/// What a primitive cannot be drawn with, so that it takes a copy of its material without.
struct Without {
  bool lighting = false;    ///< points and lines without normals (glTF §3.7.2.1)
  bool anisotropy = false;  ///< without tangents, and nothing to make them of
  auto operator<=>(const Without&) const = default;
};

/// Materials are converted, and their images asked for, when first used: what no drawn primitive
/// uses costs nothing.
class MaterialImporter {
 public:
  MaterialImporter(const Document& document, Tally& tally)
      : document_(document), tally_(tally), images_(document, tally) {}

  /// Index into materials() of a glTF material, -1 for the default one.
  std::uint32_t index_of(int gltf_material, Without without);

  const std::vector<Material>& materials() const { return materials_; }
  std::vector<Material> take_materials() { return std::move(materials_); }
  /// Before take_materials(): those whose images turn out unreadable lose these maps, as in other
  /// viewers. Errors: those of ImageImporter::take().
  Result<std::vector<Image>> take_images(const Workers& workers);

 private:
  Material convert(const tinygltf::Material& source);
  /// Where a texture lies, and its image in the file: -1 if there is none to draw.
  struct PlacedTexture {
    TextureRef ref;
    int image = -1;
  };
  PlacedTexture placed(const tinygltf::Value& object, const char* key);
  void apply_spec_gloss(const tinygltf::Value& source, Material& out);
  TextureRef place(const tinygltf::ExtensionMap& extensions, int texture, int uv_set, int& image);
  TextureRef texture(const tinygltf::ExtensionMap& extensions, int texture, int uv_set, bool srgb);
  void apply_sampler(int sampler, TextureRef& ref) const;
  void apply_transform(const tinygltf::ExtensionMap& extensions, TextureRef& ref, int& uv_set);
  void read_lobes(const tinygltf::Material& source, Lobes& out);
  TextureRef lobe_map(const tinygltf::Value& extension, const char* key, bool srgb);
  float factor(double value, double low, double high, double fallback);

  const Document& document_;
  Tally& tally_;
  std::vector<Material> materials_;
  ImageImporter images_;
  std::map<std::pair<int, Without>, std::uint32_t> material_index_;
};

}  // namespace mirage::gltf
