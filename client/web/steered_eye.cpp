#include "client/web/steered_eye.h"

#include "client/scene/scene_view.h"
#include "client/session/client_session.h"

namespace mirage {

void SteeredEye::prepare(ClientSession& session, const Camera& camera, std::int64_t now_us) {
  const bool known = session.scene().welcomed();
  if (!met_ && known) {
    pilot_.meet(session.scene());
    met_ = true;
  }
  if (!posed_ && known) go_home(session, camera);
  if (pilot_.needs_ground()) session.want_ground(pose_.eye, now_us);
}

void SteeredEye::steer(const Steering& by, const ClientSession& session, const Camera& camera) {
  if (by.moves()) pilot_.look_ahead(session.scene(), camera);
  pilot_.steer(by, camera.fov_y, session.ground(), pose_);
}

bool SteeredEye::aim(const ClientSession& session, const Camera& camera, const glm::dvec2& place) {
  const std::optional<Seen> seen = seen_at(session.scene(), camera, place);
  if (seen) pilot_.aim(seen->point);
  return seen.has_value();
}

void SteeredEye::set_pose(ClientSession& session, const Pose& pose) {
  pose_ = pose;
  posed_ = true;
  // The first picture is of the place of the link.
  if (!session.scene().welcomed()) session.start_at(pose);
}

void SteeredEye::go_home(const ClientSession& session, const Camera& camera) {
  const HomeView& home = session.scene().home;
  pose_ = home_pose(home, camera);
  pilot_.aim(home.target);
  posed_ = true;
}

std::optional<std::uint32_t> object_at(const ClientSession& session, const Camera& camera,
                                       const glm::dvec2& place) {
  const SceneView& scene = session.scene();
  const std::optional<Seen> seen = seen_at(scene, camera, place);
  if (!seen) return std::nullopt;
  return scene.instances[seen->instance].object;
}

}  // namespace mirage
