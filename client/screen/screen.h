#pragma once
// The picture a client shows, from frame to frame: kept while it would not change, finer and finer
// at rest, of the samples and the scale that are planned.
// Input:  what a frame lists. Output: a picture to show. Thread: the GL one.

#include <cstddef>
#include <optional>

#include "client/draw/frame_target.h"
#include "client/draw/refinement.h"
#include "client/session/stillness.h"
#include "protocol/base/result.h"

namespace mirage {

class ClientSession;
struct FrameWork;

class Screen {
 public:
  /// Error kGraphicsGl.
  Result<void> create(int width, int height);

  /// For a window of this size and what the session plans. Error kGraphicsGl.
  Result<void> fit(int width, int height, const ClientSession& session);
  /// Texels, geometry or a scene came or went.
  void content_changed() { still_.content_changed(); }

  enum class Step {
    kKeep,    ///< it would be the picture that is there
    kDraw,    ///< another one
    kRefine,  ///< the same, finer
  };
  /// What is to be done for a frame; draw() or refine() does it.
  Step next(const Camera& camera, const DrawList& list, const ClientSession& session);
  void draw(FrameRenderer& renderer, const Camera& camera, const DrawList& list,
            const ClientSession& session);
  void refine(FrameRenderer& renderer, const Camera& camera, const DrawList& list,
              const ClientSession& session);
  /// Of draw() with this list.
  FrameWork work(const Camera& camera, const DrawList& list, const ClientSession& session) const;

  /// What is to be seen.
  const FrameTarget& shown() const { return refinement_.picture(*target_); }
  /// Nothing would get better any more.
  bool refined() const { return refinement_.done(); }
  int width() const { return target_->width(); }
  int height() const { return target_->height(); }
  int samples() const { return target_->samples(); }
  std::size_t gpu_bytes() const { return target_->gpu_bytes() + refinement_.gpu_bytes(); }

 private:
  Result<void> make(int width, int height, bool blends, int samples, double scale);

  std::optional<FrameTarget> target_;
  // Of the target, as planned: the device may not have as many samples.
  int samples_ = 1;
  double scale_ = 1;
  Stillness still_;
  Refinement refinement_;
};

}  // namespace mirage
