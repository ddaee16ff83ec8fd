#pragma once
// Camera paths: built-in motions and recorded traces.

#include <optional>
#include <string>
#include <vector>

#include "protocol/base/result.h"
#include "protocol/impostor/camera.h"
#include "protocol/model/scene_types.h"

namespace mirage {

class CameraPath {
 public:
  /// Creates a path from `spec`, which is one of:
  /// - "builtin:still|orbit|walk|fly|shake|strafe|teleport";
  /// - a file of lines `x y z rx ry rz t_ms` (metres, degrees XYZ, milliseconds; t never falls);
  /// - a view as the browser page writes it into its address, `#eye=X,Y,Z&look=X,Y,Z`, with or
  ///   without the address before it.
  /// Errors: kUsage for an unknown name or a bad line (with its number), kIo for the file.
  static Result<CameraPath> create(const std::string& spec, const HomeView& home,
                                   const glm::dvec3& scene_center, double scene_radius);

  Pose at(double seconds) const;
  /// Returns the pose at which a path of this `spec` starts, if it does not depend on the scene.
  static std::optional<Pose> start_of(const std::string& spec);

 private:
  enum class Kind { kStill, kOrbit, kWalk, kFly, kShake, kStrafe, kTeleport, kTrace };
  struct Key {
    double seconds;
    Pose pose;
  };
  static Result<Key> read_view(const std::string& fragment);
  static Result<std::vector<Key>> read_trace(const std::string& path);
  Pose walk(double seconds) const;
  Pose trace(double seconds) const;

  Kind kind_ = Kind::kStill;
  HomeView home_;
  glm::dvec3 center_{0};
  double radius_ = 1;
  std::vector<Key> keys_;
};

}  // namespace mirage
