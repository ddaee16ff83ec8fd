#include "client/plan/scene_opener.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "client/plan/selector_input.h"
#include "client/plan/selector_rules.h"
#include "client/scene/scene_view.h"
#include "protocol/base/limits.h"
#include "protocol/wire/conversions.h"
#include "protocol/wire/message.h"
#include "wire_generated.h"

namespace mirage {
namespace {

constexpr std::int64_t kWalkEveryUs = 100'000;
// A group is asked for at 1.3 times the distance at which its members are needed. The request then
// covers all groups needed within 1.6 times their distance, so that a moving eye asks seldom.
constexpr double kAskMargin = 1.3;
constexpr double kGetMargin = 1.6;

}  // namespace

void SceneOpener::reset() {
  asked_.clear();
  walked_us_ = INT64_MIN / 2;
}

std::vector<wire::OpenRequestT> SceneOpener::plan(const std::vector<SelectorInput>& views) {
  std::vector<wire::OpenRequestT> out;
  const SelectorInput& first = views.front();
  if (!first.scene->described() || first.now_us - walked_us_ < kWalkEveryUs) return out;
  walked_us_ = first.now_us;
  for (const SelectorInput& view : views) {
    if (std::optional<wire::OpenRequestT> request = ask(view)) out.push_back(std::move(*request));
  }
  return out;
}

std::optional<wire::OpenRequestT> SceneOpener::ask(const SelectorInput& in) {
  const SceneView& scene = *in.scene;
  const glm::dvec3 eye = in.predicted.pose.eye;
  OpenRule rule;
  rule.focal_px = in.predicted.focal_px();
  rule.tau_px = std::min(in.tau_px, in.target_px);
  rule.speed_mps = std::max(glm::length(in.velocity), kWalkingMps);
  rule.margin = kAskMargin;
  std::vector<std::pair<double, std::uint32_t>> wanted;  // distance in radii, and the server's id
  std::vector<std::uint32_t> open = scene.roots();
  while (!open.empty()) {
    const std::uint32_t index = open.back();
    open.pop_back();
    const InstanceView& view = scene.instances[index];
    const ObjectDescription& object = scene.objects[view.object];
    const double distance = glm::length(view.center - eye);
    if (object.cut) {
      const bool parts = distance < kAskMargin * kPartRadii * view.radius;
      if (!parts || comes_as_mesh(in, object, distance / view.radius)) continue;
    } else if (object.group) {
      OpenRule own = rule;
      own.tau_px *= tolerance(view.importance);
      if (distance >= open_distance(own, view.radius)) continue;
    } else {
      continue;
    }
    const SceneView::Members members = scene.members(index);
    open.insert(open.end(), members.begin(), members.end());
    if (scene.opened(index) || asked_.count(view.id) != 0) continue;
    wanted.emplace_back(distance / view.radius, view.id);
  }
  if (wanted.empty()) return std::nullopt;
  std::sort(wanted.begin(), wanted.end());
  wanted.resize(std::min(wanted.size(), limits::kMaxOpensPerRequest));
  wire::OpenRequestT request;
  for (const auto& [radii, id] : wanted) {
    request.groups.push_back(id);
    asked_.insert(id);
  }
  request.eye = std::make_unique<wire::Vec3d>(to_wire(eye));
  request.forward = std::make_unique<wire::Vec3d>(to_wire(in.predicted.forward()));
  request.focal_px = rule.focal_px;
  request.tau_px = rule.tau_px;
  request.speed_mps = rule.speed_mps;
  request.margin = kGetMargin;
  return request;
}

}  // namespace mirage
