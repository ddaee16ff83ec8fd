#include "server/scene/gltf/uv_plan.h"

#include <algorithm>
#include <cmath>

namespace mirage::gltf {
namespace {

constexpr double kSameUv = 1e-5;  // a 25th of a texel of a map of 4096
constexpr UvMap kIdentity = {1, 0, 0, 0, 1, 0};
// A smaller share of the spread of coordinates is none.
constexpr double kOnALine = 1e-12;

glm::dvec2 mapped(const UvMap& m, const glm::dvec2& uv) {
  return {m[0] * uv.x + m[1] * uv.y + m[2], m[3] * uv.x + m[4] * uv.y + m[5]};
}

glm::dvec2 middle_of(const std::vector<glm::vec2>& all) {
  glm::dvec2 sum(0);
  for (const glm::vec2& uv : all) sum += glm::dvec2(uv);
  return sum / static_cast<double>(all.size());
}

double extent_of(const std::vector<glm::vec2>& all) {
  glm::vec2 low = all.front(), high = low;
  for (const glm::vec2& uv : all) {
    low = glm::min(low, uv);
    high = glm::max(high, uv);
  }
  return double{std::max(high.x - low.x, high.y - low.y)};
}

/// Calls `visit` for each map of a material that reads a set.
void each_map_of_set(const Material& material, int set,
                     const std::function<void(const TextureRef&)>& visit) {
  material.each_map([&](const TextureRef& ref) {
    if (ref.present() && ref.uv_set == set) visit(ref);
  });
}

bool all_placed_through(const Material& material, int set, const UvMap& map) {
  bool all = true;
  each_map_of_set(material, set,
                  [&](const TextureRef& ref) { all = all && placed_through(ref, map); });
  return all;
}

}  // namespace

std::optional<UvMap> map_between(const std::vector<glm::vec2>& from,
                                 const std::vector<glm::vec2>& to) {
  if (from.empty() || from.size() != to.size()) return std::nullopt;
  // Least squares about the middles: the map is the product of `across` and the inverse of `along`.
  const glm::dvec2 from_middle = middle_of(from), to_middle = middle_of(to);
  glm::dmat2 along(0), across(0);
  for (std::size_t i = 0; i < from.size(); ++i) {
    const glm::dvec2 a = glm::dvec2(from[i]) - from_middle, b = glm::dvec2(to[i]) - to_middle;
    along += glm::outerProduct(a, a);
    across += glm::outerProduct(b, a);
  }
  const double spread = along[0][0] + along[1][1];
  const bool flat = !(glm::determinant(along) > kOnALine * spread * spread);
  const glm::dmat2 turn = flat ? glm::dmat2(0) : across * glm::inverse(along);
  const glm::dvec2 move = to_middle - turn * from_middle;
  const UvMap map = {turn[0][0], turn[1][0], move.x, turn[0][1], turn[1][1], move.y};
  const double allowed = kSameUv * std::max(1.0, extent_of(to));
  for (std::size_t i = 0; i < from.size(); ++i) {
    // A comparison with NaN is false.
    if (!(glm::length(mapped(map, from[i]) - glm::dvec2(to[i])) <= allowed)) return std::nullopt;
  }
  return map;
}

std::optional<TextureRef> placed_through(const TextureRef& texture, const UvMap& map) {
  // KHR_texture_transform: translation * rotation * scale.
  const double c = std::cos(texture.rotation), s = std::sin(texture.rotation);
  const glm::dvec2 scale(texture.scale);
  const glm::dmat2 own(glm::dvec2(scale.x * c, -scale.x * s), glm::dvec2(scale.y * s, scale.y * c));
  const glm::dmat2 both = own * glm::dmat2(glm::dvec2(map[0], map[3]), glm::dvec2(map[1], map[4]));
  const glm::dvec2 offset = glm::dvec2(texture.offset) + own * glm::dvec2(map[2], map[5]);
  // The columns are scale.x (c, -s) and scale.y (s, c), at a right angle.
  const double x = glm::length(both[0]), y = glm::length(both[1]);
  if (std::abs(glm::dot(both[0], both[1])) > kSameUv * x * y) return std::nullopt;
  glm::dvec2 turn(1, 0);  // cosine and sine
  if (x > 0) {
    turn = {both[0].x / x, -both[0].y / x};
  } else if (y > 0) {
    turn = {both[1].y / y, both[1].x / y};
  }
  TextureRef out = texture;
  out.offset = offset;
  out.scale = glm::dvec2(x, both[1].x * turn.y + both[1].y * turn.x);
  out.rotation = static_cast<float>(std::atan2(turn.y, turn.x));
  return out;
}

std::vector<int> uv_sets_read(const Material& material) {
  std::vector<int> out;
  const auto add = [&](const TextureRef& ref) {
    const int set = ref.uv_set;
    if (ref.present() && std::find(out.begin(), out.end(), set) == out.end()) out.push_back(set);
  };
  // Without its place, light from a surface is seen most, and occlusion least.
  for (const TextureRef* ref : {&material.base_color_map, &material.emissive_map,
                                &material.normal_map, &material.metal_rough_map}) {
    add(*ref);
  }
  for (const TextureRef& ref : material.lobes.maps) add(ref);
  add(material.occlusion_map);
  return out;
}

UvPlan plan_uv_sets(const Material& material,
                    const std::function<std::vector<glm::vec2>(int set)>& coordinates) {
  std::vector<int> read = uv_sets_read(material);
  UvPlan plan;
  if (std::all_of(read.begin(), read.end(), [](int set) { return set <= 1; })) return plan;
  if (read.size() <= 2) {
    std::sort(read.begin(), read.end());
    plan.kept = {read.front(), read.back()};
    return plan;
  }
  std::vector<std::vector<glm::vec2>> kept;
  for (const int set : read) {
    std::vector<glm::vec2> own = coordinates(set);
    std::optional<UvPlan::Computed> computed;
    for (std::size_t k = 0; k < kept.size() && !computed; ++k) {
      // A set that the primitive lacks is read as the first, like any other such set.
      const std::optional<UvMap> map = own.empty() ? kIdentity : map_between(kept[k], own);
      if (!map || !all_placed_through(material, set, *map)) continue;
      computed = {set, static_cast<std::uint8_t>(k), *map};
    }
    if (computed) {
      plan.computed.push_back(*computed);
    } else if (kept.size() < 2) {
      plan.kept[kept.size()] = set;
      kept.push_back(std::move(own));
    } else {
      plan.lost.push_back(set);
    }
  }
  if (kept.size() == 1) plan.kept[1] = plan.kept[0];
  return plan;
}

std::size_t apply(const UvPlan& plan, Material& material) {
  std::size_t removed = 0;
  material.each_map([&](TextureRef& ref) {
    if (!ref.present()) return;
    const int set = ref.uv_set;
    const auto found = std::find_if(plan.computed.begin(), plan.computed.end(),
                                    [&](const UvPlan::Computed& one) { return one.set == set; });
    if (found != plan.computed.end()) {
      ref = placed_through(ref, found->map).value_or(ref);
      ref.uv_set = found->from;
    } else if (std::find(plan.lost.begin(), plan.lost.end(), set) != plan.lost.end()) {
      if (&ref == &material.emissive_map) material.emissive = glm::vec3(0);
      ref = TextureRef{};
      ++removed;
    } else {
      ref.uv_set = set == plan.kept[0] ? 0 : 1;
    }
  });
  return removed;
}

}  // namespace mirage::gltf
