#include "server/tile/tile_encode.h"

#include "protocol/impostor/capture.h"
#include "server/tile/tile_form.h"
#include "server/tile/tile_measure.h"

namespace mirage {

Tile cut_and_measure(const RenderedTile& rendered, const ObjectDescription& object) {
  const TileKey& key = rendered.job.key;
  const Capture capture(key.cell, key.distance, object.radius, tile_edge(key.size_class));
  const std::size_t offset = static_cast<std::size_t>(rendered.y) * rendered.page->width +
                             static_cast<std::size_t>(rendered.x);
  const std::vector<std::uint8_t>& surface = rendered.page->surface;
  const PageTexels page{&rendered.page->rgba[offset * 4], &rendered.page->depth[offset],
                        surface.empty() ? nullptr : &surface[offset * 4], rendered.page->width};
  Tile tile = cut_tile(page, key.channels, capture, object);
  // The members of a group have their own levels, each within the allowed error.
  tile.measure.lod_error = object.group ? static_cast<float>(allowed_tile_error(capture))
                                        : tile_lod_error(object.lods, capture);
  return tile;
}

wire::TileReplyT tile_fields(const RenderedTile& rendered) {
  wire::TileReplyT fields;
  fields.key_low = rendered.job.id.low;
  fields.key_high = rendered.job.id.high;
  fields.queue_us = rendered.queue_us;
  fields.render_us = rendered.render_us;
  return fields;
}

StoredTilePtr encode_tile(const RenderedTile& rendered, const ObjectDescription& object,
                          TileCodec codec) {
  return make_form(cut_and_measure(rendered, object), tile_fields(rendered), codec);
}

}  // namespace mirage
