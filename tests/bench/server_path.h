#pragma once
#include "tests/bench/bench.h"

namespace mirage::bench {

/// Measures the server's CPU time for a tile besides drawing: queues, encoding, store, message,
/// network loop. Real tiles, drawn once and sent again and again, stand in for the render stage.
Result<std::vector<Row>> server_path(const Conditions& conditions);

}  // namespace mirage::bench
