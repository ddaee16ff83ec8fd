#include "server/scene/gltf/file_guard.h"

#include <algorithm>
#include <fstream>
#include <system_error>

#include "server/scene/gltf/file_kind.h"
#include "server/scene/gltf/gltf_limits.h"

namespace mirage::gltf {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kHeaderBytes = 12;
constexpr std::size_t kChunkHeaderBytes = 8;
constexpr std::uint32_t kChunkJson = 0x4E4F534A;
constexpr std::uint32_t kChunkBin = 0x004E4942;

std::uint32_t read_u32(const std::vector<std::uint8_t>& bytes, std::size_t at) {
  return static_cast<std::uint32_t>(bytes[at]) | static_cast<std::uint32_t>(bytes[at + 1]) << 8 |
         static_cast<std::uint32_t>(bytes[at + 2]) << 16 |
         static_cast<std::uint32_t>(bytes[at + 3]) << 24;
}

Error format_error(const std::string& text) { return make_error(ErrorId::kSceneFormat, text); }

/// Returns the length of the JSON object at the front of the text; 0 if it does not end.
std::size_t object_length(std::string_view text) {
  int depth = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') {
      for (++i; i < text.size() && text[i] != '"'; ++i) i += text[i] == '\\' ? 1 : 0;
    } else if (c == '{' || c == '[') {
      ++depth;
    } else if ((c == '}' || c == ']') && --depth == 0) {
      return i + 1;
    }
  }
  return 0;
}

/// Splits a GLB into its chunks. Lengths that are off are forgiven, as far as the bytes tell where
/// the chunks are.
class ChunkSplitter {
 public:
  ChunkSplitter(GltfFile& file, Tally& tally) : file_(file), tally_(tally) {}

  Result<void> split() {
    const std::size_t size = file_.bytes.size();
    const std::size_t length = read_u32(file_.bytes, 8);
    if (length < kHeaderBytes + kChunkHeaderBytes || length > size) {
      auto ok = forgive(length, size,
                        "GLB header says " + std::to_string(length) + " bytes, the file has " +
                            std::to_string(size));
      if (!ok) return ok;
      end_ = size;
    } else {
      end_ = length;
    }
    while (end_ - at_ >= kChunkHeaderBytes) {
      if (auto ok = take_chunk(); !ok) return ok;
    }
    return at_ == end_ ? Result<void>{} : forgive(at_, end_, "GLB ends inside a chunk header");
  }

 private:
  /// Forgives lengths that are off by a few bytes.
  Result<void> forgive(std::uint64_t said, std::uint64_t there, const std::string& text) {
    constexpr std::uint64_t kFewBytes = 64;
    const Error error = format_error(text);
    if (std::max(said, there) - std::min(said, there) > kFewBytes) return error;
    if (!file_.lengths_off) file_.lengths_off = error;
    return tally_.forgive("GLB lengths a few bytes off", error);
  }

  Result<void> take_chunk() {
    std::size_t length = read_u32(file_.bytes, at_);
    const std::uint32_t type = read_u32(file_.bytes, at_ + 4);
    at_ += kChunkHeaderBytes;
    if (length > end_ - at_) {
      auto ok =
          forgive(length, end_ - at_,
                  "GLB chunk " + std::to_string(chunks_) + " claims " + std::to_string(length) +
                      " bytes, " + std::to_string(end_ - at_) + " are left");
      if (!ok) return ok;
      end_ = file_.bytes.size();
      length = std::min(length, end_ - at_);
    }
    if (chunks_++ == 0) return take_json(length, type);
    if (type == kChunkJson) return format_error("GLB has two JSON chunks");
    if (type == kChunkBin) return take_bin(length);
    at_ += length;  // other chunk types: to be ignored, glTF 2.0 §4.4
    return {};
  }

  Result<void> take_json(std::size_t length, std::uint32_t type) {
    const std::string_view rest(reinterpret_cast<const char*>(file_.bytes.data()) + at_,
                                end_ - at_);
    if (type != kChunkJson) return format_error("the first GLB chunk is not JSON");
    const std::size_t object = object_length(rest);
    file_.json = rest.substr(0, object > 0 ? object : length);
    if (object == 0 || (object <= length && only_padding(rest.substr(object, length - object)) &&
                        chunk_at(at_ + length))) {
      at_ += length;
      return {};
    }
    auto ok = forgive(length, object,
                      "the JSON chunk has " + std::to_string(length) + " bytes, its object " +
                          std::to_string(object));
    if (!ok) return ok;
    // The next chunk begins behind a few bytes of padding.
    constexpr std::size_t kMostPadding = 64;
    const std::size_t mark = rest.find(std::string_view("BIN\0", 4), object);
    const bool near =
        mark != std::string_view::npos && mark >= object + 4 && mark <= object + 4 + kMostPadding;
    at_ = near ? at_ + mark - 4 : end_;
    return {};
  }

