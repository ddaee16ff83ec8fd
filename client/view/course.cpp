#include "client/view/course.h"

#include <spdlog/spdlog.h>

#include <utility>

#include "client/host/client_host.h"
#include "client/scene/scene_view.h"
#include "client/session/client_session.h"
#include "client/view/options.h"
#include "client/view/window.h"
#include "protocol/impostor/lighting_state.h"

namespace mirage {

Course::Course(const ViewOptions& options, CameraAt camera)
    : options_(options), camera_(std::move(camera)), choice_(options.scene.choice) {}

Result<void> Course::meet(const SceneView& scene) {
  if (!options_.path.empty()) {
    Result<CameraPath> path =
        CameraPath::create(options_.path, scene.home, scene.bounds_center, scene.bounds_radius);
    if (!path) return path.error();
    path_.emplace(path.take());
  }
  Result<LightScript> light = LightScript::create(options_.light);
  if (!light) return light.error();
  light_.emplace(light.take());
  pose_ = home_pose(scene.home, camera_({}));
  pilot_.meet(scene);
  return {};
}

void Course::light(ClientSession& session, std::int64_t now_us) {
  const std::optional<Lighting> light =
      light_->at(static_cast<double>(now_us - start_us_) * 1e-6, session.scene().lighting);
  if (!light || (last_light_ && same_lighting(*light, *last_light_))) return;
  session.set_lighting(*light, now_us);
  last_light_ = light;
}

Pose Course::next(ClientHost& host, Window* window, std::int64_t now_us, double seconds) {
  choice_.note(host.session().scene().choices);
  if (window) host.session().play(!window->stopped(), now_us);
  if (path_) {
    pose_ = path_->at(static_cast<double>(now_us - start_us_) * 1e-6);
  } else if (window) {
    choose(host, *window);
    steer(host, *window, seconds);
  }
  return pose_;
}

// Asks for the next clip or variant, if a key said so.
void Course::choose(ClientHost& host, Window& window) {
  const bool clip = window.take(WindowCommand::kNextClip);
  const bool variant = window.take(WindowCommand::kNextVariant);
  if (!choice_.ask_next(host.session().scene().choices, clip, variant)) return;
  host.session().choose(choice_.asked());
  host.reconnect();
}

// Moves the eye by what a person did at the window.
void Course::steer(ClientHost& host, Window& window, double seconds) {
  ClientSession& session = host.session();
  if (window.take(WindowCommand::kSteerMode)) {
    const bool orbits = pilot_.mode() == SteerMode::kOrbit;
    pilot_.set_mode(orbits ? SteerMode::kWalk : SteerMode::kOrbit);
  }
  if (window.take(WindowCommand::kFly)) {
    pilot_.set_flies(!pilot_.flies());
    spdlog::info("{}", pilot_.flies() ? "flying, through everything" : "feet on the ground");
  }
  const Steering by = window.take_steering(seconds);
  const Camera camera = camera_(pose_);
  if (const std::optional<glm::dvec2> place = window.take_aim()) {
    if (const auto seen = seen_at(session.scene(), camera, *place)) pilot_.aim(seen->point);
  }
  if (by.moves()) pilot_.look_ahead(session.scene(), camera);
  pilot_.steer(by, camera.fov_y, session.ground(), pose_);
  if (pilot_.needs_ground()) session.want_ground(pose_.eye, host.now_us());
}

}  // namespace mirage
