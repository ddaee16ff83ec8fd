#pragma once
// A glTF file whose structure is checked: the typed model, and its bytes.
//
// The model comes from tinygltf, which is shown only the sanitised JSON, without buffers and
// images: it opens no file and decodes no pixel.

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
#include "server/scene/gltf/tally.h"

namespace mirage::gltf {

struct BufferData {
  std::vector<std::uint8_t> owned;     ///< empty for the BIN chunk
  std::span<const std::uint8_t> data;  ///< at least `length` bytes, unless absent
  std::uint64_t length = 0;            ///< byteLength as declared
  bool absent = false;                 ///< neither uri nor BIN chunk: content undefined
};

/// One of `uri`, `file` and `buffer_view`; none of them where the file is missing.
struct ImageSource {
  std::string uri;  ///< data: only
  std::filesystem::path file;
  int buffer_view = -1;

  bool missing() const { return uri.empty() && file.empty() && buffer_view < 0; }
};

struct Document {
  std::vector<std::uint8_t> file;  ///< the BIN chunk lies in here
  std::filesystem::path folder;
  tinygltf::Model model;
  std::vector<BufferData> buffers;
  std::vector<ImageSource> images;
  AnimationSources animations;
  ImportanceMarks importance;
  glm::dvec3 center{0};  ///< CESIUM_RTC: where the origin of the file lies, m

  /// The bytes of a checked bufferView; empty when its buffer is absent.
  std::span<const std::uint8_t> view_bytes(int view) const;
};

/// Errors: kSceneMissing, kSceneFormat, kSceneRange, kSceneReference, kSceneLimit, kSceneUri,
/// kSceneExtension. Ranges of bufferViews and accessors are checked too (model_check.h).
/// `variant` as choose_variant() has it (kUsage).
Result<Document> load_document(const std::string& path, const std::string& variant,
                               const Workers& workers, Tally& tally);

}  // namespace mirage::gltf
