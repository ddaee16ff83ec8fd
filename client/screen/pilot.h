#pragma once
// Pilot: moves the eye as a person steers it. Who walks turns in place and goes where they look,
// with the feet on the ground or flying; who orbits turns about a point of the scene, the pivot.
// Input:  the scene; what hand, keys and sticks have done since the last frame.
// Output: the pose.
// Thread: the frame loop's.
// Full:   never.

#include <glm/glm.hpp>
#include <optional>

#include "client/screen/footing.h"
#include "protocol/impostor/camera.h"

namespace mirage {

class GroundMap;
class SceneView;

enum class SteerMode : std::uint8_t { kWalk, kOrbit };

/// A person's motions since the last frame. Numbers that are not finite do nothing.
struct Steering {
  glm::dvec2 drag{0};  ///< shares of the picture's height, right and down: what is seen goes along
  glm::dvec2 turn{0};  ///< radians, right and down: the eye turns
  glm::dvec3 move{0};  ///< seconds at full speed: right, up (of the world), ahead
  glm::dvec2 pan{0};   ///< shares of the picture's height, right and down: the scene goes along
  double zoom = 0;     ///< steps, > 0: nearer
  /// True if the eye goes somewhere, and does not only turn.
  bool moves() const { return move != glm::dvec3(0) || zoom != 0; }
};

class Pilot {
 public:
  /// Learns the scene: a home view from outside of it is for orbiting about what it looks at, one
  /// from inside for walking.
  void meet(const SceneView& scene);

  SteerMode mode() const { return mode_; }
  void set_mode(SteerMode mode) { mode_ = mode; }
  /// True if who walks flies, through everything. In scenes without ground everybody does.
  bool flies() const { return flies_ || !ground_here_; }
  void set_flies(bool flies) { flies_ = flies; }
  /// True if the ground around the eye is needed (ClientSession::want_ground).
  bool needs_ground() const { return mode_ == SteerMode::kWalk && !flies(); }
  const glm::dvec3& pivot() const { return pivot_; }
  /// Returns the full speed, m/s. On foot it is that of walking. It crosses a scene that is
  /// orbited, or one of an unusual size for walking, within ten seconds, whatever the unit of its
  /// file. Who flies is faster the farther away is what they look at, and slower close to it.
  double speed_mps() const { return on_foot() ? usual_mps_ : pace_ * usual_mps_; }
  /// Learns how far away is what is seen in the middle of the picture.
  void look_ahead(const SceneView& scene, const Camera& camera);

  /// Turns about `point` from now on.
  void aim(const glm::dvec3& point) { pivot_ = point; }
  /// Moves the pose. The eye never looks steeper than 1.5 radians. `fov_y`: of the picture,
  /// radians.
  void steer(const Steering& by, double fov_y, const GroundMap& ground, Pose& pose);

 private:
  void turn(const glm::dvec2& angles, Pose& pose) const;
  void approach(double steps, Pose& pose) const;
  /// Brings the pace nearer to the wanted one, for a motion of so many seconds.
  void change_pace(double seconds);
  /// Moves the eye in its own directions: pan, and going.
  void go(const Steering& by, double fov_y, Pose& pose) const;
  bool on_foot() const { return needs_ground() && footing_.stands(); }

  SteerMode mode_ = SteerMode::kWalk;
  glm::dvec3 pivot_{0, 0, -1};
  bool flies_ = false;
  bool ground_here_ = false;  ///< the scene is walked on its ground
  Footing footing_;
  double radius_ = 1;  ///< of the scene, m
  double usual_mps_ = 1;
  double pace_ = 1, wanted_pace_ = 1;  ///< of who flies, in usual speeds
};

/// An instance that is seen at a place of the picture.
struct Seen {
  glm::dvec3 point;            ///< on the instance's hull
  std::uint32_t instance = 0;  ///< index into SceneView::instances
};
/// Returns what is seen at a place of the picture (0 to 1, right and down): the nearest instance
/// that the eye is outside of; nullopt: there is none.
std::optional<Seen> seen_at(const SceneView& scene, const Camera& camera, const glm::dvec2& place);

}  // namespace mirage
