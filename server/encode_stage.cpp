#include "server/encode_stage.h"

#include <chrono>

#include "protocol/capture.h"
#include "server/tile_measure.h"

namespace mirage {

StoredTilePtr EncodeStage::encode(const RenderedTile& rendered, const ObjectDescription& object,
                                  TileCodec codec) {
  const auto start = std::chrono::steady_clock::now();
  const TileKey& key = rendered.job.key;
  const Capture capture(key.cell, key.distance, object.radius, tile_edge(key.size_class));
  const std::size_t offset = static_cast<std::size_t>(rendered.y) * rendered.page->width +
                             static_cast<std::size_t>(rendered.x);
  const bool relit = key.channels == kRelitTile;
  const PageTexels page{&rendered.page->rgba[offset * 4], &rendered.page->depth[offset],
                        relit ? &rendered.page->surface[offset * 4] : nullptr,
                        rendered.page->width};
  Tile tile = cut_tile(page, key.channels, capture, object);
  // The members of a group have levels of their own, each within what is allowed.
  tile.measure.lod_error = object.group ? static_cast<float>(allowed_tile_error(capture))
                                        : tile_lod_error(object.lods, capture);
  auto stored = std::make_shared<StoredTile>();
  stored->planes = encode_tile_planes(tile, codec);
  set_tile_fields(tile, stored->reply);
  stored->reply.key_low = rendered.job.id.low;
  stored->reply.key_high = rendered.job.id.high;
  stored->reply.content_hash = tile_content_hash(tile);
  stored->reply.codec = static_cast<std::uint8_t>(codec);
  stored->reply.queue_us = rendered.queue_us;
  stored->reply.render_us = rendered.render_us;
  stored->reply.encode_us =
      static_cast<std::uint32_t>(std::chrono::duration_cast<std::chrono::microseconds>(
                                     std::chrono::steady_clock::now() - start)
                                     .count());
  return stored;
}

void EncodeStage::start(std::shared_ptr<const PreparedScene> scene, int workers, TileCodec codec) {
  for (int i = 0; i < workers; ++i) {
    workers_.emplace_back([this, scene, codec] {
      while (std::optional<RenderedTile> rendered = input_.pop()) {
        const TileId id = rendered->job.id;
        const auto object = scene->description(rendered->job.key.object);
        StoredTilePtr tile = encode(*rendered, *object, codec);
        store_.put(id, tile);
        completions_.push(Completion{id, tile, std::nullopt, 0, {}});
        wake_();
        store_.save(id, *tile);  // last: nobody waits for it
      }
    });
  }
}

void EncodeStage::join() {
  for (std::thread& worker : workers_) {
    if (worker.joinable()) worker.join();
  }
}

}  // namespace mirage
