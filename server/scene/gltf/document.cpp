#include "server/scene/gltf/document.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "server/scene/gltf/decompress.h"
#include "server/scene/gltf/file_guard.h"
#include "server/scene/gltf/gltf_limits.h"
#include "server/scene/gltf/json_extensions.h"
#include "server/scene/gltf/json_read.h"
#include "server/scene/gltf/json_schema.h"
#include "server/scene/gltf/model_check.h"
#include "server/scene/gltf/uri_loader.h"

namespace mirage::gltf {
namespace {

using nlohmann::json;

constexpr std::string_view kSupportedExtensions[] = {
    "KHR_texture_transform",
    "KHR_mesh_quantization",
    "KHR_lights_punctual",
    "KHR_materials_unlit",
    "EXT_mesh_gpu_instancing",
    "KHR_materials_emissive_strength",
    "EXT_texture_webp",
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    "KHR_materials_variants",
    "KHR_texture_basisu",
    "CESIUM_RTC",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_specular",
    "KHR_materials_ior",
    "KHR_materials_clearcoat",
    "KHR_materials_sheen",
    "KHR_materials_transmission",
    "KHR_materials_volume",
    "KHR_materials_anisotropy",
    "KHR_node_visibility",
    "KHR_animation_pointer",
};

/// Extensions that say nothing about the picture: properties, copyrights, features to select.
constexpr std::string_view kMetadata[] = {
    "KHR_xmp",           "KHR_xmp_json_ld",      "EXT_structural_metadata",
    "EXT_mesh_features", "EXT_feature_metadata", "EXT_instance_features",
};

bool is_metadata(std::string_view extension) {
  return std::find(std::begin(kMetadata), std::end(kMetadata), extension) != std::end(kMetadata);
}

bool is_supported(std::string_view extension) {
  return std::find(std::begin(kSupportedExtensions), std::end(kSupportedExtensions), extension) !=
         std::end(kSupportedExtensions);
}

/// Checked before the rest of the schema. A file of another version, or with an unsupported
/// extension, may break the rules of plain glTF 2.0, and the error should name the real reason.
Result<void> check_version_and_extensions(json& root, Tally& tally) {
  if (root.contains("geometricError") && root.contains("root")) {
    return make_error(ErrorId::kSceneFormat, "not a glTF file: a tileset of 3D Tiles",
                      "open one of the .glb files that it names");
  }
  const auto asset = root.find("asset");
  if (asset == root.end() || !asset->is_object()) {
    return make_error(ErrorId::kSceneFormat, "asset is missing or no object");
  }
  for (const char* key : {"version", "minVersion"}) {
    const auto version = asset->find(key);
    if (version == asset->end()) continue;
    if (version->is_number() && *version == 2.0) {
      auto ok =
          tally.forgive("versions written as a number",
                        make_error(ErrorId::kSceneFormat, std::string("asset.") + key + " is " +
                                                              version->dump() + ", need \"2.0\""));
      if (!ok) return ok;
      *version = "2.0";
    }
    const bool is_two =
        version->is_string() && version->get_ref<const std::string&>().starts_with("2.");
    const bool is_newer = std::string_view(key) == "minVersion" && is_two && *version != "2.0";
    if (!is_two || is_newer) {
      return make_error(ErrorId::kSceneFormat,
                        std::string("asset.") + key + " is " + version->dump() + ", need 2.0");
    }
  }
  std::vector<std::string> ignored;
  for (const char* list : {"extensionsRequired", "extensionsUsed"}) {
    const auto names = root.find(list);
    if (names == root.end() || !names->is_array()) continue;
    for (const json& entry : *names) {
      if (!entry.is_string()) continue;
      const auto& extension = entry.get_ref<const std::string&>();
      if (is_supported(extension) || is_metadata(extension)) continue;
      if (std::string_view(list) == "extensionsRequired") {
        // Most say how surfaces look. If nothing is left to draw, this is the reason.
        auto ok =
            tally.lose("required extensions that are not supported ignored",
                       make_error(ErrorId::kSceneExtension,
                                  "requires the unsupported extension " + extension.substr(0, 80)));
        if (!ok) return ok;
        continue;
      }
      ignored.push_back(extension.substr(0, 80));
    }
  }
  constexpr std::size_t kNamed = 16;
  std::string names;
  for (std::size_t i = 0; i < std::min(ignored.size(), kNamed); ++i) {
    names += (i > 0 ? ", " : "") + ignored[i];
  }
  if (ignored.size() > kNamed) names += " and others";
  tally.add("extensions used but not supported are ignored", ignored.size(), names);
  return {};
}

std::size_t list_size(const json& root, const char* key) {
  const auto list = root.find(key);
  return list != root.end() && list->is_array() ? list->size() : 0;
}

Result<void> check_sizes(const json& root, const SceneLimits& limits) {
  for (const char* key : {"nodes", "accessors", "bufferViews", "materials", "meshes", "images",
                          "textures", "buffers", "skins", "samplers", "cameras"}) {
    const std::size_t count = list_size(root, key);
    if (count > limits.elements) return limits.exceeded(count, limits.elements, key, "join IN OUT");
  }
  std::size_t primitives = 0;
  if (const auto meshes = root.find("meshes"); meshes != root.end()) {
    for (const json& mesh : *meshes) primitives += list_size(mesh, "primitives");
  }
  if (primitives > limits.primitives) {
    return limits.exceeded(primitives, limits.primitives, "primitives", "join IN OUT");
  }
  return {};
}

std::string take_text(json& object, const char* key) {
  const auto found = object.find(key);
  return found == object.end() ? std::string() : std::move(found->get_ref<std::string&>());
}

glm::dvec3 read_center(const json& root) {
  const json::json_pointer place("/extensions/CESIUM_RTC/center");
  glm::dvec3 center(0);
  if (!root.contains(place)) return center;
  for (int i = 0; i < 3; ++i) center[i] = root.at(place)[static_cast<std::size_t>(i)].get<double>();
  return center;
}

/// True for the content for viewers without the extension; everything in it also exists compressed.
bool is_fallback(const json& buffer) {
  const auto extensions = buffer.find("extensions");
  if (extensions == buffer.end()) return false;
  for (const char* name : kMeshoptExtensions) {
    const auto found = extensions->find(name);
    if (found != extensions->end() && found->value("fallback", false)) return true;
  }
  return false;
}

/// Fills one buffer from its URI or, for the first one, from the BIN chunk.
Result<BufferData> load_buffer(json& entry, std::size_t index, const Document& document,
                               const GltfFile& file, std::uint64_t bytes_left, Tally& tally) {
  const std::string what = "buffers[" + std::to_string(index) + "]";
  BufferData buffer;
  if (is_fallback(entry)) {
    buffer.absent = true;
    return buffer;
  }
  if (entry.contains("uri")) {
    auto bytes = load_uri(take_text(entry, "uri"), document.folder, bytes_left, what, tally);
    if (!bytes) return bytes.error();
    buffer.owned = bytes.take();
    buffer.data = buffer.owned;
  } else if (index == 0 && file.has_bin) {
    buffer.data = file.bin;
  } else {
    buffer.absent = true;
    return buffer;
  }
  const std::uint64_t there = buffer.data.size();
  buffer.length = entry.value("byteLength", there);
  if (there < buffer.length) {
    auto ok = tally.lose("buffers shorter than they say",
                         make_error(ErrorId::kSceneRange,
                                    what + ".byteLength = " + std::to_string(buffer.length) +
                                        ", only " + std::to_string(there) + " bytes are there"));
    if (!ok) return ok.error();
    buffer.length = there;
  }
  return buffer;
}

/// A buffer that cannot be had counts as absent, if another one can be had.
Result<void> leave_out_buffers(const std::vector<std::optional<Error>>& errors, Document& document,
                               Tally& tally) {
  const auto had = [](const BufferData& buffer) { return !buffer.absent; };
  for (const std::optional<Error>& error : errors) {
    if (!error) continue;
    if (std::none_of(document.buffers.begin(), document.buffers.end(), had)) return *error;
    auto ok = tally.lose("buffers that cannot be had left out", *error);
    if (!ok) return ok;
  }
  return {};
}

Result<void> load_buffers(json& root, Document& document, const GltfFile& file, Tally& tally) {
  const auto list = root.find("buffers");
  if (list == root.end()) return {};
  std::uint64_t bytes_left = document.limits.file_bytes;
  std::vector<std::optional<Error>> errors(list->size());
  for (std::size_t i = 0; i < list->size(); ++i) {
    auto buffer = load_buffer((*list)[i], i, document, file, bytes_left, tally);
    if (!buffer) {
      if (buffer.error().id == ErrorId::kSceneLimit) return buffer.error();
      errors[i] = buffer.error();
      document.buffers.push_back({});
      document.buffers.back().absent = true;
      continue;
    }
    const std::uint64_t used = buffer->owned.size();
    if (used > bytes_left) {
      const std::uint64_t limit = document.limits.file_bytes;
      return document.limits.exceeded_at_least(limit - bytes_left + used, limit,
                                               "bytes in buffers");
    }
    bytes_left -= used;
    document.buffers.push_back(buffer.take());
  }
  root.erase("buffers");
  return leave_out_buffers(errors, document, tally);
}

/// Returns a file that may be read. Errors: no such file, or one that is not read.
Result<std::filesystem::path> image_file(const std::string& uri, const Document& document,
                                         const std::string& what, Tally& tally) {
  auto path = resolve_uri(uri, document.folder, tally);
  if (!path) return make_error(path.error().id, what + ": " + path.error().text);
  std::error_code code;
  if (!std::filesystem::exists(*path, code)) {
    return make_error(ErrorId::kSceneMissing, what + ": '" + uri + "': no such file");
  }
  if (!std::filesystem::is_regular_file(*path, code)) {
    return make_error(ErrorId::kSceneUri, what + ": '" + uri + "': not a regular file");
  }
  return path;
}

/// Forgives an image that cannot be had: viewers draw the material without it.
Result<void> leave_out_image(const Error& error, Tally& tally) {
  const std::string_view what = error.id == ErrorId::kSceneMissing ? "missing image files left out"
                                : error.id == ErrorId::kSceneUri
                                    ? "images elsewhere than beside the file left out"
                                    : "images without a place left out";
  return tally.forgive(what, error);
}

/// Records where each image is. Whether a file may be read is decided now; pixels are read later.
Result<void> take_images(json& root, Document& document, Tally& tally) {
  const auto list = root.find("images");
  if (list == root.end()) return {};
  for (std::size_t i = 0; i < list->size(); ++i) {
    json& entry = (*list)[i];
    const std::string what = "images[" + std::to_string(i) + "]";
    ImageSource image{take_text(entry, "uri"), {}, entry.value("bufferView", -1)};
    if (image.uri.empty() == (image.buffer_view < 0)) {
      auto ok = leave_out_image(
          make_error(ErrorId::kSceneFormat, what + " needs either uri or bufferView"), tally);
      if (!ok) return ok;
      if (image.buffer_view >= 0) image.uri.clear();
    }
    if (!image.uri.empty() && !image.uri.starts_with("data:")) {
      auto path = image_file(image.uri, document, what, tally);
      image.uri.clear();
      if (path) {
        image.file = path.take();
      } else if (auto ok = leave_out_image(path.error(), tally); !ok) {
        return ok;
      }
    }
    document.images.push_back(std::move(image));
  }
  root.erase("images");
  return {};
}

/// tinygltf leaves omitted offsets of a sparse accessor uninitialised, so they are filled in.
void fill_sparse_defaults(json& root) {
  const auto accessors = root.find("accessors");
  if (accessors == root.end()) return;
  for (json& accessor : *accessors) {
    const auto sparse = accessor.find("sparse");
    if (sparse == accessor.end()) continue;
    for (const char* part : {"indices", "values"}) {
      json& where = (*sparse)[part];
      if (!where.contains("byteOffset")) where["byteOffset"] = 0;
    }
  }
}

/// tinygltf refuses strides that are no multiples of 4, or above 252, so they are hidden from it. A
/// stride of 0 is none.
Result<std::vector<std::size_t>> take_strides(json& root, Tally& tally) {
  std::vector<std::size_t> taken;
  const auto views = root.find("bufferViews");
  if (views == root.end()) return taken;
  for (json& view : *views) {
    const auto stride = view.value("byteStride", std::size_t{0});
    if (stride % 4 != 0 || stride > 252) {
      auto ok = tally.forgive(
          "bufferViews of a stride that glTF forbids",
          make_error(ErrorId::kSceneFormat, "bufferViews[" + std::to_string(taken.size()) +
                                                "].byteStride = " + std::to_string(stride) +
                                                " is no multiple of 4 up to 252"));
      if (!ok) return ok.error();
    }
    taken.push_back(stride);
    view.erase("byteStride");
  }
  return taken;
}

/// tinygltf refuses cameras and spot lights without the numbers that it needs.
void fill_defaults(json& root) {
  if (const auto cameras = root.find("cameras"); cameras != root.end()) {
    for (json& camera : *cameras) {
      json& lens = camera[camera["type"].get<std::string>()];
      for (const char* key : {"yfov", "znear", "zfar", "xmag", "ymag"}) {
        if (!lens.contains(key)) lens[key] = key == std::string_view("yfov") ? 0.8 : 1.0;
      }
    }
  }
  const json::json_pointer lights("/extensions/KHR_lights_punctual/lights");
  if (!root.contains(lights)) return;
  for (json& light : root[lights]) {
    if (light["type"] == "spot" && !light.contains("spot")) light["spot"] = json::object();
  }
}

/// tinygltf refuses indices without a bufferView, which are all zero, so they are hidden from it.
std::map<std::pair<std::size_t, std::size_t>, int> take_indices_without_view(json& root) {
  std::map<std::pair<std::size_t, std::size_t>, int> taken;
  const auto meshes = root.find("meshes");
  if (meshes == root.end()) return taken;
  for (std::size_t m = 0; m < meshes->size(); ++m) {
    json& primitives = (*meshes)[m]["primitives"];
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      const auto indices = primitives[p].find("indices");
      if (indices == primitives[p].end()) continue;
      const int accessor = indices->get<int>();
      if (root["accessors"][static_cast<std::size_t>(accessor)].contains("bufferView")) continue;
      taken[{m, p}] = accessor;
      primitives[p].erase(indices);
    }
  }
  return taken;
}

Result<void> parse_model(json& root, Document& document, Tally& tally) {
  const auto without_view = take_indices_without_view(root);
  const auto strides = take_strides(root, tally);
  if (!strides) return strides.error();
  fill_defaults(root);
  tinygltf::TinyGLTF loader;
  std::string error;
  std::string warning;
  bool loaded = false;
  try {
    const std::string text = root.dump();
    loaded = loader.LoadASCIIFromString(&document.model, &error, &warning, text.c_str(),
                                        static_cast<unsigned int>(text.size()), "");
  } catch (const std::exception& exception) {
    error = exception.what();
  }
  if (!loaded) return make_error(ErrorId::kSceneFormat, "not a valid glTF model: " + error);
  for (const auto& [place, accessor] : without_view) {
    document.model.meshes[place.first].primitives[place.second].indices = accessor;
  }
  for (std::size_t i = 0; i < strides->size(); ++i) {
    document.model.bufferViews[i].byteStride = (*strides)[i];
  }
  return {};
}

}  // namespace

