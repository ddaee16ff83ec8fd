#pragma once
// Video baseline: the video baselines of the latency part, plain and with rotational timewarp.

#include "client/report/latency_run.h"
#include "client/report/session_run.h"

namespace mirage {

struct VideoRuns {
  LatencyRun plain, warped;  ///< samples, mbps and first image are set; the caller sets the rest
};

/// Streams the path of `spec` over its link, and compares the frames that a session would compare.
/// Errors as TruthSource::at, and kCodec.
Result<VideoRuns> run_video(const RunSpec& spec, TruthSource& truth);

}  // namespace mirage
