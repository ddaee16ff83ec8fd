#pragma once
// Request plan: which client asks for which tile, and when; fixed before anything is sent.
// Input:  the scene, a camera path, numbers.
// Output: asks by time, over a table of distinct needs.
// Thread: any; it is a pure function.
// Full:   never; the options limit the number of asks.

#include <cstdint>
#include <vector>

#include "client/frame/camera_path.h"
#include "client/plan/tile_need.h"
#include "protocol/base/result.h"

namespace mirage {

class SceneView;

struct PlanOptions {
  std::uint32_t clients = 1;
  double duration_s = 1;
  double rate_hz = 1;
  double spread_s = 0;
  double fps = 30;
  Camera camera;  ///< field of view and size
  double tau_px = 1;
  std::uint64_t seed = 1;
};

struct PlannedAsk {
  std::int64_t intended_us = 0;  ///< time since the start
  std::uint32_t client = 0;
  std::uint32_t need = 0;  ///< index into RequestPlan::needs
};

struct RequestPlan {
  std::vector<TileNeed> needs;   ///< distinct needs: together the tiles of the whole run
  std::vector<PlannedAsk> asks;  ///< by time
};

/// Makes the plan. Every client follows the path from its own offset, and asks at even intervals
/// from its own phase. It takes the instances in view by turns, from large to small, and begins
/// anywhere among them: if all began with the largest, they would ask for large tiles only. Error
/// kUsage if no impostor is in view anywhere along the path.
Result<RequestPlan> make_request_plan(const SceneView& scene, const CameraPath& path,
                                      const PlanOptions& options);

/// Returns a value uniform in [0, 1) from a seed and up to two numbers, the same on every machine.
double seeded_share(std::uint64_t seed, std::uint64_t a, std::uint64_t b = 0);

}  // namespace mirage
