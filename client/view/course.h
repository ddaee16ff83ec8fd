#pragma once
// Course: where the eye is and which light there is, frame by frame: by a path and a light script,
// or as a person at the window steers.
// Input:  the time; what a person does at the window.
// Output: the pose of each frame; light, clips and variants for the session.
// Thread: the frame loop's.
// Full:   never.

#include <cstdint>
#include <functional>
#include <optional>

#include "client/frame/camera_path.h"
#include "client/host/light_script.h"
#include "client/screen/pilot.h"
#include "client/view/choice_log.h"
#include "protocol/base/result.h"
#include "protocol/impostor/camera.h"
#include "protocol/model/scene_types.h"

namespace mirage {

class ClientHost;
class ClientSession;
class SceneView;
class Window;
struct ViewOptions;

class Course {
 public:
  using CameraAt = std::function<Camera(const Pose&)>;

  /// `camera` tells the camera of a pose.
  Course(const ViewOptions& options, CameraAt camera);

  /// Returns the clip and variant to ask for.
  const SceneChoice& choice() const { return choice_.asked(); }
  /// Reads path and light, and goes to the scene's home view. Errors kUsage, kIo.
  Result<void> meet(const SceneView& scene);
  /// The course begins at this time of the session.
  void start(std::int64_t now_us) { start_us_ = now_us; }

  /// Sets the light of this time, if it is another than before.
  void light(ClientSession& session, std::int64_t now_us);
  /// Returns the pose of this time. `window` is nullptr if nobody steers; `seconds` have passed
  /// since the last frame.
  Pose next(ClientHost& host, Window* window, std::int64_t now_us, double seconds);
  /// True if nothing happens by itself: there is no path, and the light stays.
  bool rests() const { return !path_ && light_->fixed(); }

 private:
  void choose(ClientHost& host, Window& window);
  void steer(ClientHost& host, Window& window, double seconds);

  const ViewOptions& options_;
  CameraAt camera_;
  ChoiceLog choice_;
  std::optional<CameraPath> path_;
  std::optional<LightScript> light_;
  std::optional<Lighting> last_light_;
  Pilot pilot_;
  Pose pose_;
  std::int64_t start_us_ = 0;
};

}  // namespace mirage
