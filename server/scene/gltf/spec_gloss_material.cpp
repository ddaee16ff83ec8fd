// The part of MaterialImporter that reads KHR_materials_pbrSpecularGlossiness.
#include "server/scene/gltf/material_import.h"
#include "server/scene/gltf/spec_gloss.h"

namespace mirage::gltf {
namespace {

double number_at(const tinygltf::Value& object, const char* key, int i, double fallback) {
  if (!object.Has(key)) return fallback;
  const tinygltf::Value& value = object.Get(key);
  const tinygltf::Value& element = value.IsArray() ? value.Get(i) : value;
  return element.IsNumber() ? element.GetNumberAsDouble() : fallback;
}

bool same_place(const TextureRef& a, const TextureRef& b) {
  return a.uv_set == b.uv_set && a.offset == b.offset && a.scale == b.scale &&
         a.rotation == b.rotation && a.wrap_s == b.wrap_s && a.wrap_t == b.wrap_t;
}

}  // namespace

MaterialImporter::PlacedTexture MaterialImporter::placed(const tinygltf::Value& object,
                                                         const char* key) {
  PlacedTexture out;
  if (!object.Has(key)) return out;
  const tinygltf::Value& info = object.Get(key);
  tinygltf::ExtensionMap extensions;
  if (info.Has("extensions")) extensions = info.Get("extensions").Get<tinygltf::Value::Object>();
  const auto index = static_cast<int>(number_at(info, "index", 0, -1));
  const auto uv_set = static_cast<int>(number_at(info, "texCoord", 0, 0));
  out.ref = place(extensions, index, uv_set, out.image);
  return out;
}

void MaterialImporter::apply_spec_gloss(const tinygltf::Value& source, Material& out) {
  SpecGloss factors;
  for (int i = 0; i < 4; ++i) {
    factors.diffuse[i] = factor(number_at(source, "diffuseFactor", i, 1), 0, 1, 1);
  }
  for (int i = 0; i < 3; ++i) {
    factors.specular[i] = factor(number_at(source, "specularFactor", i, 1), 0, 1, 1);
  }
  factors.glossiness = factor(number_at(source, "glossinessFactor", 0, 1), 0, 1, 1);
  const PlacedTexture diffuse = placed(source, "diffuseTexture");
  const PlacedTexture specular = placed(source, "specularGlossinessTexture");

  const MetalRough plain =
      metal_rough_of(glm::vec3(factors.diffuse), factors.specular, factors.glossiness);
  out.base_color = glm::vec4(plain.base, factors.diffuse.w);
  out.metallic = plain.metallic;
  out.roughness = plain.roughness;
  out.base_color_map = out.metal_rough_map = TextureRef{};
  if (diffuse.image < 0 && specular.image < 0) return;
  if (specular.image < 0 && never_metal(factors.specular)) {
    out.base_color_map = diffuse.ref;
    out.base_color_map.image = images_.index_of(diffuse.image, true);
    return;
  }
  const bool both = diffuse.image >= 0 && specular.image >= 0;
  if (both && !same_place(diffuse.ref, specular.ref)) {
    // The textures are placed differently, so texels do not correspond. Base colour is the diffuse
    // colour, and the metalness is that of the mean.
    tally_.add("specular-glossiness textures that lie otherwise than the diffuse one approximated");
    out.base_color_map = diffuse.ref;
    out.base_color_map.image = images_.index_of(diffuse.image, true);
    out.base_color = factors.diffuse;
    out.metal_rough_map = specular.ref;
    out.metal_rough_map.image = images_.converted(-1, specular.image, factors).metal_rough;
  } else {
    const auto images = images_.converted(diffuse.image, specular.image, factors);
    out.base_color_map = out.metal_rough_map = diffuse.image >= 0 ? diffuse.ref : specular.ref;
    out.base_color_map.image = images.base;
    out.metal_rough_map.image = images.metal_rough;
    out.base_color = glm::vec4(1, 1, 1, factors.diffuse.w);
  }
  out.metallic = out.roughness = 1;
}

}  // namespace mirage::gltf
