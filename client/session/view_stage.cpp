#include "client/session/view_stage.h"

#include <algorithm>
#include <cmath>

#include "client/frame/draw_list.h"
#include "client/plan/selector_rules.h"
#include "client/plan/tile_need.h"
#include "client/scene/scene_view.h"
#include "protocol/wire/view_codec.h"

namespace mirage {
namespace {

// Share of the screen without any picture from which a view is asked for.
constexpr double kMissingShare = 0.05;
constexpr double kEmptyShare = 0.25;   // from here at any cost: next to nothing is shown
constexpr double kLeastShare = 0.001;  // the same, once the eye rests
constexpr std::int64_t kRestsUs = 1'000'000;
constexpr std::int64_t kPauseUs = 2'000'000;       // after a refusal
constexpr std::int64_t kLightRestsUs = 250'000;    // a light that stays so long has come to rest
constexpr std::int64_t kLightPauseUs = 1'000'000;  // between views while the light changes
constexpr double kSamePlace = 1e-5;                // of the scene's radius
constexpr float kSameDirection = 1 - 1e-6f;        // cosine of half the angle

/// Returns the share of the screen that the bounding sphere covers, at most 1.
double screen_share(const Camera& camera, const InstanceView& instance) {
  const double distance = glm::length(instance.center - camera.pose.eye);
  if (distance <= instance.radius) return 1;
  const double px = camera.focal_px() * instance.radius / distance;
  return std::min(1.0, 3.14159 * px * px / (static_cast<double>(camera.width) * camera.height));
}

bool same_view(const Camera& a, const Camera& b, double scene_radius) {
  return a.width == b.width && a.height == b.height && a.fov_y == b.fov_y &&
         a.shift_px == b.shift_px && a.pixel_aspect == b.pixel_aspect &&
         glm::length(a.pose.eye - b.pose.eye) <= kSamePlace * scene_radius &&
         std::abs(glm::dot(a.pose.rotation, b.pose.rotation)) >= kSameDirection;
}

}  // namespace

Result<std::shared_ptr<const ViewTile>> ViewStage::take(const Message& message) {
  const wire::ViewReplyT& reply = *message.body.AsViewReply();
  if (reply.request_id == 0 || reply.request_id != pending_) {
    return std::shared_ptr<const ViewTile>();
  }
  pending_ = 0;
  Result<ViewTile> view = view_of_planes(reply, message.payload);
  if (!view) return view.error();
  view_ = std::make_shared<const ViewTile>(view.take());
  fit_.emplace(*view_);
  light_ = std::exchange(asked_light_, std::nullopt);
  drawn_ = false;
  return view_;
}

bool ViewStage::refused(const wire::RefusedT& refused, std::int64_t now_us) {
  if (refused.request_id == 0 || refused.request_id != pending_) return false;
  pending_ = 0;
  planned_from_.reset();
  not_before_us_ = now_us + kPauseUs;
  if (refused.reason == wire::RefusalReason::NoView) enabled_ = false;
  return true;
}

void ViewStage::note_drawn() {
  if (!std::exchange(drawn_, true)) ++counts_.drawn;
}

void ViewStage::show_all(DrawList& list) {
  if (!view_) return;
  list.view = DrawnView{view_, std::vector<bool>(view_->instances.size(), true)};
  note_drawn();
}

bool ViewStage::mark(const InstanceView& instance, bool shown, std::vector<bool>& owners) const {
  const std::vector<std::uint32_t>& ids = view_->instances;
  const std::uint32_t first = instance.leaves > 0 ? instance.first_leaf : instance.id;
  const std::uint32_t end = first + std::max(instance.leaves, 1u);
  const auto begin = std::lower_bound(ids.begin(), ids.end(), first);
  auto at = begin;
  for (; at != ids.end() && *at < end; ++at) {
    owners[static_cast<std::size_t>(at - ids.begin())] = shown;
  }
  return at != begin;
}

void ViewStage::show_missing(const SceneView& scene, const Camera& camera, double time_s,
                             DrawList& list) {
  if (!view_) return;
  const auto shows = [&](const InstanceView& instance) {
    return fit_->shows(instance, scene.objects[instance.object], camera, time_s);
  };
  DrawnView view{view_, std::vector<bool>(view_->instances.size(), false)};
  const Frustum frustum(camera);
  for (std::size_t i = 0; i < view_->instances.size(); ++i) {
    const std::uint32_t index = scene.index_of(view_->instances[i]);
    // Nothing else can show an instance that the server has not told yet.
    view.owners[i] = index == InstanceView::kNoParent && !scene.described();
    if (index == InstanceView::kNoParent) continue;
    const InstanceView& instance = scene.instances[index];
    const glm::dvec3 to = instance.center - camera.pose.eye;
    const bool large = camera.focal_px() * instance.radius > kMinRadiusPx * glm::length(to);
    view.owners[i] = large && frustum.may_see(to, instance.radius) && shows(instance);
  }
  for (const DrawnImpostor& drawn : list.impostors) {
    if (drawn.fade >= 1) mark(scene.instances[drawn.instance], false, view.owners);
  }
  for (const DrawnMesh& drawn : list.meshes) {
    const bool whole = drawn.fade >= 1 && !drawn.plain;
    if (whole) mark(scene.instances[drawn.instance], false, view.owners);
  }
  for (DrawnPlaceholder& placeholder : list.placeholders) {
    const InstanceView& instance = scene.instances[placeholder.instance];
    const bool here = shows(instance);
    const bool in_view = mark(instance, here, view.owners);
    const ObjectDescription& object = scene.objects[instance.object];
    placeholder.covered = here && (in_view || fit_->error_px(instance, object, camera, time_s));
  }
  if (std::find(view.owners.begin(), view.owners.end(), true) == view.owners.end()) return;
  list.view = std::move(view);
  note_drawn();
}

bool ViewStage::outdated(const SceneView& scene, const Camera& camera, std::uint32_t light,
                         const DrawList& list, std::int64_t now_us) {
  if (seen_light_ != light || !light_) seen_light_since_us_ = now_us;
  seen_light_ = light;
  if (!light_) light_ = light;
  const bool rests = now_us - seen_light_since_us_ >= kLightRestsUs;
  const bool due = rests || now_us - kLightPauseUs >= asked_us_;
  if (*light_ == light || !due) return false;
  double shown = 0;
  for (const DrawnPlaceholder& placeholder : list.placeholders) {
    if (placeholder.covered) shown += screen_share(camera, scene.instances[placeholder.instance]);
  }
  return shown >= kMissingShare;
}

std::optional<wire::ViewRequestT> ViewStage::plan(const SceneView& scene, const Camera& predicted,
                                                  double time_s, std::uint32_t light,
                                                  const DrawList& list, std::int64_t now_us) {
  const bool relight = outdated(scene, predicted, light, list, now_us);
  if (!enabled_ || pending_ != 0 || now_us < not_before_us_) return std::nullopt;
  double missing = 0, tiles = 0;
  for (const DrawnPlaceholder& placeholder : list.placeholders) {
    if (placeholder.covered) continue;
    missing += screen_share(predicted, scene.instances[placeholder.instance]);
    ++tiles;
  }
  if (!stands_at_ || !same_view(*stands_at_, predicted, scene.bounds_radius)) {
    stands_at_ = predicted;
    stands_since_us_ = now_us;
  }
  // A few placeholders get tiles of their own sooner than a view.
  const bool pays = tiles >= kViewTiles || missing >= kEmptyShare;
  const bool rests = now_us - stands_since_us_ >= kRestsUs && missing >= kLeastShare;
  const bool fills = rests || (missing >= kMissingShare && pays);
  const bool again = planned_from_ && same_view(*planned_from_, predicted, scene.bounds_radius);
  if (!relight && (!fills || again)) return std::nullopt;
  planned_from_ = predicted;
  asked_light_ = light;
  asked_us_ = now_us;
  return view_request(predicted, time_s);
}

}  // namespace mirage
