#include "client/load/report.h"
#include "protocol/base/figures.h"

namespace mirage {
namespace {

const std::vector<Figure> kStatistics = {
    {"clients", "", "Clients of the run."},
    {"connected", "", "Clients that were connected when asking began."},
    {"duration_s", "s", "Time during which clients asked."},
    {"tiles", "", "Tiles received."},
    {"tiles_per_s", "tiles/s", "Tiles received per second."},
    {"bytes", "bytes", "Bytes received."},
    {"latency_ms.p50", "ms", "From the intended time of a request to its reply, median."},
    {"latency_ms.p95", "ms", "95th percentile."},
    {"latency_ms.p99", "ms", "99th percentile."},
    {"latency_ms.max", "ms", "Longest."},
    {"late", "",
     "Tiles that came more than 5 s after the asking ended. They count as `no-answer`, too, and "
     "not as received."},
    {"late_ms.p50", "ms", "From the intended time of their request to the reply, median."},
    {"late_ms.max", "ms", "Longest."},
    {"errors.ID", "", "Errors with the id ID (docs/reference/errors.md)."},
    {"verified", "", "Tiles that were decoded and checked."},
    {"verify_failures", "", "Tiles that failed the check; must be 0."},
    {"connected_at_end", "", "Clients that were connected at the end."},
    {"asked", "", "Tiles requested."},
    {"distinct_asks", "", "Different tiles requested."},
    {"elapsed_s", "s", "Until the last reply."},
    {"send_lag_ms.p50", "ms", "Delay of a request inside mirage-load, median."},
    {"send_lag_ms.p99", "ms", "99th percentile; if it is large, mirage-load is the bottleneck."},
    {"send_lag_ms.max", "ms", "Longest."},
    {"server_ms.p50", "ms", "Time of a tile inside the server, as the server says, median."},
    {"server_ms.p99", "ms", "99th percentile."},
    {"server_ms.max", "ms", "Longest."},
    {"reconnects", "", "Lost connections that were opened again."},
    {"away_ms.p50", "ms", "From a lost connection to the scene received again, median."},
    {"away_ms.p99", "ms", "99th percentile."},
    {"away_ms.max", "ms", "Longest."},
    {"warmed", "", "Tiles requested by --warm or --warm-shard before the run."},
    {"server.tiles_rendered", "", "Tiles that the server rendered during the run."},
    {"server.tiles_merged", "", "Requests that the server merged with an equal one."},
    {"server.store_hits", "", "Tiles that the server had already."},
    {"server.tiles_cancelled", "", "Requests that were cancelled."},
    {"server.tiles_late", "", "Requests that the server dropped as too late."},
};

}  // namespace

std::string load_statistics_page() {
  return figures_page("Statistics of the load client",
                      "`mirage-load --json FILE.json` writes these. A dot is a level of the JSON "
                      "file; `server` is `null` where the\nserver does not tell.",
                      kStatistics);
}

}  // namespace mirage
