#pragma once
// Results: the files that a session leaves behind.

#include <string>

#include "client/view/session_stats.h"
#include "protocol/base/result.h"

namespace mirage {

class ClientHost;
class ClientSession;
class FrameRecorder;

/// Names of the files; empty: not written.
struct ResultFiles {
  std::string trace, explain, stats;
};

/// Returns what host and session know at the end.
SessionStats::Final end_of(const ClientHost& host);
/// Writes the files. Error kIo.
Result<void> write_results(const ResultFiles& files, const SessionStats& stats,
                           const SessionStats::Final& end, const ClientSession& session,
                           const FrameRecorder& recorder);

}  // namespace mirage
