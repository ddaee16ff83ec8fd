#pragma once
// Why a frame is drawn as it is: of each thing in view what was chosen, what else there was, and
// what each costs in error and time (the file of --explain-frame).

#include <string>

#include "client/session/client_session.h"

namespace mirage {

/// The frame planned last, as JSON: its budget, lambda, setting; `things` with `instance` and
/// `object` (the server's ids), `area_px`, `chosen` and `alternatives`, each a way with `error`
/// (FLIP times px), `ms`, and `cost` = error + lambda ms.
std::string explain_frame(const ClientSession& session);

}  // namespace mirage
