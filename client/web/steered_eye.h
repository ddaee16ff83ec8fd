#pragma once
// Steered eye: where the eye of one view is, moved by what a person does to it.
// Input:  a person's steering; the scene.
// Output: the pose.
// Thread: the page's.
// Full:   never.

#include <cstdint>
#include <string>

#include "client/screen/pilot.h"
#include "protocol/impostor/camera.h"

namespace mirage {

class ClientSession;

class SteeredEye {
 public:
  /// Meets the scene once it is known, goes to its home view unless a pose was set, and asks for
  /// the ground it walks on. Call it before each frame, with a camera of the picture's size.
  void prepare(ClientSession& session, const Camera& camera, std::int64_t now_us);

  /// Moves the eye by what a person did.
  void steer(const Steering& by, const ClientSession& session, const Camera& camera);
  /// Makes what is seen at a place of the picture (0 to 1, right and down) the pivot. False:
  /// nothing is there, and the pivot stays.
  bool aim(const ClientSession& session, const Camera& camera, const glm::dvec2& place);
  void set_pose(ClientSession& session, const Pose& pose);
  /// Goes to the scene's home view, for a picture of the camera's size.
  void go_home(const ClientSession& session, const Camera& camera);

  const Pose& pose() const { return pose_; }
  Pilot& pilot() { return pilot_; }
  const Pilot& pilot() const { return pilot_; }

 private:
  Pilot pilot_;
  bool met_ = false;  ///< the pilot knows the scene
  Pose pose_;
  bool posed_ = false;
};

/// Returns the number of the object seen at a place of the picture; nullopt: nothing is there.
std::optional<std::uint32_t> object_at(const ClientSession& session, const Camera& camera,
                                       const glm::dvec2& place);

}  // namespace mirage
