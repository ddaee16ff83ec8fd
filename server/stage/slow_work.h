#pragma once
// Slow work: full renders, views and large tiles, one at a time and slice by slice, so that small
// tiles are drawn between two slices.
// Input:  jobs of the render stage
// Output: pictures and tiles to the encode stage's slow queue
// Thread: the GL thread only
// Full:   has_room() is false, and the tile queue keeps slow jobs

#include <cstdint>
#include <functional>
#include <variant>

#include "protocol/base/result.h"
#include "server/stage/render_options.h"
#include "server/tile/tile_job.h"

namespace mirage {

struct GlWorld;
struct StageQueues;

class SlowWork {
 public:
  /// All arguments except the options must outlive this object.
  SlowWork(StageQueues& queues, const std::function<void()>& wake, GlWorld& world,
           const RenderOptions& options, bool software);

  /// Returns the smallest edge, texels, at which a tile is slow work.
  std::uint32_t slow_edge() const { return slow_edge_; }
  /// True if a new job may begin; it takes the place of an idle one.
  bool has_room() const;
  bool under_way() const { return !std::holds_alternative<std::monostate>(job_); }
  /// True if an idle full render is under way.
  bool idle() const;

  using Job = std::variant<std::monostate, ViewJob, ReferenceJob, TileJob>;
  /// Begins a job. An idle one under way goes back into the tile queue. Refuses a job that exceeds
  /// --gpu-mb or the device's memory. Error kGraphicsGl: the device has failed.
  Result<void> begin(Job job);
  /// Draws a slice of the job under way, and hands over the result after the last. Errors as
  /// begin().
  Result<void> draw_slice();
  /// Abandons the job under way.
  void drop();

 private:
  // Error kGraphicsGl: there is no room for the job.
  Result<void> begin_picture(const SceneShot& shot);
  Result<void> begin_tile(const TileJob& job);
  /// Refuses the job under way and drops it.
  void refuse(const Error& why);
  void hand_over(SceneFrame frame);
  void hand_over(std::shared_ptr<const PagePixels> pixels);
  void announce(Completion done);

  StageQueues& queues_;
  const std::function<void()>& wake_;
  GlWorld& world_;
  const std::size_t most_bytes_;
  const bool software_;
  const double slice_samples_;
  const std::uint32_t slow_edge_;
  Job job_;
  std::int64_t started_us_ = 0;
};

}  // namespace mirage
