#pragma once
// What takes long: full renders, views and large tiles, one at a time and a slice at a time, so
// that small tiles are drawn between two slices. GL thread only. Input:  jobs of the render stage.
// Output: pictures and tiles to the encode stage's slow queue. Full:   has_room() says so; the tile
// queue then keeps what is slow.

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
  /// All but the options outlive it.
  SlowWork(StageQueues& queues, const std::function<void()>& wake, GlWorld& world,
           const RenderOptions& options, bool software);

  /// Tiles from this edge on, texels, are slow.
  std::uint32_t slow_edge() const { return slow_edge_; }
  /// For something new.
  bool has_room() const;
  bool under_way() const { return !std::holds_alternative<std::monostate>(job_); }

  using Job = std::variant<std::monostate, ViewJob, ReferenceJob, TileJob>;
  /// What there is no room for, within --gpu-mb or at all, is refused. Error kGraphicsGl: the
  /// device has failed.
  Result<void> begin(Job job);
  /// Draws a slice; hands over what is whole. Something must be under way. Errors as begin().
  Result<void> draw_slice();
  /// What is under way is not wanted.
  void drop();

 private:
  // Error kGraphicsGl: there is no room for it.
  Result<void> begin_picture(const SceneShot& shot);
  Result<void> begin_tile(const TileJob& job);
  /// What is under way, which is dropped.
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
