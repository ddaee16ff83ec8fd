#include "client/plan/importance.h"

#include <algorithm>

#include "client/scene/scene_view.h"
#include "protocol/impostor/camera.h"
#include "protocol/impostor/instance_group.h"

namespace mirage {
namespace {

constexpr double kHalfAttention = 0.25;  // of the view's height

double nearness(const glm::dvec2& at_px, const glm::dvec2& center_px, double radius_px,
                double height_px) {
  const double beside = std::max(0.0, glm::length(at_px - center_px) - radius_px);
  const double share = beside / (kHalfAttention * height_px);
  return 1 / (1 + share * share);
}

}  // namespace

double attention(const Camera& camera, const InstanceView& instance) {
  const glm::dvec3 to_center = instance.center - camera.pose.eye;
  const double depth = glm::dot(to_center, camera.forward());
  if (glm::length(to_center) <= instance.radius) return 2;  // the eye is inside it
  if (depth <= 0) return 1;
  const double scale = camera.focal_px() / depth;
  const glm::dvec2 middle(0.5 * camera.width, 0.5 * camera.height);
  const glm::dvec2 center = middle + scale * glm::dvec2(glm::dot(to_center, camera.right()),
                                                        -glm::dot(to_center, camera.up()));
  const double radius = scale * instance.radius, height = camera.height;
  return 1 + nearness(middle, center, radius, height);
}

double allowed_error_px(double tau_px, double target_px, double attention, Importance importance) {
  const double unsteered = std::min(tau_px, target_px);
  return tolerance(importance) * std::max(unsteered, tau_px / attention);
}

}  // namespace mirage
