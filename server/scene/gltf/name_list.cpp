#include "server/scene/gltf/name_list.h"

#include <algorithm>

namespace mirage::gltf {
namespace {

constexpr std::size_t kShownNames = 20;
constexpr std::size_t kShownBytes = 60;

}  // namespace

std::string shown_name(const std::string& name) {
  std::string out = name.substr(0, kShownBytes);
  std::replace_if(
      out.begin(), out.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
  return out;
}

std::string listed_names(const std::string& kind, const std::vector<std::string>& names) {
  if (names.empty()) return "the file has no " + kind;
  std::string out = "its " + kind + ":";
  for (std::size_t i = 0; i < std::min(names.size(), kShownNames); ++i) {
    out += (i == 0 ? " " : ", ") + shown_name(names[i]);
  }
  if (names.size() > kShownNames) out += ", …";
  return out;
}

}  // namespace mirage::gltf
