#pragma once
// A glTF file with a checked structure: the typed model and its bytes.
//
// The model comes from tinygltf, which is given only the sanitised JSON, without buffers and
// images. It opens no file and decodes no pixel.

#include <tiny_gltf.h>

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "protocol/base/result.h"
#include "server/base/workers.h"
#include "server/scene/gltf/animation_source.h"
#include "server/scene/gltf/extras.h"
#include "server/scene/gltf/gltf_limits.h"
#include "server/scene/gltf/tally.h"

namespace mirage::gltf {

struct BufferData {
  std::vector<std::uint8_t> owned;     ///< empty for the BIN chunk
  std::span<const std::uint8_t> data;  ///< at least `length` bytes, unless absent
  std::uint64_t length = 0;            ///< byteLength as declared, as far as there are bytes
  bool absent = false;                 ///< neither uri nor BIN chunk: content undefined
};

/// Place of an image: one of `uri`, `file` and `buffer_view`; none if the file is missing.
struct ImageSource {
  std::string uri;  ///< a data URI
  std::filesystem::path file;
  int buffer_view = -1;

  bool missing() const { return uri.empty() && file.empty() && buffer_view < 0; }
};

struct Document {
  SceneLimits limits;
  std::vector<std::uint8_t> file;  ///< contains the BIN chunk
  std::filesystem::path folder;
  tinygltf::Model model;
  std::vector<BufferData> buffers;
  std::vector<ImageSource> images;
  AnimationSources animations;
  std::vector<std::string> variants;  ///< names, in the order of the file
  ImportanceMarks importance;
  glm::dvec3 center{0};  ///< CESIUM_RTC: place of the file's origin, m

  /// Returns the bytes of a checked bufferView; empty if it cannot be used or its buffer is absent.
  std::span<const std::uint8_t> view_bytes(int view) const;
};

/// Loads a file and checks its structure, including the ranges of bufferViews and accessors
/// (model_check.h). `variant` as in choose_variant() (kUsage). Errors: kSceneMissing, kSceneFormat,
/// kSceneRange, kSceneReference, kSceneLimit, kSceneUri, kSceneExtension.
Result<Document> load_document(const std::string& path, const std::string& variant,
                               const SceneLimits& limits, const Workers& workers, Tally& tally);

}  // namespace mirage::gltf
