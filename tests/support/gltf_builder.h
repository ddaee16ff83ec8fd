#pragma once
// Small glTF files made in memory.

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "server/scene/gltf/gltf_import.h"
#include "tests/support/temp_folder.h"

namespace mirage::test {

using nlohmann::json;

inline std::string u32_bytes(std::uint32_t value) {
  std::string out(4, '\0');
  std::memcpy(out.data(), &value, 4);
  return out;
}

inline std::string make_glb(std::string text, std::string bin, std::uint32_t version = 2) {
  text.resize((text.size() + 3) / 4 * 4, ' ');
  bin.resize((bin.size() + 3) / 4 * 4, '\0');
  std::string body = u32_bytes(static_cast<std::uint32_t>(text.size())) + "JSON" + text;
  if (!bin.empty()) {
    body += u32_bytes(static_cast<std::uint32_t>(bin.size())) + std::string("BIN\0", 4) + bin;
  }
  return "glTF" + u32_bytes(version) + u32_bytes(static_cast<std::uint32_t>(12 + body.size())) +
         body;
}

/// A document under construction: accessors are appended, the rest is edited as JSON.
struct Builder {
  json doc = {{"asset", {{"version", "2.0"}}}};
  std::string bin;

  template <typename T>
  int view(const std::vector<T>& values, int stride = 0) {
    bin.resize((bin.size() + 3) / 4 * 4, '\0');
    json entry = {
        {"buffer", 0}, {"byteOffset", bin.size()}, {"byteLength", values.size() * sizeof(T)}};
    if (stride > 0) entry["byteStride"] = stride;
    const std::size_t at = bin.size();
    bin.resize(at + values.size() * sizeof(T));
    if (!values.empty()) std::memcpy(bin.data() + at, values.data(), values.size() * sizeof(T));
    doc["bufferViews"].push_back(entry);
    return static_cast<int>(doc["bufferViews"].size()) - 1;
  }

  template <typename T>
  int accessor(const std::vector<T>& values, const char* type, int component_type,
               std::size_t components, bool normalized = false) {
    json entry = {{"bufferView", view(values)},
                  {"componentType", component_type},
                  {"count", values.size() / components},
                  {"type", type}};
    if (normalized) entry["normalized"] = true;
    doc["accessors"].push_back(entry);
    return static_cast<int>(doc["accessors"].size()) - 1;
  }
  int vec3(const std::vector<float>& values) { return accessor(values, "VEC3", 5126, 3); }
  int vec2(const std::vector<float>& values) { return accessor(values, "VEC2", 5126, 2); }
  int vec4(const std::vector<float>& values) { return accessor(values, "VEC4", 5126, 4); }
  int indices(const std::vector<std::uint16_t>& values) {
    return accessor(values, "SCALAR", 5123, 1);
  }

  /// One mesh of one primitive, drawn by one node.
  Builder& mesh(const json& attributes, int index_accessor = -1, int mode = 4) {
    json primitive = {{"attributes", attributes}, {"mode", mode}};
    if (index_accessor >= 0) primitive["indices"] = index_accessor;
    doc["meshes"].push_back({{"primitives", json::array({primitive})}});
    doc["nodes"].push_back({{"mesh", doc["meshes"].size() - 1}});
    return *this;
  }
  json& primitive() { return doc["meshes"][0]["primitives"][0]; }

  std::string glb() const {
    json whole = doc;
    if (!bin.empty() && !doc.contains("buffers")) {
      whole["buffers"] = json::array({{{"byteLength", bin.size()}}});
    }
    return make_glb(whole.dump(), bin);
  }
  Result<Scene> load(const ImportOptions& options = {}) const {
    const TempFolder folder;
    return import_gltf(folder.write("scene.glb", glb()), Workers(), options);
  }
  Result<Scene> load_strict() const { return load({.strict = true}); }
};

/// Corners (0,0,0), (1,0,0), (0,1,0), counter-clockwise seen from +z; no normals.
inline Builder triangle() {
  Builder builder;
  const int position = builder.vec3({0, 0, 0, 1, 0, 0, 0, 1, 0});
  builder.mesh({{"POSITION", position}});
  return builder;
}

}  // namespace mirage::test
