#pragma once
// Run log: what a run measures and tells while frames go by, and the files that it leaves behind.
// Input:  the client after each step of a frame, the times of the frame.
// Output: lines in the log; at the end a table and files.
// Thread: the frame loop's.
// Full:   never; it keeps some numbers for each frame.

#include <cstdint>
#include <optional>

#include "client/host/frame_recorder.h"
#include "client/view/comparison.h"
#include "client/view/session_stats.h"
#include "protocol/base/clock.h"
#include "protocol/base/result.h"

namespace mirage {

class Client;
class ClientHost;
struct ViewOptions;

class RunLog {
 public:
  RunLog(const ViewOptions& options, const Clock& clock)
      : options_(options), clock_(clock), recorder_(clock) {}

  FrameRecorder& recorder() { return recorder_; }
  SessionStats& stats() { return stats_; }

  /// Notes the scene once it is complete, and that the server has gone or is back.
  void note_arrivals(const ClientHost& host);
  /// Notes programs that were compiled within a draw.
  void note_compiled(std::uint64_t programs) { programs_in_draws_ += programs; }
  struct FrameTimes {
    std::int64_t planned_us = 0;  ///< time of the session that it was planned at
    double session_ms = 0;        ///< that it took by the session's clock
    double real_ms = 0;           ///< the same by the wall clock
  };
  /// Notes a frame whose picture is shown; `drawn`: it is a new one.
  void note_frame(ClientHost& host, const Client& client, bool drawn, const FrameTimes& times);
  /// Tells how far a long run has come, now and then.
  void tell_progress(std::int64_t done);
  /// Writes the picture of a frame, if the options say so. Error kIo.
  Result<void> write_picture(const Client& client, std::int64_t frame) const;
  /// Compares the picture with the server's full render. Errors kComparison, kIo.
  Result<void> compare(ClientHost& host, const Client& client);
  /// The frames begin now, by the session's clock.
  void start(std::int64_t now_us) { start_us_ = now_us; }
  /// Prints the table and writes the files. Errors kGraphicsGl, kIo.
  Result<void> finish(const ClientHost& host, const Client& client) const;

 private:
  void record(const ClientHost& host, const Client& client);

  const ViewOptions& options_;
  const Clock& clock_;
  FrameRecorder recorder_;
  SessionStats stats_;
  Comparison comparison_;
  std::int64_t start_us_ = 0;
  bool link_was_up_ = true;
  double told_s_ = 0;  ///< real time of the last line about the progress
  std::uint64_t programs_at_scene_ = 0, programs_in_draws_ = 0;
};

}  // namespace mirage
