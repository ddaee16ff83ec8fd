#include "client/load/request_plan.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <unordered_set>

#include "client/scene/scene_view.h"
#include "protocol/base/limits.h"

namespace mirage {
namespace {

constexpr double kMinRadiusPx = 0.5;  // smaller ones are not asked for, as in the viewer
// Instances in view; limits memory in scenes of a million.
constexpr std::size_t kMaxPerStep = 1024;
constexpr std::uint64_t kOffsets = 1, kPhases = 2, kStarts = 4;

/// Instances in view at the steps of the path. A step is computed when first needed; clients share
/// it.
class Steps {
 public:
  Steps(const SceneView& scene, const CameraPath& path, const PlanOptions& options)
      : scene_(scene), path_(path), options_(options) {}

  /// Returns the instances worth a tile, largest first.
  const std::vector<std::uint32_t>& in_view(std::int64_t step) {
    const auto [at, fresh] = steps_.try_emplace(step);
    if (fresh) at->second = look(camera(step));
    return at->second;
  }

  TileNeed need(std::int64_t step, std::uint32_t instance) const {
    const ViewGeometry v = view(camera(step), instance);
    ViewPlan plan;
    plan.tau_px = options_.tau_px;
    TileNeed need = need_for_view(v, plan);
    need.instance = instance;
    need.error_px = 2 * radius_px(v);  // as if the instance showed nothing yet
    return need;
  }

 private:
  Camera camera(std::int64_t step) const {
    Camera camera = options_.camera;
    camera.pose = path_.at(static_cast<double>(step) / options_.fps);
    camera.fit_depth_range(scene_.bounds_center, scene_.bounds_radius);
    return camera;
  }

  ViewGeometry view(const Camera& camera, std::uint32_t instance) const {
    const InstanceView& of = scene_.instances[instance];
    return view_geometry(camera, of, scene_.objects[of.object]);
  }

  std::vector<std::uint32_t> look(const Camera& camera) const {
    std::vector<std::pair<double, std::uint32_t>> found;
    scene_.for_visible(camera, 0, [&](std::uint32_t instance) {
      const std::uint32_t object = scene_.instances[instance].object;
      if (scene_.geometry && scene_.objects[object].surrounds) return;  // comes as geometry
      const ViewGeometry v = view(camera, instance);
      const bool too_near = glm::length(v.eye) < limits::kMinCaptureRadii * v.radius;
      if (!(v.radius > 0) || too_near || radius_px(v) < kMinRadiusPx) return;
      found.emplace_back(-radius_px(v), instance);
    });
    std::sort(found.begin(), found.end());
    found.resize(std::min(found.size(), kMaxPerStep));
    std::vector<std::uint32_t> out;
    out.reserve(found.size());
    for (const auto& [size, instance] : found) out.push_back(instance);
    return out;
  }

  const SceneView& scene_;
  const CameraPath& path_;
  const PlanOptions& options_;
  std::unordered_map<std::int64_t, std::vector<std::uint32_t>> steps_;
};

class Planner {
 public:
  Planner(const SceneView& scene, const CameraPath& path, const PlanOptions& options)
      : options_(options), steps_(scene, path, options) {}

  void add_client(std::uint32_t client) {
    const double spread_steps = std::floor(options_.spread_s * options_.fps);
    const auto offset = static_cast<std::int64_t>(seeded_share(options_.seed, kOffsets, client) *
                                                  (spread_steps + 1));
    const double phase = seeded_share(options_.seed, kPhases, client);
    const double start = seeded_share(options_.seed, kStarts, client);
    std::unordered_set<std::uint32_t> had;  // instances asked for in this turn
    for (std::uint64_t k = 0;; ++k) {
      const double t = (static_cast<double>(k) + phase) / options_.rate_hz;
      if (t >= options_.duration_s) break;
      const std::int64_t step = offset + static_cast<std::int64_t>(t * options_.fps);
      const std::vector<std::uint32_t>& view = steps_.in_view(step);
      if (view.empty()) continue;
      const std::uint32_t instance = next_in_turn(view, start, had);
      plan_.asks.push_back({std::llround(t * 1e6), client, index_of(steps_.need(step, instance))});
    }
  }

  RequestPlan take() {
    std::stable_sort(
        plan_.asks.begin(), plan_.asks.end(),
        [](const PlannedAsk& a, const PlannedAsk& b) { return a.intended_us < b.intended_us; });
    return std::move(plan_);
  }

 private:
  static std::uint32_t next_in_turn(const std::vector<std::uint32_t>& view, double start,
                                    std::unordered_set<std::uint32_t>& had) {
    const auto first = static_cast<std::size_t>(start * static_cast<double>(view.size()));
    std::size_t k = 0;
    while (k < view.size() && had.count(view[(first + k) % view.size()]) != 0) ++k;
    if (k == view.size()) had.clear();
    const std::uint32_t instance = view[(first + k) % view.size()];
    had.insert(instance);
    return instance;
  }

  std::uint32_t index_of(const TileNeed& need) {
    TileKey key;  // stands for the ask only; the instance is included because its light matters
    key.object = need.instance;
    key.cell = need.cell;
    key.distance = need.distance;
    key.size_class = need.size_class;
    const auto fresh_index = static_cast<std::uint32_t>(plan_.needs.size());
    const auto [at, fresh] = index_.try_emplace(tile_id(key), fresh_index);
    if (fresh) plan_.needs.push_back(need);
    return at->second;
  }

  const PlanOptions& options_;
  Steps steps_;
  std::unordered_map<TileId, std::uint32_t> index_;
  RequestPlan plan_;
};

}  // namespace

double seeded_share(std::uint64_t seed, std::uint64_t a, std::uint64_t b) {
  std::uint64_t x = seed;
  for (const std::uint64_t more : {a, b}) {  // SplitMix64 steps
    x += more + 0x9e3779b97f4a7c15ull;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    x ^= x >> 31;
  }
  return static_cast<double>(x >> 11) * 0x1p-53;
}

Result<RequestPlan> make_request_plan(const SceneView& scene, const CameraPath& path,
                                      const PlanOptions& options) {
  Planner planner(scene, path, options);
  for (std::uint32_t client = 0; client < options.clients; ++client) planner.add_client(client);
  RequestPlan plan = planner.take();
  if (plan.asks.empty()) {
    return make_error(ErrorId::kUsage, "no impostor comes into view along this path",
                      "another --path, or a longer --duration");
  }
  return plan;
}

}  // namespace mirage
