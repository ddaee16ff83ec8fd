#pragma once
// Screen: the picture that a client shows, from frame to frame. It keeps the picture while that
// would not change, and refines it at rest. It uses the planned samples and scale.
// Input:  the draw list of a frame.
// Output: a picture to show.
// Thread: the GL thread.
// Full:   never; it holds one picture.

#include <cstddef>
#include <optional>

#include "client/draw/frame_target.h"
#include "client/draw/refinement.h"
#include "client/frame/frame_step.h"
#include "client/session/stillness.h"
#include "protocol/base/result.h"

namespace mirage {

class ClientSession;
struct FrameWork;

class Screen {
 public:
  /// Creates the target. Error kGraphicsGl.
  Result<void> create(int width, int height);

  bool created() const { return target_.has_value(); }

  /// Fits the target to a window of this size and to the session's plan. Error kGraphicsGl.
  Result<void> fit(int width, int height, const ClientSession& session);
  /// Notes that texels, geometry or a scene came or went.
  void content_changed() { still_.content_changed(); }

  /// Returns the step for a frame; draw() or refine() takes it.
  FrameStep next(const PlannedFrame& frame, const ClientSession& session);
  void draw(FrameRenderer& renderer, const PlannedFrame& frame);
  void refine(FrameRenderer& renderer, const PlannedFrame& frame);
  /// Returns the work of draw() with this frame.
  FrameWork work(const PlannedFrame& frame) const;

  /// Returns the picture to show.
  const FrameTarget& shown() const { return refinement_.picture(*target_); }
  /// True if the picture would not get any better.
  bool refined() const { return refinement_.done(); }
  int width() const { return target_->width(); }
  int height() const { return target_->height(); }
  int samples() const { return target_->samples(); }
  std::size_t gpu_bytes() const { return target_->gpu_bytes() + refinement_.gpu_bytes(); }

 private:
  Result<void> make(int width, int height, bool blends, int samples, double scale);

  std::optional<FrameTarget> target_;
  // Planned for the target; the device may not have as many samples.
  int samples_ = 1;
  double scale_ = 1;
  Stillness still_;
  Refinement refinement_;
};

}  // namespace mirage
