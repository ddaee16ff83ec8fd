#include "server/net/metrics.h"

namespace mirage {
namespace {

void add(std::string& out, const char* name, const char* type, std::uint64_t value) {
  const std::string full = std::string("mirage_") + name;
  out += "# TYPE " + full + " " + type + "\n" + full + " " + std::to_string(value) + "\n";
}

}  // namespace

std::string metrics_text(const Counters& c, std::size_t clients) {
  std::string out;
  add(out, "clients", "gauge", clients);
  add(out, "store_bytes", "gauge", c.store_bytes);
  add(out, "store_tiles", "gauge", c.store_tiles);
  add(out, "tiles_asked_total", "counter", c.tiles_asked);
  add(out, "tiles_rendered_total", "counter", c.tiles_rendered);
  add(out, "tiles_merged_total", "counter", c.tiles_merged);
  add(out, "tiles_cancelled_total", "counter", c.tiles_cancelled);
  add(out, "tiles_late_total", "counter", c.tiles_late);
  add(out, "tiles_refused_total", "counter", c.tiles_refused);
  add(out, "tile_forms_made_total", "counter", c.forms_made);
  add(out, "store_hits_total", "counter", c.store_hits);
  add(out, "directory_hits_total", "counter", c.directory_hits);
  add(out, "shared_store_hits_total", "counter", c.shared_store_hits);
  add(out, "records_wrong_total", "counter", c.records_wrong);
  add(out, "tiles_left_to_others_total", "counter", c.tiles_left_to_others);
  add(out, "fetches_given_up_total", "counter", c.fetches_given_up);
  add(out, "tiles_not_saved_total", "counter", c.tiles_not_saved);
  add(out, "store_evictions_total", "counter", c.store_evictions);
  add(out, "pages_rendered_total", "counter", c.pages_rendered);
  add(out, "references_rendered_total", "counter", c.references_rendered);
  add(out, "views_rendered_total", "counter", c.views_rendered);
  add(out, "views_sent_total", "counter", c.views_sent);
  add(out, "gpu_scene_bytes", "gauge", c.gpu_scene_bytes);
  add(out, "gpu_target_bytes", "gauge", c.gpu_target_bytes);
  add(out, "gpu_most_bytes", "gauge", c.gpu_most_bytes);
  add(out, "shader_programs", "gauge", c.shader_programs);
  add(out, "shader_programs_after_ready_total", "counter", c.shader_programs_after_ready);
  add(out, "meshes_sent_total", "counter", c.meshes_sent);
  add(out, "images_sent_total", "counter", c.images_sent);
  add(out, "bytes_sent_total", "counter", c.bytes_sent);
  add(out, "bytes_received_total", "counter", c.bytes_received);
  add(out, "clients_closed_for_error_total", "counter", c.clients_closed_for_error);
  return out;
}

}  // namespace mirage
