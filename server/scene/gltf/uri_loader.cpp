#include "server/scene/gltf/uri_loader.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <system_error>

#include "server/scene/gltf/file_guard.h"

namespace mirage::gltf {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kShownUriBytes = 80;

Error uri_error(std::string_view uri, const std::string& why) {
  std::string shown(uri.substr(0, kShownUriBytes));
  if (uri.size() > kShownUriBytes) shown += "...";
  return make_error(ErrorId::kSceneUri, "'" + shown + "': " + why);
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

/// Decodes RFC 3986 §2.1; false on a broken escape.
bool percent_decode(std::string_view text, std::string& out) {
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      out.push_back(text[i]);
      continue;
    }
    if (i + 2 >= text.size()) return false;
    const int high = hex_digit(text[i + 1]);
    const int low = hex_digit(text[i + 2]);
    if (high < 0 || low < 0) return false;
    out.push_back(static_cast<char>(high * 16 + low));
    i += 2;
  }
  return true;
}

std::array<std::int8_t, 256> make_base64_table() {
  std::array<std::int8_t, 256> table{};
  table.fill(-1);
  constexpr std::string_view kAlphabet =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (std::size_t i = 0; i < kAlphabet.size(); ++i) {
    table[static_cast<unsigned char>(kAlphabet[i])] = static_cast<std::int8_t>(i);
  }
  table['-'] = 62;  // the alphabet of URLs, RFC 4648 §5
  table['_'] = 63;
  return table;
}

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

/// Decodes RFC 4648 §4 and §5, in lines or in one, with optional padding; false on any other
/// character or an impossible length.
bool decode_base64(std::string_view text, std::vector<std::uint8_t>& out) {
  static const std::array<std::int8_t, 256> kTable = make_base64_table();
  while (!text.empty() && (text.back() == '=' || is_space(text.back()))) text.remove_suffix(1);
  out.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t bits = 0;
  int held = 0;
  std::size_t digits = 0;
  for (const char c : text) {
    if (is_space(c)) continue;
    ++digits;
    const auto value = kTable[static_cast<unsigned char>(c)];
    if (value < 0) return false;
    bits = (bits << 6 | static_cast<std::uint32_t>(value)) & 0xffffff;
    held += 6;
    if (held >= 8) {
      held -= 8;
      out.push_back(static_cast<std::uint8_t>(bits >> held));
    }
  }
  return digits % 4 != 1;
}

bool has_scheme(std::string_view uri) {
  const std::size_t colon = uri.find(':');
  return colon != std::string_view::npos && colon < uri.find_first_of("/\\");
}

/// Returns the file name in a relative URI. Errors: strict ones.
Result<std::string> file_name(std::string_view uri, Tally& tally) {
  if (uri.find(' ') != std::string_view::npos) {
    auto ok = tally.forgive("URIs with spaces that are not escaped",
                            uri_error(uri, "a space in a URI that is not escaped as %20"));
    if (!ok) return ok.error();
  }
  std::string name;
  if (percent_decode(uri, name)) return name;
  auto ok = tally.forgive("URIs with broken percent escapes taken as they stand",
                          uri_error(uri, "broken percent escape"));
  if (!ok) return ok.error();
  return std::string(uri);
}

bool climbs(const fs::path& path) {
  return std::find(path.begin(), path.end(), "..") != path.end();
}

bool is_inside(const fs::path& path, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first ==
         folder.end();
}

}  // namespace

Result<std::vector<std::uint8_t>> decode_data_uri(std::string_view uri) {
  const std::size_t comma = uri.find(',');
  if (!uri.starts_with("data:") || comma == std::string_view::npos) {
    return uri_error(uri, "broken data URI");
  }
  const std::string_view head = uri.substr(0, comma);
  const std::string_view body = uri.substr(comma + 1);
  std::vector<std::uint8_t> bytes;
  if (head.ends_with(";base64")) {
    if (!decode_base64(body, bytes)) return uri_error(uri, "broken base64");
    return bytes;
  }
  std::string plain;
  if (!percent_decode(body, plain)) return uri_error(uri, "broken percent escape");
  bytes.assign(plain.begin(), plain.end());
  return bytes;
}

Result<fs::path> resolve_uri(std::string_view uri, const fs::path& folder, Tally& tally) {
  if (uri.empty()) return uri_error(uri, "empty URI");
  auto decoded = file_name(uri, tally);
  if (!decoded) return decoded.error();
  std::string name = decoded.take();
  const bool control =
      std::any_of(name.begin(), name.end(), [](unsigned char c) { return std::iscntrl(c) != 0; });
  if (control) return uri_error(uri, "control character in a URI");
  if (has_scheme(name)) return uri_error(uri, "only relative files and data: URIs are read");
  if (name.front() == '/' || name.front() == '\\') return uri_error(uri, "absolute path");
  if (name.find('\\') != std::string::npos) {
    auto ok = tally.forgive("URIs with backslashes read as slashes",
                            uri_error(uri, "backslash in a URI"));
    if (!ok) return ok.error();
    std::replace(name.begin(), name.end(), '\\', '/');
  }

  std::error_code code;
  const fs::path root = fs::weakly_canonical(folder, code);
  if (code) return uri_error(uri, code.message());
  const fs::path path = fs::weakly_canonical(root / name, code);
  if (code) return uri_error(uri, code.message());
  if (!is_inside(path, root)) return uri_error(uri, "leaves the folder of the scene");
  if (climbs(name)) {
    auto ok = tally.forgive("URIs with '..' that stay inside the folder of the scene",
                            uri_error(uri, "'..' in a URI"));
    if (!ok) return ok.error();
  }
  return path;
}

Result<std::vector<std::uint8_t>> load_uri(std::string_view uri, const fs::path& folder,
                                           std::uint64_t max_bytes, const std::string& what,
                                           Tally& tally) {
  auto named = [&what](const Error& error) {
    return make_error(error.id, what + ": " + error.text, error.hint);
  };
  if (uri.starts_with("data:")) {
    auto bytes = decode_data_uri(uri);
    if (!bytes) return named(bytes.error());
    return bytes;
  }
  auto path = resolve_uri(uri, folder, tally);
  if (!path) return named(path.error());
  auto bytes = read_regular_file(*path, max_bytes, ErrorId::kSceneUri);
  if (!bytes) {
    return named(make_error(bytes.error().id, "'" + std::string(uri) + "': " + bytes.error().text));
  }
  return bytes;
}

}  // namespace mirage::gltf
