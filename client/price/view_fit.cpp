#include "client/price/view_fit.h"

#include <algorithm>
#include <cmath>

#include "client/scene/scene_view.h"
#include "protocol/impostor/motion.h"
#include "protocol/impostor/object_proxy.h"
#include "protocol/impostor/view_tile.h"

namespace mirage {
namespace {
constexpr double kAsideShare = 0.25;  // of the object's distance: an angle of 14 degrees
}  // namespace

ViewFit::ViewFit(const ViewTile& view)
    : camera_(view.camera), time_s_(view.time_s), near_m_(view.near_m), step_(view.depth_step()) {}

std::optional<double> ViewFit::moved_px(const InstanceView& instance,
                                        const ObjectDescription& object, const Camera& camera,
                                        double time_s) const {
  const MotionProfile& motion = object.motion;
  double way = 0;
  if (const Track& track = object.track; track.moves()) {
    way = glm::distance(track.at(wrap_clip(time_s_ + instance.clip_offset_s, track.clip_s)),
                        track.at(wrap_clip(time_s + instance.clip_offset_s, track.clip_s)));
  }
  if (!object.moves()) return 0;
  const double then = wrap_clip(time_s_ + instance.clip_offset_s, motion.clip_s);
  if (motion.hidden_at(then)) return std::nullopt;
  const double at = wrap_clip(time_s + instance.clip_offset_s, motion.clip_s);
  const double scale = instance.radius / std::max(double{object.radius}, 1e-30);
  const double distance = glm::length(instance.center - camera.pose.eye) - instance.radius;
  const double nearest = std::max({distance, 0.1 * instance.radius, 1e-9});
  return camera.focal_px() * scale * (way + motion.travel(then, at)) / nearest;
}

bool ViewFit::shows(const InstanceView& instance, const ObjectDescription& object,
                    const Camera& camera, double time_s) const {
  double far = glm::length(instance.center - camera_.pose.eye);
  // Surfaces around the eye of the view lie somewhere between the nearest and the farthest.
  if (far <= instance.radius) far = std::sqrt(near_m_ * std::max(near_m_, instance.radius));
  if (glm::length(camera.pose.eye - camera_.pose.eye) > kAsideShare * far) return false;
  const std::optional<double> moved = moved_px(instance, object, camera, time_s);
  return moved && *moved <= kTornPx;
}

std::optional<double> ViewFit::error_px(const InstanceView& instance,
                                        const ObjectDescription& object, const Camera& camera,
                                        double time_s, double behind_share) const {
  const glm::dvec3 to = instance.center - camera_.pose.eye;
  const double depth = glm::dot(to, camera_.forward());
  const double up = std::tan(0.5 * camera_.fov_y) * depth,
               right = up * camera_.width / camera_.height;
  const bool inside = depth > 0 && std::abs(glm::dot(to, camera_.up())) <= up &&
                      std::abs(glm::dot(to, camera_.right())) <= right;
  const double far = glm::length(to), aside = glm::length(camera.pose.eye - camera_.pose.eye);
  if (!inside || far <= instance.radius || aside > kAsideShare * far) return std::nullopt;
  const double focal = camera.focal_px();
  const double now = glm::length(instance.center - camera.pose.eye);
  const double texel = focal / camera_.focal_px() * far / std::max(now, 1e-9);
  const double behind = 1 / (far - instance.radius) - 1 / (far + instance.radius);
  const std::optional<double> moved = moved_px(instance, object, camera, time_s);
  if (!moved) return std::nullopt;
  return texel + *moved + focal * aside * (step_ / far + behind_share * behind);
}

}  // namespace mirage
