#include "client/load/report.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "protocol/base/quantile.h"

namespace mirage {
namespace {

using nlohmann::ordered_json;

// Rounds to microseconds: that is the precision measured, and more digits would be noise.
ordered_json rounded(double v) { return std::round(v * 1000) / 1000; }

ordered_json at_quantile(const std::vector<float>& values, double q) {
  return values.empty() ? ordered_json(nullptr) : rounded(quantile(values, q));
}

double per_second(std::uint64_t count, const LoadResults& r) {
  return static_cast<double>(count) / std::max(r.elapsed_s, 1e-9);
}

}  // namespace

std::string to_json(const LoadResults& r) {
  ordered_json j;
  j["clients"] = r.clients;
  j["connected"] = r.connected;
  j["duration_s"] = rounded(r.duration_s);
  j["tiles"] = r.tiles;
  j["tiles_per_s"] = rounded(per_second(r.tiles, r));
  j["bytes"] = r.bytes;
  j["latency_ms"] = {{"p50", at_quantile(r.latency_ms, 0.5)},
                     {"p95", at_quantile(r.latency_ms, 0.95)},
                     {"p99", at_quantile(r.latency_ms, 0.99)},
                     {"max", at_quantile(r.latency_ms, 1.0)}};
  j["late"] = r.late_ms.size();
  j["late_ms"] = {{"p50", at_quantile(r.late_ms, 0.5)}, {"max", at_quantile(r.late_ms, 1.0)}};
  j["errors"] = ordered_json::object();
  for (const auto& [id, count] : r.errors) j["errors"][id] = count;
  j["verified"] = r.verified;
  j["verify_failures"] = r.verify_failures;
  j["connected_at_end"] = r.connected_at_end;
  j["asked"] = r.asked;
  j["distinct_asks"] = r.distinct_asks;
  j["elapsed_s"] = rounded(r.elapsed_s);
  j["send_lag_ms"] = {{"p50", at_quantile(r.send_lag_ms, 0.5)},
                      {"p99", at_quantile(r.send_lag_ms, 0.99)},
                      {"max", at_quantile(r.send_lag_ms, 1.0)}};
  j["server_ms"] = {{"p50", at_quantile(r.server_ms, 0.5)},
                    {"p99", at_quantile(r.server_ms, 0.99)},
                    {"max", at_quantile(r.server_ms, 1.0)}};
  j["reconnects"] = r.away_ms.size();
  j["away_ms"] = {{"p50", at_quantile(r.away_ms, 0.5)},
                  {"p99", at_quantile(r.away_ms, 0.99)},
                  {"max", at_quantile(r.away_ms, 1.0)}};
  j["warmed"] = r.warmed;
  j["server"] = nullptr;
  if (r.server) {
    j["server"] = {{"tiles_rendered", r.server->tiles_rendered},
                   {"tiles_merged", r.server->tiles_merged},
                   {"store_hits", r.server->store_hits},
                   {"tiles_cancelled", r.server->tiles_cancelled},
                   {"tiles_late", r.server->tiles_late}};
  }
  return j.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::string to_table(const LoadResults& r) {
  if (r.warmed > 0) return fmt::format("warmed           {} tiles\n", r.warmed);
  std::string out = fmt::format(
      "clients          {} of {} connected\n"
      "tiles            {} of {} asked for ({} distinct) in {:.1f} s, {:.1f} tiles/s\n"
      "bytes            {:.2f} MB, {:.2f} MB/s\n",
      r.connected, r.clients, r.tiles, r.asked, r.distinct_asks, r.elapsed_s,
      per_second(r.tiles, r), static_cast<double>(r.bytes) * 1e-6, 1e-6 * per_second(r.bytes, r));
  if (!r.latency_ms.empty()) {
    out += fmt::format("latency          {:.1f} ms p50, {:.1f} p95, {:.1f} p99, {:.1f} max\n",
                       quantile(r.latency_ms, 0.5), quantile(r.latency_ms, 0.95),
                       quantile(r.latency_ms, 0.99), quantile(r.latency_ms, 1.0));
    out += fmt::format("own send lag     {:.1f} ms p99, {:.1f} max (part of the latency)\n",
                       quantile(r.send_lag_ms, 0.99), quantile(r.send_lag_ms, 1.0));
  }
  if (!r.late_ms.empty()) {
    out += fmt::format(
        "late             {} tiles after they were given up, {:.0f} ms p50, {:.0f} max\n",
        r.late_ms.size(), quantile(r.late_ms, 0.5), quantile(r.late_ms, 1.0));
  }
  if (!r.away_ms.empty()) {
    out += fmt::format("reconnects       {}, away {:.0f} ms p50, {:.0f} p99, {:.0f} max\n",
                       r.away_ms.size(), quantile(r.away_ms, 0.5), quantile(r.away_ms, 0.99),
                       quantile(r.away_ms, 1.0));
  }
  out += fmt::format("verified         {} decoded, {} failures\n", r.verified, r.verify_failures);
  if (r.server) {
    out += fmt::format("server           {} rendered, {} merged, {} store hits\n",
                       r.server->tiles_rendered, r.server->tiles_merged, r.server->store_hits);
  }
  for (const auto& [id, count] : r.errors)
    out += fmt::format("error            {} {}\n", count, id);
  return out;
}

}  // namespace mirage
