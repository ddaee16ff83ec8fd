#include "server/net/metrics.h"

#include <fmt/format.h>
#include <prometheus/text_serializer.h>

#include <vector>

namespace mirage {
namespace {

using prometheus::ClientMetric;
using prometheus::MetricFamily;
using prometheus::MetricType;
using Labels = std::vector<ClientMetric::Label>;

class Families {
 public:
  /// One more of the family that was begun last, or of a new one.
  ClientMetric& add(const std::string& name, MetricType type, const std::string& help,
                    Labels labels = {}) {
    const std::string full = "mirage_" + name;
    if (all_.empty() || all_.back().name != full) all_.push_back({full, help, type, {}});
    ClientMetric& metric = all_.back().metric.emplace_back();
    metric.label = std::move(labels);
    return metric;
  }
  void counter(const std::string& name, std::uint64_t value, const std::string& help,
               Labels labels = {}) {
    add(name + "_total", MetricType::Counter, help, std::move(labels)).counter.value =
        static_cast<double>(value);
  }
  void gauge(const std::string& name, std::uint64_t value, const std::string& help,
             Labels labels = {}) {
    add(name, MetricType::Gauge, help, std::move(labels)).gauge.value = static_cast<double>(value);
  }
  void histogram(const std::string& name, const TimeHistogram& times, const std::string& help,
                 Labels labels) {
    ClientMetric::Histogram& out =
        add(name, MetricType::Histogram, help, std::move(labels)).histogram;
    for (std::size_t i = 0; i < TimeHistogram::kBoundsUs.size(); ++i) {
      out.sample_count += times.count(i);
      out.bucket.push_back(
          {out.sample_count, static_cast<double>(TimeHistogram::kBoundsUs[i]) * 1e-6});
    }
    out.sample_count += times.count(TimeHistogram::kBoundsUs.size());
    out.sample_sum = static_cast<double>(times.sum_us()) * 1e-6;
  }
  std::string text() const { return prometheus::TextSerializer().Serialize(all_); }

 private:
  std::vector<MetricFamily> all_;
};

void add_tiles(Families& out, const Counters& c) {
  out.counter("tiles_asked", c.tiles_asked, "Tiles that clients asked for.");
  out.counter("tiles_rendered", c.tiles_rendered, "Tiles that were rendered.");
  out.counter("tiles_merged", c.tiles_merged, "Asks for a tile that another waited for already.");
  out.counter("tiles_cancelled", c.tiles_cancelled, "Asks that were taken back.");
  out.counter("tiles_late", c.tiles_late, "Asks whose deadline was not to be met.");
  out.counter("tiles_refused", c.tiles_refused, "Asks for anything that were refused.");
  for (std::size_t i = 0; i < c.refused_for.size(); ++i) {
    out.counter("refusals", c.refused_for[i], "The same by reason.",
                {{"reason", Counters::kReasons[i]}});
  }
  out.counter("tile_forms_made", c.forms_made, "Tiles encoded anew for another codec.");
  out.counter("store_hits", c.store_hits, "Tiles that were there.");
  const std::uint64_t slower = c.directory_hits + c.shared_store_hits;
  const std::string help = "The same by where they were.";
  out.counter("tile_hits", c.store_hits - std::min<std::uint64_t>(slower, c.store_hits), help,
              {{"tier", "memory"}});
  out.counter("tile_hits", c.directory_hits, help, {{"tier", "directory"}});
  out.counter("tile_hits", c.shared_store_hits, help, {{"tier", "redis"}});
  out.counter("records_wrong", c.records_wrong, "Kept tiles that were damaged, and made anew.");
  out.counter("tiles_left_to_others", c.tiles_left_to_others,
              "Tiles that another server was rendering.");
  out.counter("fetches_given_up", c.fetches_given_up,
              "Asks that a slow disk or store was passed for.");
  out.counter("tiles_not_saved", c.tiles_not_saved,
              "Tiles not kept: disk or store are too slow, full or gone.");
  out.gauge("store_bytes", c.store_bytes, "Tiles in memory.");
  out.gauge("store_tiles", c.store_tiles, "Their number.");
  out.counter("store_evictions", c.store_evictions, "Tiles let go for the budget.");
}

void add_rendering(Families& out, const Counters& c) {
  out.counter("pages_rendered", c.pages_rendered, "Pages of tiles.");
  out.counter("references_rendered", c.references_rendered, "Full renders.");
  out.counter("views_rendered", c.views_rendered, "View tiles that were rendered.");
  out.counter("views_sent", c.views_sent, "View tiles that were sent.");
  out.gauge("gpu_scene_bytes", c.gpu_scene_bytes, "Graphics memory of the scene.");
  out.gauge("gpu_target_bytes", c.gpu_target_bytes, "Graphics memory of pages.");
  out.gauge("gpu_most_bytes", c.gpu_most_bytes, "Graphics memory of all, at most so far.");
  out.gauge("shader_programs", c.shader_programs, "Compiled at the start.");
  out.counter("shader_programs_after_ready", c.shader_programs_after_ready,
              "Compiled while somebody waited.");
}

void add_stages(Families& out, const Counters& c) {
  const std::string name = "stage_seconds",
                    help = "What a tile took, by stage; whole: from the ask to the answer.";
  out.histogram(name, c.fetch_times, help, {{"stage", "fetch"}});
  out.histogram(name, c.queue_times, help, {{"stage", "queue"}});
  out.histogram(name, c.render_times, help, {{"stage", "render"}});
  out.histogram(name, c.encode_times, help, {{"stage", "encode"}});
  out.histogram(name, c.whole_times, help, {{"stage", "whole"}});
}

void add_peers(Families& out, const Counters& c, const HubState& s) {
  out.gauge("clients", s.clients, "Clients with a right hello.");
  out.gauge("strangers", s.strangers, "Connections that have not said one.");
  out.gauge("outbox_bytes", s.outbox_bytes, "Answers that wait to be sent.");
  out.gauge("largest_outbox_bytes", s.largest_outbox_bytes, "The same of the client with most.");
  out.gauge("tiles_queued", s.tiles_queued, "Tiles that wait to be rendered.");
  out.gauge("pixels_queued_bytes", s.pixels_bytes, "Rendered pixels that wait to be encoded.");
  out.gauge("draining", s.draining ? 1 : 0, "1 once the server was told to stop.");
  out.counter("authentication_failures", c.authentication_failures, "Wrong or missing tokens.");
  const std::string help = "Connections refused as they were made.";
  out.counter("connections_refused", c.upgrades_refused, help, {{"reason", "handshake"}});
  out.counter("connections_refused", c.addresses_refused, help, {{"reason", "failures"}});
  out.counter("clients_closed_for_error", c.clients_closed_for_error,
              "Clients closed for an error.");
  out.counter("meshes_sent", c.meshes_sent, "Levels of meshes.");
  out.counter("images_sent", c.images_sent, "Levels of images.");
  out.counter("bytes_sent", c.bytes_sent, "Of messages.");
  out.counter("bytes_received", c.bytes_received, "Of messages.");
}

}  // namespace

std::string metrics_text(const Counters& counters, const HubState& state,
                         const Identity& identity) {
  Families out;
  add_tiles(out, counters);
  add_rendering(out, counters);
  add_stages(out, counters);
  add_peers(out, counters, state);
  out.gauge("build_info", 1, "What this server is.",
            {{"version", MIRAGE_VERSION},
             {"revision", fmt::format("{:016x}", identity.revision)},
             {"profile", fmt::format("{:016x}", identity.profile)},
             {"renderer", identity.renderer}});
  return out.text();
}

}  // namespace mirage
