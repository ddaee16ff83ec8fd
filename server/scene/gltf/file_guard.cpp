#include "server/scene/gltf/file_guard.h"

#include <algorithm>
#include <fstream>
#include <functional>
#include <system_error>

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

bool starts_with(const std::vector<std::uint8_t>& bytes, std::string_view magic) {
  if (bytes.size() < magic.size()) return false;
  for (std::size_t i = 0; i < magic.size(); ++i) {
    if (bytes[i] != static_cast<std::uint8_t>(magic[i])) return false;
  }
  return true;
}

/// Guesses the kind of a file that is no glTF.
std::string guess_kind(const std::vector<std::uint8_t>& bytes) {
  if (starts_with(bytes, "\x89PNG")) return "a PNG image";
  if (starts_with(bytes, "\xff\xd8\xff")) return "a JPEG image";
  if (starts_with(bytes, "<")) return "an HTML or XML page";
  if (starts_with(bytes, "PK\x03\x04")) return "a ZIP archive";
  if (starts_with(bytes, "\x1f\x8b")) return "a gzip archive";
  return "neither GLB nor JSON";
}

/// Walks the chunks of a GLB whose header is already checked; `end` is its declared length.
Result<void> split_chunks(GltfFile& file, std::size_t end) {
  std::size_t at = kHeaderBytes;
  for (int chunk = 0; end - at >= kChunkHeaderBytes; ++chunk) {
    const std::size_t length = read_u32(file.bytes, at);
    const std::uint32_t type = read_u32(file.bytes, at + 4);
    at += kChunkHeaderBytes;
    if (length > end - at) {
      return format_error("GLB chunk " + std::to_string(chunk) + " claims " +
                          std::to_string(length) + " bytes, " + std::to_string(end - at) +
                          " are left");
    }
    if (chunk == 0) {
      if (type != kChunkJson) return format_error("the first GLB chunk is not JSON");
      file.json = {reinterpret_cast<const char*>(file.bytes.data()) + at, length};
    } else if (type == kChunkJson) {
      return format_error("GLB has two JSON chunks");
    } else if (type == kChunkBin) {
      if (file.has_bin) return format_error("GLB has two BIN chunks");
      file.bin = {file.bytes.data() + at, length};
      file.has_bin = true;
    }  // other chunk types: to be ignored, glTF 2.0 §4.4
    at += length;
  }
  if (at != end) return format_error("GLB ends inside a chunk header");
  return {};
}

/// The names in all objects that are open, as hashes.
class NameWatch {
 public:
  void open() {
    if (++depth_ > static_cast<int>(levels_.size())) levels_.emplace_back();
    levels_[static_cast<std::size_t>(depth_ - 1)].clear();
  }
  void name(std::string_view name) {
    if (depth_ > 0) {
      levels_[static_cast<std::size_t>(depth_ - 1)].push_back(std::hash<std::string_view>{}(name));
    }
  }
  void close() {
    if (depth_ == 0) return;  // not JSON; the parser reports it
    std::vector<std::size_t>& names = levels_[static_cast<std::size_t>(--depth_)];
    std::sort(names.begin(), names.end());
    if (std::adjacent_find(names.begin(), names.end()) != names.end()) ++twice_;
  }
  int depth() const { return depth_; }
  std::uint64_t twice() const { return twice_; }

 private:
  std::vector<std::vector<std::size_t>> levels_;
  int depth_ = 0;
  std::uint64_t twice_ = 0;
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

Result<GltfFile> open_gltf(const std::string& path) {
  auto bytes = read_regular_file(path, kMaxFileBytes, ErrorId::kSceneMissing);
  if (!bytes && bytes.error().id == ErrorId::kSceneMissing) {
    return make_error(ErrorId::kSceneMissing, bytes.error().text,
                      "a .glb or .gltf file, or a built-in scene as in builtin:forest");
  }
  if (!bytes) return bytes.error();
  return split_container(bytes.take());
}

Result<GltfFile> split_container(std::vector<std::uint8_t> bytes) {
  GltfFile file;
  file.bytes = std::move(bytes);
  if (file.bytes.empty()) return format_error("the file is empty");
  if (starts_with(file.bytes, "glTF")) {
    if (file.bytes.size() < kHeaderBytes + kChunkHeaderBytes) {
      return format_error("GLB of " + std::to_string(file.bytes.size()) + " bytes is too short");
    }
    const std::uint32_t version = read_u32(file.bytes, 4);
    if (version != 2) return format_error("GLB version " + std::to_string(version) + ", need 2");
    const std::size_t length = read_u32(file.bytes, 8);
    if (length < kHeaderBytes + kChunkHeaderBytes || length > file.bytes.size()) {
      return format_error("GLB header says " + std::to_string(length) + " bytes, the file has " +
                          std::to_string(file.bytes.size()));
    }
    if (auto chunks = split_chunks(file, length); !chunks) return chunks.error();
  } else {
    file.json = {reinterpret_cast<const char*>(file.bytes.data()), file.bytes.size()};
    if (file.json.starts_with("\xef\xbb\xbf")) file.json.remove_prefix(3);
  }
  const std::size_t first = file.json.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos || file.json[first] != '{') {
    return format_error("not a glTF file: " + guess_kind(file.bytes));
  }
  if (file.json.size() > kMaxJsonBytes) {
    return make_error(ErrorId::kSceneLimit,
                      "JSON of more than " + std::to_string(kMaxJsonBytes) + " bytes");
  }
  return file;
}

Result<std::uint64_t> scan_json(std::string_view text) {
  std::uint64_t values = 0;
  std::size_t last_string = 0;  // start of the last string, after its quote
  std::size_t last_end = 0;
  NameWatch names;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') {
      last_string = i + 1;
      for (++i; i < text.size() && text[i] != '"'; ++i) i += text[i] == '\\' ? 1 : 0;
      last_end = std::min(i, text.size());
    } else if (c == ':') {
      names.name(text.substr(last_string, last_end - last_string));
    } else if (c == '{' || c == '[') {
      ++values;
      names.open();
      if (names.depth() > kMaxJsonDepth) {
        return make_error(ErrorId::kSceneLimit,
                          "JSON nested deeper than " + std::to_string(kMaxJsonDepth) + " levels");
      }
    } else if (c == '}' || c == ']') {
      names.close();
    } else if (c == ',') {
      ++values;
    }
  }
  if (values > kMaxJsonValues) {
    return make_error(ErrorId::kSceneLimit,
                      "JSON with more than " + std::to_string(kMaxJsonValues) + " values");
  }
  return names.twice();
}

}  // namespace mirage::gltf
