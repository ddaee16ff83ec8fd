#pragma once
// Method runs: one path over one link by several methods: Mirage, all geometry, video.

#include "client/report/context.h"
#include "client/report/latency_run.h"
#include "client/report/session_run.h"

namespace mirage {

/// Runs the session of `spec` by each of "mirage", "geometry", "video", "video+timewarp" or a
/// method of drawing, in that order. Each run is a step of the progress. Failed runs are omissions
/// of `part`.
std::vector<LatencyRun> run_methods(Context& context, const std::string& part, RunSpec spec,
                                    const std::vector<std::string>& methods, OpenScene& scene);

/// Notes in `part` that video is left out, if the program was built without it.
void omit_missing_video(Context& context, const std::string& part);

}  // namespace mirage
