#include "client/price/view_fit.h"

#include <algorithm>
#include <cmath>

#include "client/scene/scene_view.h"
#include "protocol/impostor/view_tile.h"

namespace mirage {
namespace {
constexpr double kAsideShare = 0.25;  // of the object's distance: an angle of 14 degrees
}  // namespace

ViewFit::ViewFit(const ViewTile& view) : camera_(view.camera), step_(view.depth_step()) {}

std::optional<double> ViewFit::error_px(const InstanceView& instance, const Camera& camera,
                                        double behind_share) const {
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
  return texel + focal * aside * (step_ / far + behind_share * behind);
}

}  // namespace mirage