  static bool only_padding(std::string_view text) {
    return text.find_first_not_of(std::string_view(" \t\r\n\0", 5)) == std::string_view::npos;
  }

  /// True if the GLB ends there, or a chunk begins that fits.
  bool chunk_at(std::size_t place) const {
    if (place == end_) return true;
    return place + kChunkHeaderBytes <= end_ &&
           read_u32(file_.bytes, place) <= end_ - place - kChunkHeaderBytes;
  }

  Result<void> take_bin(std::size_t length) {
    if (file_.has_bin) return format_error("GLB has two BIN chunks");
    file_.has_bin = true;
    const std::size_t left = end_ - at_ - length;
    if (!chunk_at(at_ + length)) {
      auto ok = forgive(length, length + left,
                        "the BIN chunk has " + std::to_string(length) + " bytes, " +
                            std::to_string(length + left) + " are left");
      if (!ok) return ok;
      length += left;
    }
    file_.bin = {file_.bytes.data() + at_, length};
    at_ += length;
    return {};
  }

  GltfFile& file_;
  Tally& tally_;
  std::size_t at_ = kHeaderBytes, end_ = 0;
  int chunks_ = 0;
};

}  // namespace

Result<std::vector<std::uint8_t>> read_regular_file(const fs::path& path, std::uint64_t max_bytes,
                                                    ErrorId not_regular) {
  std::error_code code;
  const fs::file_status status = fs::status(path, code);
  if (!fs::exists(status)) return make_error(ErrorId::kSceneMissing, "no such file");
  if (!fs::is_regular_file(status)) return make_error(not_regular, "not a regular file");
  const std::uintmax_t size = fs::file_size(path, code);
  if (code) return make_error(ErrorId::kSceneMissing, code.message());
  if (size > max_bytes) {
    return make_error(ErrorId::kSceneLimit, std::to_string(size) + " bytes, at most " +
                                                std::to_string(max_bytes) + " are read");
  }
  std::ifstream in(path, std::ios::binary);
  std::vector<std::uint8_t> bytes(size);
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (!in || in.gcount() != static_cast<std::streamsize>(size)) {
    return make_error(ErrorId::kSceneMissing, "cannot be read");
  }
  return bytes;
}

Result<GltfFile> open_gltf(const std::string& path, const SceneLimits& limits, Tally& tally) {
  auto bytes = read_regular_file(path, limits.file_bytes, ErrorId::kSceneMissing);
  if (!bytes && bytes.error().id == ErrorId::kSceneMissing) {
    return make_error(ErrorId::kSceneMissing, bytes.error().text,
                      "a .glb or .gltf file, or a built-in scene as in builtin:forest");
  }
  if (!bytes && bytes.error().id == ErrorId::kSceneLimit) {
    std::error_code code;
    return limits.exceeded(fs::file_size(path, code), limits.file_bytes, "bytes");
  }
  if (!bytes) return bytes.error();
  return split_container(bytes.take(), tally);
}

Result<GltfFile> split_container(std::vector<std::uint8_t> bytes, Tally& tally) {
  GltfFile file;
  file.bytes = std::move(bytes);
  if (file.bytes.empty()) return format_error("the file is empty");
  const std::string_view text(reinterpret_cast<const char*>(file.bytes.data()), file.bytes.size());
  if (text.starts_with("glTF")) {
    if (file.bytes.size() < kHeaderBytes + kChunkHeaderBytes) {
      return format_error("GLB of " + std::to_string(file.bytes.size()) + " bytes is too short");
    }
    const std::uint32_t version = read_u32(file.bytes, 4);
    if (version != 2) return format_error("GLB version " + std::to_string(version) + ", need 2");
    ChunkSplitter splitter(file, tally);
    if (auto ok = splitter.split(); !ok) return ok.error();
  } else {
    file.json = {reinterpret_cast<const char*>(file.bytes.data()), file.bytes.size()};
    if (file.json.starts_with("\xef\xbb\xbf")) file.json.remove_prefix(3);
  }
  const std::size_t first = file.json.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos || file.json[first] != '{') {
    const FileKind kind = kind_of_file(text);
    return make_error(ErrorId::kSceneFormat, "not a glTF file: " + kind.name, kind.hint);
  }
  return file;
}

}  // namespace mirage::gltf