std::span<const std::uint8_t> Document::view_bytes(int view) const {
  const tinygltf::BufferView& place = model.bufferViews[view];
  if (place.byteLength == 0) return {};
  const BufferData& buffer = buffers[place.buffer];
  if (buffer.absent) return {};
  return buffer.data.subspan(place.byteOffset, place.byteLength);
}

Result<Document> load_document(const std::string& path, const std::string& variant,
                               const SceneLimits& limits, const Workers& workers, Tally& tally) {
  auto file = open_gltf(path, limits, tally);
  if (!file) return file.error();
  Document document;
  document.limits = limits;
  document.folder = std::filesystem::path(path).parent_path();
  if (document.folder.empty()) document.folder = ".";

  auto raw = read_json(file->json, limits, tally);
  if (!raw) return raw.error();
  if (auto ok = check_version_and_extensions(*raw, tally); !ok) return ok.error();
  if (auto ok = check_sizes(*raw, limits); !ok) return ok.error();
  document.animations = read_animations(*raw, tally);
  document.importance = read_importance(*raw, tally);
  auto clean = sanitize(raw.take(), tally);
  if (!clean) return clean.error();
  auto variants = choose_variant(*clean, variant, tally);
  if (!variants) return variants.error();
  document.variants = variants.take();
  if (auto ok = settle_basisu(*clean, path, tally); !ok) return ok.error();
  document.center = read_center(*clean);
  if (auto ok = load_buffers(*clean, document, *file, tally); !ok) return ok.error();
  if (auto ok = take_images(*clean, document, tally); !ok) return ok.error();
  if (auto ok = decompress_views(*clean, document, workers, tally); !ok) return ok.error();
  if (auto ok = decompress_primitives(*clean, document, workers, tally); !ok) return ok.error();
  fill_sparse_defaults(*clean);
  if (auto ok = parse_model(*clean, document, tally); !ok) return ok.error();
  document.file = std::move(file->bytes);
  if (auto ok = check_model(document, tally); !ok) return ok.error();
  if (file->lengths_off && tally.first_loss()) return *file->lengths_off;  // bytes are missing
  return document;
}

}  // namespace mirage::gltf
