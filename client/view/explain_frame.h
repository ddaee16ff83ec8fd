#pragma once
// Explain frame: why a frame is drawn as it is. It lists for each visible thing what was chosen,
// the alternatives, and their costs in error and time (the file of --explain-frame).

#include <string>

#include "client/session/client_session.h"

namespace mirage {

/// Returns the last planned frame as JSON: its budget, lambda and setting, and `things` with
/// `instance` and `object` (the server's ids), `area_px`, `chosen` and `alternatives`. Each
/// alternative has `error` (FLIP times px), `ms`, and `cost` = error + lambda ms.
std::string explain_frame(const ClientSession& session);

}  // namespace mirage
