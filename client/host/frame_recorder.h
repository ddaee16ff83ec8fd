#pragma once
// Frame recorder: where the real time of each frame went, and why late frames were late.
// Input:  laps, at the end of each stage of a frame.
// Output: the frames, their late causes, and both as JSON.
// Thread: the frame loop's.
// Full:   never; it keeps some 100 bytes for each frame.

#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "protocol/base/clock.h"

namespace mirage {

/// The stages of a frame, in their order.
enum class FrameStage {
  kReceive,  ///< messages are taken in, without uploads
  kUpload,   ///< texels and geometry go to the graphics card
  kPlan,     ///< what to draw is decided, and asks are sent
  kCompile,  ///< a frame is drawn that had shader programs compiled
  kDraw,     ///< draw calls of any other frame are issued
  kFinish,   ///< the graphics card, or the software renderer, carries the draw calls out
  kShow,     ///< the picture goes to the window, including the wait for the display
  kOther,    ///< what is left, for example files written
};
inline constexpr std::size_t kFrameStages = 8;
const char* frame_stage_name(FrameStage stage);

/// A frame that was drawn, by the wall clock.
struct RecordedFrame {
  std::int64_t began_us = 0;  ///< since the first frame began
  std::array<float, kFrameStages> ms{};
  float budget_ms = 0;  ///< 0: none
  float scale = 1;      ///< edge of the drawn picture over that of the shown one
  std::uint32_t visible = 0, placeholders = 0;  ///< instances

  double all_ms() const;
  bool late() const;  ///< longer than 1.1 budgets
};

class FrameRecorder {
 public:
  explicit FrameRecorder(const Clock& clock) : clock_(clock) {}

  void begin();
  /// Adds the time since the last lap, or since begin(), to a stage. `upload_ms` of it were spent
  /// in uploads, and go to kUpload.
  void lap(FrameStage stage, double upload_ms = 0);
  /// Ends the frame. `frame` has what the laps do not tell; its times are replaced.
  void end(RecordedFrame frame);

  const std::vector<RecordedFrame>& frames() const { return frames_; }
  /// Returns figures of all frames: times by stage, late frames by cause, and instances without an
  /// image, in all and from the 5th second on. A late frame's cause is the stage that took the most
  /// time beyond its median.
  nlohmann::ordered_json summary() const;
  /// Returns every frame, for `--trace`.
  nlohmann::ordered_json json() const;

 private:
  using StageTimes = std::array<float, kFrameStages>;
  StageTimes medians() const;

  const Clock& clock_;
  std::int64_t first_us_ = -1, began_us_ = 0, lap_us_ = 0;
  std::array<float, kFrameStages> ms_{};
  std::vector<RecordedFrame> frames_;
};

}  // namespace mirage
