#pragma once
// Footing: keeps somebody who walks on the ground. Walls, trunks and edges stop them, and they
// slide along; steps are climbed. Where the ground is not known yet, they wait.
// Input:  the ground, and where the eye wants to go.
// Output: where it goes.
// Thread: the frame loop's.
// Full:   never.

#include <glm/glm.hpp>
#include <optional>

namespace mirage {

class GroundMap;

class Footing {
 public:
  /// Moves the eye from `from` by `by`. An eye far above the ground hovers, free in all directions,
  /// until it comes down to it. Beneath all floors, or where there are none, it hovers as well.
  glm::dvec3 walk(const GroundMap& ground, const glm::dvec3& from, const glm::dvec3& by);
  /// True if the eye of the last walk() stands on the ground, or waits for it to be known.
  bool stands() const { return stands_; }

 private:
  /// Finds the floor that the eye stands on; nullopt: it hovers, or the ground is not known.
  std::optional<double> find_floor(const GroundMap& ground, glm::dvec3& eye) const;
  glm::dvec3 hover(const GroundMap& ground, const glm::dvec3& from, const glm::dvec3& by);
  /// Goes a part of the way that is shorter than a cell; false: it is stopped.
  bool step(const GroundMap& ground, glm::dvec3& eye, const glm::dvec2& by);

  std::optional<double> floor_;  ///< height under the eye's last place
  glm::dvec3 eye_{0};            ///< that place
  bool stands_ = false;
};

}  // namespace mirage
