#include "client/host/methods.h"

#include <algorithm>
#include <utility>

namespace mirage {
namespace {

const std::vector<std::pair<std::string, MethodChoice>>& methods() {
  static const std::vector<std::pair<std::string, MethodChoice>> list = {
      {"fixed8", {false, DrawMethod::kQuad, true}},
      {"quad", {false, DrawMethod::kQuad, false}},
      {"cuboid", {false, DrawMethod::kCuboid, false}},
      {"hull", {false, DrawMethod::kHull, false}},
      {"warp", {false, DrawMethod::kWarp, false}},
      {"depth", {false, DrawMethod::kDepth, false}},
      {"auto", {true, DrawMethod::kQuad, false}},
      {"mesh", {false, DrawMethod::kMesh, false}}};
  return list;
}

}  // namespace

const std::vector<std::string>& method_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> out;
    for (const auto& method : methods()) out.push_back(method.first);
    return out;
  }();
  return names;
}

std::optional<MethodChoice> method_from_name(const std::string& name) {
  const auto at = std::find_if(methods().begin(), methods().end(),
                               [&](const auto& method) { return method.first == name; });
  if (at == methods().end()) return std::nullopt;
  return at->second;
}

}  // namespace mirage
