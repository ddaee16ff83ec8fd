#include "server/scene/gltf/json_mend.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace mirage::gltf {
namespace {

bool continues(char c) { return (static_cast<unsigned char>(c) & 0xc0) == 0x80; }

/// Returns the bytes of the UTF-8 character at the front (RFC 3629); 0 if there is none.
std::size_t character_bytes(std::string_view text) {
  const auto first = static_cast<unsigned char>(text[0]);
  const auto second = text.size() > 1 ? static_cast<unsigned char>(text[1]) : 0u;
  const std::size_t size = first < 0x80                     ? 1
                           : first >= 0xc2 && first <= 0xdf ? 2
                           : first >= 0xe0 && first <= 0xef ? 3
                           : first >= 0xf0 && first <= 0xf4 ? 4
                                                            : 0;
  if (size == 0 || text.size() < size) return 0;
  // Overlong forms, surrogates, and what is beyond U+10FFFF.
  if ((first == 0xe0 && second < 0xa0) || (first == 0xed && second > 0x9f) ||
      (first == 0xf0 && second < 0x90) || (first == 0xf4 && second > 0x8f)) {
    return 0;
  }
  for (std::size_t i = 1; i < size; ++i) {
    if (!continues(text[i])) return 0;
  }
  return size;
}

/// Copies the string whose opening quote is at the front. Returns the bytes read.
std::size_t mend_string(std::string_view text, std::string& out) {
  std::size_t at = 1;
  out += '"';
  while (at < text.size()) {
    const std::size_t size = character_bytes(text.substr(at));
    if (size == 0) {
      out += '?';
      ++at;
      continue;
    }
    const char c = text[at];
    out += text.substr(at, size);
    at += size;
    if (c == '"') break;
    if (c == '\\' && at < text.size()) out += text[at++];
  }
  return at;
}

bool is_number_like(char c) {
  return std::string_view("+-.0123456789eEINafinty").find(c) != std::string_view::npos;
}

/// Copies a word outside strings: a number, true, false or null.
std::size_t mend_word(std::string_view text, std::string& out) {
  std::size_t size = 0;
  while (size < text.size() && is_number_like(text[size])) ++size;
  if (size == 0) {
    out += text[0];
    return 1;
  }
  const std::string word(text.substr(0, size));
  char* end = nullptr;
  const double value = std::strtod(word.c_str(), &end);
  const bool number = end == word.c_str() + word.size();
  out += number && !std::isfinite(value) ? "null" : word;
  return size;
}

}  // namespace

std::string mend_json(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    text.remove_prefix(text[0] == '"' ? mend_string(text, out) : mend_word(text, out));
  }
  return out;
}

}  // namespace mirage::gltf
