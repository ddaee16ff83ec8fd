#include "client/scene/ground_map.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mirage {
namespace {

constexpr std::size_t kMostBlocks = 256;  // about 10 MB
constexpr double kStepSlack = 1.5;        // steps of the code by which two floors of a step differ

}  // namespace

void GroundMap::reset(const WalkBody& body) {
  body_ = body;
  blocks_.clear();
  order_.clear();
}

void GroundMap::add(GroundBlock block) {
  Known known;
  std::uint32_t at = 0;
  for (const std::uint8_t count : block.counts) {
    known.first.push_back(at);
    at += count;
  }
  const GroundBlockId id = block.id;
  known.block = std::move(block);
  if (!blocks_.insert_or_assign(id, std::move(known)).second) return;
  order_.push_back(id);
  if (order_.size() <= kMostBlocks) return;
  blocks_.erase(order_.front());
  order_.erase(order_.begin());
}

GroundBlockId GroundMap::block_of(double x, double z) const {
  const auto number = [this](double at) {
    // Far away, beyond what a number holds, there is no ground.
    return static_cast<std::int32_t>(
        std::clamp(std::floor(at / body_.block_m()), -2147483647.0, 2147483647.0));
  };
  return {number(x), number(z)};
}

const GroundMap::Known* GroundMap::find(GroundBlockId id) const {
  const auto at = blocks_.find(id);
  return at == blocks_.end() ? nullptr : &at->second;
}

std::vector<GroundBlockId> GroundMap::missing_around(double x, double z) const {
  std::vector<std::pair<double, GroundBlockId>> out;
  if (!body_.walks() || !std::isfinite(x) || !std::isfinite(z)) return {};
  const GroundBlockId here = block_of(x, z);
  for (std::int32_t dx = -1; dx <= 1; ++dx) {
    for (std::int32_t dz = -1; dz <= 1; ++dz) {
      const GroundBlockId id{here.x + dx, here.z + dz};
      if (find(id)) continue;
      const double away_x = (id.x + 0.5) * body_.block_m() - x;
      const double away_z = (id.z + 0.5) * body_.block_m() - z;
      out.emplace_back(std::hypot(away_x, away_z), id);
    }
  }
  std::sort(out.begin(), out.end());
  std::vector<GroundBlockId> ids;
  ids.reserve(out.size());
  for (const auto& [away, id] : out) ids.push_back(id);
  return ids;
}

template <typename Visit>
void GroundMap::each_floor(double x, double z, const Visit& visit) const {
  const GroundBlockId id = block_of(x, z);
  const Known* const known = find(id);
  if (!known) return;
  const auto cell = [this](double at, std::int32_t block) {
    const double inside = (at - block * body_.block_m()) / body_.cell_m();
    return static_cast<std::size_t>(std::clamp(std::floor(inside), 0.0, kGroundCells - 1.0));
  };
  const GroundBlock& block = known->block;
  const std::size_t index = cell(z, id.z) * kGroundCells + cell(x, id.x);
  for (std::size_t i = 0; i < block.counts[index]; ++i) {
    visit(block.base_m + block.step_m * block.floors[known->first[index] + i]);
  }
}

std::optional<double> GroundMap::floor_below(double x, double z, double most_m) const {
  std::optional<double> out;
  each_floor(x, z, [&](double height) {
    if (height <= most_m) out = height;
  });
  return out;
}

std::optional<double> GroundMap::floor_near(double x, double z, double height_m) const {
  std::optional<double> out;
  const Known* const known = find(block_of(x, z));
  const double reach = body_.climb_m() + (known ? kStepSlack * known->block.step_m : 0);
  each_floor(x, z, [&](double height) {
    const double away = std::abs(height - height_m);
    if (away <= reach && (!out || away < std::abs(*out - height_m))) out = height;
  });
  return out;
}

double GroundMap::smooth_height(double x, double z, double height_m) const {
  const double cell = body_.cell_m();
  const double u = x / cell - 0.5, v = z / cell - 0.5;
  const double x0 = std::floor(u), z0 = std::floor(v), fx = u - x0, fz = v - z0;
  const auto at = [&](double dx, double dz) {
    return floor_near((x0 + dx + 0.5) * cell, (z0 + dz + 0.5) * cell, height_m).value_or(height_m);
  };
  return (at(0, 0) * (1 - fx) + at(1, 0) * fx) * (1 - fz) +
         (at(0, 1) * (1 - fx) + at(1, 1) * fx) * fz;
}

}  // namespace mirage
