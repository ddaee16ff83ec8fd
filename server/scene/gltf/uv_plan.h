#pragma once
// The choice of the two sets of texture coordinates of a vertex, among those its material reads.

#include <array>
#include <compare>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "protocol/model/model.h"

namespace mirage::gltf {

/// Texture coordinates computed from others: (m[0] u + m[1] v + m[2], m[3] u + m[4] v + m[5]).
using UvMap = std::array<double, 6>;

/// The sets of a file (TEXCOORD_n) that become the first and second of a vertex. A set that a map
/// computes from one of these is read through that map.
struct UvPlan {
  std::array<int, 2> kept{0, 1};
  struct Computed {
    int set = 0;
    std::uint8_t from = 0;  ///< 0 or 1: index into `kept`
    UvMap map{};
    auto operator<=>(const Computed&) const = default;
  };
  std::vector<Computed> computed;
  std::vector<int> lost;  ///< sets that no map computes from those kept

  auto operator<=>(const UvPlan&) const = default;
};

/// The sets that the maps of a material read, the most visible first, none twice.
/// `Material::each_map` names sets as the file does.
std::vector<int> uv_sets_read(const Material& material);

/// Plans for the sets that a material reads. `coordinates` returns those of a set, one for each
/// vertex, or none if the primitive lacks the set.
UvPlan plan_uv_sets(const Material& material,
                    const std::function<std::vector<glm::vec2>(int set)>& coordinates);

/// Makes the maps of a material read the sets of a vertex. Maps of lost sets are removed, with what
/// they would have emitted. Returns the number removed.
std::size_t apply(const UvPlan& plan, Material& material);

/// Returns the map from each of `from` to that of `to`, of equal length, to within 1e-5 of the
/// larger of 1 and the extent of `to`; none: no map does that.
std::optional<UvMap> map_between(const std::vector<glm::vec2>& from,
                                 const std::vector<glm::vec2>& to);

/// Returns the texture placed by coordinates that `map` computes from its own; none: it would be
/// sheared, which KHR_texture_transform cannot say.
std::optional<TextureRef> placed_through(const TextureRef& texture, const UvMap& map);

}  // namespace mirage::gltf
