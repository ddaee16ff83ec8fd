#pragma once
// Turns glTF materials, textures and samplers into Material and Image lists.

#include <compare>
#include <cstdint>
#include <map>
#include <string_view>
#include <tuple>
#include <vector>

#include "protocol/model/model.h"
#include "server/scene/gltf/document.h"
#include "server/scene/gltf/image_import.h"
#include "server/scene/gltf/tally.h"
#include "server/scene/gltf/uv_plan.h"

namespace mirage::gltf {

/// Features that a primitive cannot be drawn with. It uses a copy of its material without them.
struct Without {
  bool lighting = false;    ///< points and lines without normals (glTF §3.7.2.1)
  bool anisotropy = false;  ///< no tangents, and nothing to make them from
  auto operator<=>(const Without&) const = default;
};

/// Converts materials, and requests their images, at first use. Materials that no drawn primitive
/// uses cost nothing.
class MaterialImporter {
 public:
  MaterialImporter(const Document& document, Tally& tally)
      : document_(document), tally_(tally), images_(document, tally) {}

  /// A glTF material as the file has it, -1 for the default one. Its maps name sets of texture
  /// coordinates by their number in the file. Valid until the next call.
  const Material& as_in_file(int gltf_material);
  /// Returns the index into materials() of a glTF material for a primitive with these features and
  /// sets of texture coordinates.
  std::uint32_t index_of(int gltf_material, Without without, const UvPlan& plan);

  const std::vector<Material>& materials() const { return materials_; }
  std::vector<Material> take_materials() { return std::move(materials_); }
  /// Decodes the images; call it before take_materials(). Materials whose images are unreadable
  /// lose these maps, as in other viewers. Errors: those of ImageImporter::take().
  Result<std::vector<Image>> take_images(const Workers& workers);

 private:
  const tinygltf::Material& source_of(int gltf_material) const;
  Material convert(const tinygltf::Material& source);
  /// A texture's placement and its image in the file; -1: there is none to draw.
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
  std::map<int, Material> converted_;  ///< by glTF index
  std::map<std::tuple<int, Without, UvPlan>, std::uint32_t> material_index_;
};

}  // namespace mirage::gltf
