#pragma once
// Wire server cases: hostile bytes to a running server, over raw sockets.

#include "tests/extreme/extreme_case.h"

namespace mirage::extreme {

/// R1: WebSocket packets that announce up to 2^63 bytes.
void websocket_lengths(Checks& checks);
/// R4: messages and greetings of other versions.
void versions_to_server(Checks& checks);
/// R6
Case slow_loris_case();

}  // namespace mirage::extreme
