#include "server/net/metrics.h"

#include <fmt/format.h>
#include <prometheus/text_serializer.h>

#include <vector>

#include "protocol/base/figures.h"

namespace mirage {
namespace {

using prometheus::ClientMetric;
using prometheus::MetricFamily;
using prometheus::MetricType;
using Labels = std::vector<ClientMetric::Label>;

class Families {
 public:
  /// Adds a metric to the family begun last, or begins a new family.
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
  const std::vector<MetricFamily>& all() const { return all_; }

 private:
  std::vector<MetricFamily> all_;
};

void add_tiles(Families& out, const Counters& c) {
  out.counter("tiles_asked", c.tiles_asked, "Tiles that clients requested.");
  out.counter("tiles_rendered", c.tiles_rendered, "Tiles rendered.");
  out.counter("tiles_merged", c.tiles_merged, "Tile requests that were merged with an equal one.");
  out.counter("tiles_cancelled", c.tiles_cancelled, "Tile requests that clients cancelled.");
  out.counter("tiles_late", c.tiles_late,
              "Tile requests dropped because their deadline had passed or could not be met.");
  out.counter("tiles_refused", c.tiles_refused, "Requests of any kind that were refused.");
  for (std::size_t i = 0; i < c.refused_for.size(); ++i) {
    out.counter("refusals", c.refused_for[i], "Refused requests by reason.",
                {{"reason", Counters::kReasons[i]}});
  }
  out.counter("tile_forms_made", c.forms_made, "Tiles converted to another codec.");
  out.counter("store_hits", c.store_hits, "Tiles served without rendering them.");
  const std::uint64_t slower = c.directory_hits + c.shared_store_hits;
  const std::string help =
      "Tiles served without rendering them, by the place where they were found.";
  out.counter("tile_hits", c.store_hits - std::min<std::uint64_t>(slower, c.store_hits), help,
              {{"tier", "memory"}});
  out.counter("tile_hits", c.directory_hits, help, {{"tier", "directory"}});
  out.counter("tile_hits", c.shared_store_hits, help, {{"tier", "redis"}});
  out.counter("records_wrong", c.records_wrong,
              "Stored tiles that were damaged and rendered again.");
  out.counter("tiles_left_to_others", c.tiles_left_to_others,
              "Tiles that this server left to another one that was rendering them.");
  out.counter("fetches_given_up", c.fetches_given_up,
              "Tiles rendered because directory or Redis answered too slowly.");
  out.counter("tiles_not_saved", c.tiles_not_saved,
              "Tiles not stored because directory or Redis is slow, full or gone.");
  out.gauge("store_bytes", c.store_bytes, "Bytes of the tiles in memory.");
  out.gauge("store_tiles", c.store_tiles, "Tiles in memory.");
  out.counter("store_evictions", c.store_evictions,
              "Tiles removed from memory to stay within --cache-mb.");
}

void add_rendering(Families& out, const Counters& c) {
  out.counter("pages_rendered", c.pages_rendered, "Pages rendered; a page holds many tiles.");
  out.counter("references_rendered", c.references_rendered, "Full renders of the scene.");
  out.counter("views_rendered", c.views_rendered,
              "View tiles (the whole scene as one tile) that were rendered.");
  out.counter("views_sent", c.views_sent, "View tiles that were sent to clients.");
  out.counter("pictures_sent", c.pictures_sent, "Full renders that were sent as files by HTTP.");
  out.gauge("gpu_scene_bytes", c.gpu_scene_bytes, "Graphics memory of the scene, bytes.");
  out.gauge("gpu_target_bytes", c.gpu_target_bytes,
            "Graphics memory of the render targets, bytes.");
  out.gauge("gpu_most_bytes", c.gpu_most_bytes, "Largest graphics memory in use so far, bytes.");
  out.gauge("shader_programs", c.shader_programs,
            "Shader programs compiled before the server was ready.");
  out.counter("shader_programs_after_ready", c.shader_programs_after_ready,
              "Shader programs compiled while clients waited; should stay 0.");
}

void add_stages(Families& out, const Counters& c) {
  const std::string name = "stage_seconds",
                    help =
                        "Time a tile spent in each stage, seconds; whole: from request to reply.";
  out.histogram(name, c.fetch_times, help, {{"stage", "fetch"}});
  out.histogram(name, c.queue_times, help, {{"stage", "queue"}});
  out.histogram(name, c.render_times, help, {{"stage", "render"}});
  out.histogram(name, c.encode_times, help, {{"stage", "encode"}});
  out.histogram(name, c.whole_times, help, {{"stage", "whole"}});
}

void add_peers(Families& out, const Counters& c, const HubState& s) {
  out.gauge("clients", s.clients, "Clients that were admitted.");
  out.gauge("strangers", s.strangers, "Connections that have not been admitted yet.");
  out.gauge("outbox_bytes", s.outbox_bytes, "Bytes of replies that wait to be sent.");
  out.gauge("largest_outbox_bytes", s.largest_outbox_bytes,
            "Bytes of replies that wait for the one client with most of them.");
  out.gauge("tiles_queued", s.tiles_queued, "Tile requests that wait to be rendered.");
  out.gauge("pixels_queued_bytes", s.pixels_bytes,
            "Bytes of rendered pixels that wait to be compressed.");
  out.gauge("draining", s.draining ? 1 : 0, "1 while the server is stopping, else 0.");
  out.counter("authentication_failures", c.authentication_failures,
              "Connections refused for a wrong or missing token.");
  const std::string help = "Connections refused during the handshake, by reason.";
  out.counter("connections_refused", c.upgrades_refused, help, {{"reason", "handshake"}});
  out.counter("connections_refused", c.addresses_refused, help, {{"reason", "failures"}});
  out.counter("clients_closed_for_error", c.clients_closed_for_error,
              "Clients disconnected because of an error.");
  out.counter("meshes_sent", c.meshes_sent, "Mesh levels of detail sent.");
  out.counter("images_sent", c.images_sent, "Texture levels sent.");
  out.counter("bytes_sent", c.bytes_sent, "Bytes of messages sent.");
  out.counter("bytes_received", c.bytes_received, "Bytes of messages received.");
}

Families families(const Counters& counters, const HubState& state, const Identity& identity) {
  Families out;
  add_tiles(out, counters);
  add_rendering(out, counters);
  add_stages(out, counters);
  add_peers(out, counters, state);
  out.gauge("build_info", 1,
            "Version, revision of the scene, render profile and renderer, as labels; always 1.",
            {{"version", MIRAGE_VERSION},
             {"revision", fmt::format("{:016x}", identity.revision)},
             {"profile", fmt::format("{:016x}", identity.profile)},
             {"renderer", identity.renderer}});
  return out;
}

std::string type_name(MetricType type) {
  return type == MetricType::Counter ? "counter"
         : type == MetricType::Gauge ? "gauge"
                                     : "histogram";
}

/// Returns the label that distinguishes the metrics of a family, with its values; empty: none.
std::string labels_of(const MetricFamily& family) {
  if (family.metric.front().label.size() != 1) return "";
  std::string out = " Label `" + family.metric.front().label.front().name + "`:";
  const char* before = " ";
  for (const ClientMetric& metric : family.metric) {
    out += before + metric.label.front().value;
    before = ", ";
  }
  return out + ".";
}

}  // namespace

std::string metrics_text(const Counters& counters, const HubState& state,
                         const Identity& identity) {
  return prometheus::TextSerializer().Serialize(families(counters, state, identity).all());
}

std::string metrics_page() {
  std::vector<Figure> figures;
  const Families nothing_counted = families({}, {}, {});
  for (const MetricFamily& family : nothing_counted.all()) {
    figures.push_back({family.name, type_name(family.type), family.help + labels_of(family)});
  }
  return figures_page(
      "Metrics of a server",
      "`mirage-server --admin PORT` serves these at `/metrics` in the text format of "
      "Prometheus. A counter only grows,\na gauge goes up and down, a histogram "
      "counts times by their size. The unit column names the type.",
      figures);
}

}  // namespace mirage
