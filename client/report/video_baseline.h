#pragma once
// The video baselines of the latency part, plain and with rotational timewarp.

#include "client/report/latency_run.h"
#include "client/report/session_run.h"

namespace mirage {

struct VideoRuns {
  LatencyRun plain, warped;  ///< samples, mbps and first image; the rest is the caller's
};

/// Streams the path of `spec` over its link and compares the same frames as a session would.
/// Errors as TruthSource::at, and kCodec.
Result<VideoRuns> run_video(const RunSpec& spec, TruthSource& truth);

}  // namespace mirage
