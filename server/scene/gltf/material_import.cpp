#include "server/scene/gltf/material_import.h"

#include <algorithm>
#include <cmath>

namespace mirage::gltf {
namespace {

constexpr double kMaxEmission = 1e6;
constexpr double kMaxUvTransform = 1e6;
constexpr double kMaxIor = 1e3;

Wrap wrap_mode(int mode) {
  switch (mode) {
    case TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE:
      return Wrap::kClamp;
    case TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT:
      return Wrap::kMirror;
    default:
      return Wrap::kRepeat;
  }
}

AlphaMode alpha_mode(const std::string& mode) {
  if (mode == "MASK") return AlphaMode::kMask;
  if (mode == "BLEND") return AlphaMode::kBlend;
  return AlphaMode::kOpaque;
}

double element(const std::vector<double>& values, std::size_t i, double fallback) {
  return i < values.size() ? values[i] : fallback;
}

double number_or(const tinygltf::Value& object, const char* key, double fallback) {
  if (!object.IsObject() || !object.Has(key)) return fallback;
  const tinygltf::Value& value = object.Get(key);
  return value.IsNumber() ? value.GetNumberAsDouble() : fallback;
}

double pair_element(const tinygltf::Value& object, const char* key, int i, double fallback) {
  if (!object.IsObject() || !object.Has(key)) return fallback;
  const tinygltf::Value& list = object.Get(key);
  if (!list.IsArray() || list.ArrayLen() <= static_cast<std::size_t>(i) || !list.Get(i).IsNumber())
    return fallback;
  return list.Get(i).GetNumberAsDouble();
}

/// Returns the strength of KHR_materials_anisotropy in the file; 0 if there is none to draw.
double strength_of_grain(const tinygltf::Material& material) {
  const auto found = material.extensions.find("KHR_materials_anisotropy");
  if (found == material.extensions.end()) return 0;
  if (material.extensions.contains("KHR_materials_unlit")) return 0;
  return number_or(found->second, "anisotropyStrength", 0);
}

/// Returns the angle in 0..kMaxGrainRotation radians: the grain looks the same after half a turn.
float half_turn(double radians) {
  const double pi = std::acos(-1.0);
  const double rest = std::fmod(radians, pi);
  return static_cast<float>(rest < 0 ? rest + pi : rest);
}

}  // namespace

const tinygltf::Material& MaterialImporter::source_of(int gltf_material) const {
  static const tinygltf::Material kDefault;
  return gltf_material < 0 ? kDefault : document_.model.materials[gltf_material];
}

const Material& MaterialImporter::as_in_file(int gltf_material) {
  const auto found = converted_.find(gltf_material);
  if (found != converted_.end()) return found->second;
  return converted_.emplace(gltf_material, convert(source_of(gltf_material))).first->second;
}

std::uint32_t MaterialImporter::index_of(int gltf_material, Without without, const UvPlan& plan) {
  without.anisotropy = without.anisotropy && strength_of_grain(source_of(gltf_material)) > 0;
  // The specification requires tangents, or a normal map, whose frame follows texture coordinates.
  // Any invented frame would have visible seams.
  if (without.anisotropy) tally_.add("primitives without tangents drawn without anisotropy");
  const auto [entry, is_new] = material_index_.try_emplace({gltf_material, without, plan}, 0u);
  if (!is_new) return entry->second;
  Material material = as_in_file(gltf_material);
  material.unlit = material.unlit || without.lighting;
  if (without.anisotropy) {
    material.lobes.anisotropy = material.lobes.anisotropy_rotation = 0;
    material.lobes.map(LobeMap::kAnisotropy) = {};
  }
  tally_.add("textures of a third set of texture coordinates left out", apply(plan, material));
  entry->second = static_cast<std::uint32_t>(materials_.size());
  materials_.push_back(material);
  return entry->second;
}

Result<std::vector<Image>> MaterialImporter::take_images(const Workers& workers) {
  auto images = images_.take(workers);
  if (!images) return images;
  for (Material& material : materials_) {
    material.each_map([&](TextureRef& ref) {
      if (ref.present() && !images_.readable(ref.image)) ref = TextureRef{};
    });
  }
  return images;
}

float MaterialImporter::factor(double value, double low, double high, double fallback) {
  if (!std::isfinite(value)) value = fallback;
  const double clamped = std::clamp(value, low, high);
  if (clamped != value) tally_.add("material factors out of range clamped");
  return static_cast<float>(clamped);
}

Material MaterialImporter::convert(const tinygltf::Material& source) {
  Material out;
  const auto& pbr = source.pbrMetallicRoughness;
  for (int i = 0; i < 4; ++i)
    out.base_color[i] = factor(element(pbr.baseColorFactor, i, 1), 0, 1, 1);
  out.metallic = factor(pbr.metallicFactor, 0, 1, 1);
  out.roughness = factor(pbr.roughnessFactor, 0, 1, 1);
  double strength = 1;
  if (const auto ext = source.extensions.find("KHR_materials_emissive_strength");
      ext != source.extensions.end()) {
    strength = number_or(ext->second, "emissiveStrength", 1);
  }
  for (int i = 0; i < 3; ++i) {
    out.emissive[i] = factor(element(source.emissiveFactor, i, 0) * strength, 0, kMaxEmission, 0);
  }
  out.normal_scale = factor(source.normalTexture.scale, -1e3, 1e3, 1);
  out.occlusion_strength = factor(source.occlusionTexture.strength, 0, 1, 1);
  out.alpha_cutoff = factor(source.alphaCutoff, 0, 1e3, 0.5);
  out.alpha_mode = alpha_mode(source.alphaMode);
  out.double_sided = source.doubleSided;
  out.unlit = source.extensions.contains("KHR_materials_unlit");

  auto ref = [this](const auto& info, bool srgb) {
    return texture(info.extensions, info.index, info.texCoord, srgb);
  };
  out.base_color_map = ref(pbr.baseColorTexture, true);
  out.metal_rough_map = ref(pbr.metallicRoughnessTexture, false);
  if (const auto ext = source.extensions.find("KHR_materials_pbrSpecularGlossiness");
      ext != source.extensions.end()) {
    apply_spec_gloss(ext->second, out);
  }
  out.normal_map = ref(source.normalTexture, false);
  out.occlusion_map = ref(source.occlusionTexture, false);
  out.emissive_map = ref(source.emissiveTexture, true);
  if (!out.unlit) read_lobes(source, out.lobes);
  // Transmission is drawn as blending, because a tile does not know the scene behind it.
  if (out.lobes.transmission > 0) out.alpha_mode = AlphaMode::kBlend;
  return out;
}

void MaterialImporter::read_lobes(const tinygltf::Material& source, Lobes& out) {
  static const tinygltf::Value kNone;
  const auto extension = [&](const char* name) -> const tinygltf::Value& {
    const auto found = source.extensions.find(name);
    return found == source.extensions.end() ? kNone : found->second;
  };
  const auto share = [&](const tinygltf::Value& of, const char* key, double plain) {
    return factor(number_or(of, key, plain), 0, 1, plain);
  };
  const auto color = [&](const tinygltf::Value& of, const char* key, double plain, double most) {
    glm::vec3 rgb;
    for (int i = 0; i < 3; ++i) rgb[i] = factor(pair_element(of, key, i, plain), 0, most, plain);
    return rgb;
  };
  const tinygltf::Value& specular = extension("KHR_materials_specular");
  out.specular = share(specular, "specularFactor", 1);
  out.specular_color = color(specular, "specularColorFactor", 1, 1e3);
  out.map(LobeMap::kSpecular) = lobe_map(specular, "specularTexture", false);
  out.map(LobeMap::kSpecularColor) = lobe_map(specular, "specularColorTexture", true);
  // The specification uses 0 for total reflection.
  const double ior = number_or(extension("KHR_materials_ior"), "ior", 1.5);
  out.ior = ior == 0 ? static_cast<float>(kMaxIor) : factor(ior, 1, kMaxIor, 1.5);
  const tinygltf::Value& coat = extension("KHR_materials_clearcoat");
  out.clearcoat = share(coat, "clearcoatFactor", 0);
  out.clearcoat_roughness = share(coat, "clearcoatRoughnessFactor", 0);
  out.map(LobeMap::kClearcoat) = lobe_map(coat, "clearcoatTexture", false);
  out.map(LobeMap::kClearcoatRoughness) = lobe_map(coat, "clearcoatRoughnessTexture", false);
  out.map(LobeMap::kClearcoatNormal) = lobe_map(coat, "clearcoatNormalTexture", false);
  const tinygltf::Value& sheen = extension("KHR_materials_sheen");
  out.sheen_color = color(sheen, "sheenColorFactor", 0, 1);
  out.sheen_roughness = share(sheen, "sheenRoughnessFactor", 0);
  out.map(LobeMap::kSheenColor) = lobe_map(sheen, "sheenColorTexture", true);
  const tinygltf::Value& through = extension("KHR_materials_transmission");
  out.transmission = share(through, "transmissionFactor", 0);
  out.map(LobeMap::kTransmission) = lobe_map(through, "transmissionTexture", false);
  const tinygltf::Value& volume = extension("KHR_materials_volume");
  // Beer's law over the stated thickness, the same for all directions.
  const double thickness = number_or(volume, "thicknessFactor", 0);
  const double distance = number_or(volume, "attenuationDistance", 0);
  if (thickness > 0 && distance > 0) {
    const glm::vec3 left = color(volume, "attenuationColor", 1, 1);
    out.volume_tint = glm::pow(left, glm::vec3(static_cast<float>(thickness / distance)));
  }
  const tinygltf::Value& grain = extension("KHR_materials_anisotropy");
  out.anisotropy = share(grain, "anisotropyStrength", 0);
  out.anisotropy_rotation = half_turn(number_or(grain, "anisotropyRotation", 0));
  out.map(LobeMap::kAnisotropy) = lobe_map(grain, "anisotropyTexture", false);
  const bool unread = (sheen.IsObject() && sheen.Has("sheenRoughnessTexture")) ||
                      (volume.IsObject() && volume.Has("thicknessTexture"));
  if (unread) tally_.add("sheen roughness and thickness textures read as their factors");
}

TextureRef MaterialImporter::lobe_map(const tinygltf::Value& extension, const char* key,
                                      bool srgb) {
  if (!extension.IsObject() || !extension.Has(key)) return {};
  const tinygltf::Value& info = extension.Get(key);
  tinygltf::ExtensionMap extensions;
  if (info.Has("extensions")) {
    const tinygltf::Value& of = info.Get("extensions");
    for (const std::string& name : of.Keys()) extensions[name] = of.Get(name);
  }
  return texture(extensions, static_cast<int>(number_or(info, "index", -1)),
                 static_cast<int>(number_or(info, "texCoord", 0)), srgb);
}

TextureRef MaterialImporter::texture(const tinygltf::ExtensionMap& extensions, int texture,
                                     int uv_set, bool srgb) {
  int image = -1;
  TextureRef ref = place(extensions, texture, uv_set, image);
  if (image >= 0) ref.image = images_.index_of(image, srgb);
  return ref;
}

TextureRef MaterialImporter::place(const tinygltf::ExtensionMap& extensions, int texture,
                                   int uv_set, int& found) {
  TextureRef ref;
  if (texture < 0) return ref;
  const tinygltf::Texture& source = document_.model.textures[texture];
  int image = source.source;
  if (const auto webp = source.extensions.find("EXT_texture_webp");
      image < 0 && webp != source.extensions.end()) {
    image = static_cast<int>(number_or(webp->second, "source", -1));
  }
  if (image < 0) {
    tally_.add("textures without a readable source left out");
    return ref;
  }
  if (document_.images[static_cast<std::size_t>(image)].missing()) return ref;  // already reported
  apply_sampler(source.sampler, ref);
  apply_transform(extensions, ref, uv_set);
  ref.uv_set = static_cast<std::uint8_t>(std::clamp(uv_set, 0, 255));
  found = image;
  return ref;
}

void MaterialImporter::apply_sampler(int sampler, TextureRef& ref) const {
  if (sampler < 0) return;
  const tinygltf::Sampler& source = document_.model.samplers[sampler];
  ref.wrap_s = wrap_mode(source.wrapS);
  ref.wrap_t = wrap_mode(source.wrapT);
  ref.nearest = source.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
}

void MaterialImporter::apply_transform(const tinygltf::ExtensionMap& extensions, TextureRef& ref,
                                       int& uv_set) {
  const auto found = extensions.find("KHR_texture_transform");
  if (found == extensions.end()) return;
  const tinygltf::Value& transform = found->second;
  const double limit = kMaxUvTransform;
  for (int i = 0; i < 2; ++i) {
    ref.offset[i] = factor(pair_element(transform, "offset", i, 0), -limit, limit, 0);
    ref.scale[i] = factor(pair_element(transform, "scale", i, 1), -limit, limit, 1);
  }
  ref.rotation = factor(number_or(transform, "rotation", 0), -limit, limit, 0);
  uv_set = static_cast<int>(number_or(transform, "texCoord", uv_set));
}

}  // namespace mirage::gltf
