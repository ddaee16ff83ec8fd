#pragma once
// Screen: the picture that a client shows, from frame to frame. It keeps the picture while that
// would not change, and refines it at rest. It uses the planned samples and scale.
// Input:  the draw list of a frame.
// Output: a picture to show.
// Thread: the GL thread.
// Full:   never; it holds one picture.

#include <cstddef>
#include <memory>

#include "client/frame/frame_step.h"
#include "protocol/base/result.h"

namespace mirage {

class ClientSession;
class FrameRenderer;
class FrameTarget;
struct FrameWork;
struct PlannedFrame;

class Screen {
 public:
  Screen();
  ~Screen();
  Screen(Screen&&) noexcept;
  Screen& operator=(Screen&&) noexcept;

  /// Creates the target. Error kGraphicsGl.
  Result<void> create(int width, int height);

  bool created() const;

  /// Fits the target to a window of this size and to the session's plan. Error kGraphicsGl.
  Result<void> fit(int width, int height, const ClientSession& session);
  /// Notes that texels, geometry or a scene came or went.
  void content_changed();

  /// Returns the step for a frame; draw() or refine() takes it.
  FrameStep next(const PlannedFrame& frame, const ClientSession& session);
  void draw(FrameRenderer& renderer, const PlannedFrame& frame);
  void refine(FrameRenderer& renderer, const PlannedFrame& frame);
  /// Returns the work of draw() with this frame.
  FrameWork work(const PlannedFrame& frame) const;

  /// Returns the picture to show.
  const FrameTarget& shown() const;
  /// True if the picture would not get any better.
  bool refined() const;
  int width() const;
  int height() const;
  int samples() const;
  std::size_t gpu_bytes() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace mirage
