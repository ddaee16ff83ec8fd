// Reads only the front of a Draco bitstream (github.com/google/draco, docs/spec): header, metadata
// and the counts of the connectivity.
#include <optional>
#include <string>
#include <string_view>

#include "server/scene/gltf/draco_decode.h"
#include "server/scene/gltf/gltf_limits.h"

namespace mirage::gltf {
namespace {

constexpr int kMaxMetadataDepth = 16;

Error broken_header(const std::string& why) {
  return make_error(ErrorId::kSceneFormat, "Draco: " + why);
}

/// Reads bytes in order; a read past the end gives nullopt.
class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  bool skip(std::uint64_t count) {
    if (count > bytes_.size()) return false;
    bytes_ = bytes_.subspan(static_cast<std::size_t>(count));
    return true;
  }
  std::optional<std::uint8_t> byte() {
    if (bytes_.empty()) return std::nullopt;
    const std::uint8_t value = bytes_.front();
    bytes_ = bytes_.subspan(1);
    return value;
  }
  /// LEB128, at most 32 bits.
  std::optional<std::uint32_t> varint() {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 35; shift += 7) {
      const auto next = byte();
      if (!next) return std::nullopt;
      value |= std::uint64_t{*next & 0x7fu} << shift;
      if ((*next & 0x80) == 0) {
        if (value > 0xffffffffu) return std::nullopt;
        return static_cast<std::uint32_t>(value);
      }
    }
    return std::nullopt;
  }

 private:
  std::span<const std::uint8_t> bytes_;
};

bool skip_name(Reader& in) {
  const auto length = in.byte();
  return length && in.skip(*length);
}

bool skip_metadata(Reader& in, int depth) {
  if (depth > kMaxMetadataDepth) return false;
  const auto entries = in.varint();
  if (!entries) return false;
  for (std::uint32_t i = 0; i < *entries; ++i) {
    if (!skip_name(in)) return false;
    const auto size = in.varint();
    if (!size || !in.skip(*size)) return false;
  }
  const auto parts = in.varint();
  if (!parts) return false;
  for (std::uint32_t i = 0; i < *parts; ++i) {
    if (!skip_name(in) || !skip_metadata(in, depth + 1)) return false;
  }
  return true;
}

bool skip_geometry_metadata(Reader& in) {
  const auto attributes = in.varint();
  if (!attributes) return false;
  for (std::uint32_t i = 0; i < *attributes; ++i) {
    if (!in.varint() || !skip_metadata(in, 0)) return false;
  }
  return skip_metadata(in, 0);
}

}  // namespace

Result<std::uint32_t> peek_draco_faces(std::span<const std::uint8_t> bytes,
                                       const SceneLimits& limits) {
  constexpr std::string_view kMagic = "DRACO";
  constexpr std::size_t kHeaderBytes = 11;
  if (bytes.size() < kHeaderBytes) return broken_header("too short");
  for (std::size_t i = 0; i < kMagic.size(); ++i) {
    if (bytes[i] != static_cast<std::uint8_t>(kMagic[i])) return broken_header("no DRACO header");
  }
  const int major = bytes[5];
  const int minor = bytes[6];
  if (major != 2 || minor < 2) {
    return broken_header("bitstream " + std::to_string(major) + "." + std::to_string(minor) +
                         ", glTF needs 2.2");
  }
  if (bytes[7] != 1) return broken_header("a point cloud, not a mesh");
  const bool edgebreaker = bytes[8] == 1;
  if (bytes[8] > 1) return broken_header("unknown method " + std::to_string(bytes[8]));
  Reader in(bytes.subspan(kHeaderBytes));
  if ((bytes[10] & 0x80) != 0 && !skip_geometry_metadata(in))
    return broken_header("broken metadata");
  if (edgebreaker && !in.skip(1)) return broken_header("ends before its counts");
  const auto first = in.varint();
  const auto second = in.varint();
  if (!first || !second) return broken_header("ends before its counts");
  const std::uint32_t faces = edgebreaker ? *second : *first;
  const std::uint32_t vertices = edgebreaker ? *first : *second;
  if (faces > limits.draco_faces) {
    return limits.exceeded(faces, limits.draco_faces, "triangles in one mesh of Draco");
  }
  if (vertices > limits.vertices) return limits.exceeded(vertices, limits.vertices, "vertices");
  return faces;
}

}  // namespace mirage::gltf
