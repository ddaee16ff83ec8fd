#include "client/screen/footing.h"

#include <algorithm>
#include <cmath>

#include "client/scene/ground_map.h"

namespace mirage {
namespace {

constexpr double kStepCells = 0.5;  // longest step at a time, cells
constexpr double kMostSteps = 256;  // for one frame; a longer way is cut
constexpr double kFalls = 3;        // eye heights above the ground from which the eye hovers
constexpr double kGlide = 0.3;      // eye heights of way over which height follows the ground
constexpr double kLowest = 0.6;     // of the eye's height, while it follows a rising ground
constexpr int kSearchCells = 12;    // around the eye, for a first floor
// Directions to slide in, radians to either side of the wanted one.
constexpr double kSlides[] = {0, 0.4, -0.4, 0.8, -0.8, 1.2, -1.2};

}  // namespace

std::optional<double> Footing::find_floor(const GroundMap& ground, glm::dvec3& eye) const {
  const double height = ground.body().eye_m, cell = ground.body().cell_m();
  // An eye somewhat lower than usual still stands.
  const double most = eye.y - 0.4 * height;
  const auto floor_at = [&](double x, double z, double least) {
    const std::optional<double> floor = ground.floor_below(x, z, most);
    return floor && *floor >= least ? floor : std::nullopt;
  };
  const double falls = eye.y - (1 + kFalls) * height, stands = eye.y - 1.5 * height;
  if (const std::optional<double> here = floor_at(eye.x, eye.z, falls)) return here;
  // It may be in a thing, or too near to one: then it stands beside it.
  std::optional<double> best;
  double nearest = kSearchCells + 1;
  glm::dvec2 place(0);
  for (int dx = -kSearchCells; dx <= kSearchCells; ++dx) {
    for (int dz = -kSearchCells; dz <= kSearchCells; ++dz) {
      const double away = std::hypot(dx, dz);
      const double x = eye.x + dx * cell, z = eye.z + dz * cell;
      const std::optional<double> floor = away < nearest ? floor_at(x, z, stands) : std::nullopt;
      if (!floor) continue;
      best = floor;
      nearest = away;
      place = {x, z};
    }
  }
  if (best) eye = {place.x, eye.y, place.y};
  return best;
}

bool Footing::step(const GroundMap& ground, glm::dvec3& eye, const glm::dvec2& by) {
  for (const double turn : kSlides) {
    const double c = std::cos(turn), s = std::sin(turn);
    const glm::dvec2 slid = glm::dvec2(c * by.x - s * by.y, s * by.x + c * by.y) * c;
    const std::optional<double> floor = ground.floor_near(eye.x + slid.x, eye.z + slid.y, *floor_);
    if (!floor) continue;
    floor_ = floor;
    eye.x += slid.x;
    eye.z += slid.y;
    const double height = ground.body().eye_m;
    const double under = ground.smooth_height(eye.x, eye.z, *floor_);
    const double follow = 1 - std::exp(-glm::length(slid) / (kGlide * height));
    eye.y += (under + height - eye.y) * follow;
    eye.y = std::max(eye.y, std::max(under, *floor_) + kLowest * height);
    return true;
  }
  return false;
}

glm::dvec3 Footing::hover(const GroundMap& ground, const glm::dvec3& from, const glm::dvec3& by) {
  stands_ = false;
  glm::dvec3 to = from + by;
  const double height = ground.body().eye_m;
  // The floor that is under the eye before it moves must stay under it.
  const std::optional<double> floor = ground.floor_below(to.x, to.z, from.y - 0.4 * height);
  if (floor) to.y = std::max(to.y, *floor + height);
  return to;
}

glm::dvec3 Footing::walk(const GroundMap& ground, const glm::dvec3& from, const glm::dvec3& by) {
  if (by == glm::dvec3(0)) return from;
  glm::dvec3 eye = from;
  if (eye_ != from) floor_.reset();  // somebody else has moved it
  if (!floor_) {
    stands_ = !ground.knows(from.x, from.z);
    if (stands_) return from;
    floor_ = find_floor(ground, eye);
  }
  if (!floor_) return hover(ground, from, by);
  stands_ = true;
  const glm::dvec2 flat(by.x, by.z);
  const double longest = kStepCells * ground.body().cell_m();
  const double steps = std::clamp(std::ceil(glm::length(flat) / longest), 1.0, kMostSteps);
  const glm::dvec2 one =
      flat * (std::min(longest, glm::length(flat) / steps) / std::max(glm::length(flat), 1e-300));
  for (int i = 0; i < static_cast<int>(steps); ++i) {
    if (!step(ground, eye, one)) break;
  }
  eye_ = eye;
  return eye;
}

}  // namespace mirage
