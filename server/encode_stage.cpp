#include "server/encode_stage.h"

#include "protocol/capture.h"
#include "protocol/clock.h"
#include "server/tile_form.h"
#include "server/tile_measure.h"
#include "server/view_cut.h"

namespace mirage {

namespace {

Tile cut_and_measure(const RenderedTile& rendered, const ObjectDescription& object) {
  const TileKey& key = rendered.job.key;
  const Capture capture(key.cell, key.distance, object.radius, tile_edge(key.size_class));
  const std::size_t offset = static_cast<std::size_t>(rendered.y) * rendered.page->width +
                             static_cast<std::size_t>(rendered.x);
  const std::vector<std::uint8_t>& surface = rendered.page->surface;
  const PageTexels page{&rendered.page->rgba[offset * 4], &rendered.page->depth[offset],
                        surface.empty() ? nullptr : &surface[offset * 4], rendered.page->width};
  Tile tile = cut_tile(page, key.channels, capture, object);
  // The members of a group have levels of their own, each within what is allowed.
  tile.measure.lod_error = object.group ? static_cast<float>(allowed_tile_error(capture))
                                        : tile_lod_error(object.lods, capture);
  return tile;
}

wire::TileReplyT fields_of(const RenderedTile& rendered) {
  wire::TileReplyT fields;
  fields.key_low = rendered.job.id.low;
  fields.key_high = rendered.job.id.high;
  fields.queue_us = rendered.queue_us;
  fields.render_us = rendered.render_us;
  return fields;
}

}  // namespace

StoredTilePtr EncodeStage::encode(const RenderedTile& rendered, const ObjectDescription& object,
                                  TileCodec codec) {
  return make_form(cut_and_measure(rendered, object), fields_of(rendered), codec);
}

void EncodeStage::announce(Completion done) {
  queues_.completions.push(std::move(done));
  wake_();
}

// The form without loss is kept whatever was asked for: others are made from it.
void EncodeStage::finish(const RenderedTile& rendered, const ObjectDescription& object) {
  const SteadyClock clock;
  const TileJob& job = rendered.job;
  const Tile tile = cut_and_measure(rendered, object);
  wire::TileReplyT fields = fields_of(rendered);
  fields.encode_us = static_cast<std::uint32_t>(clock.now_us());
  Completion done;
  done.id = job.id;
  done.codec = job.codec;
  done.lossless = done.tile = make_form(tile, fields, lossless_codec(job.codec));
  if (is_lossy(job.codec)) {
    done.tile = smaller_form(done.lossless, make_form(tile, fields, job.codec));
  }
  const StoredTilePtr lossless = done.lossless, asked = done.tile;
  queues_.store.put(job.id, lossless_codec(job.codec), lossless);
  if (is_lossy(job.codec)) queues_.store.put(job.id, job.codec, asked);
  announce(std::move(done));
  save(job.id, lossless_codec(job.codec), lossless);
  if (is_lossy(job.codec)) save(job.id, job.codec, asked);
}

void EncodeStage::finish(const FormJob& job) {
  Completion done;
  done.id = job.id;
  done.codec = job.codec;
  done.tile = convert_form(job.lossless, job.codec);
  if (!done.tile) done.tile = job.lossless;
  const StoredTilePtr form = done.tile;
  queues_.store.put(job.id, job.codec, form);
  ++queues_.counters.forms_made;
  announce(std::move(done));
  if (is_lossy(job.codec)) save(job.id, job.codec, form);  // the others share a file
}

void EncodeStage::save(const TileId& id, TileCodec codec, StoredTilePtr tile) {
  if (!queues_.store.has_directory()) return;
  SaveJob job{id, codec, std::move(tile)};
  if (!queues_.saves.try_push(job)) ++queues_.counters.tiles_not_saved;
}

void EncodeStage::finish(const RenderedView& drawn) {
  Completion done;
  done.view = drawn.id;
  done.encoded_view =
      std::make_shared<const EncodedView>(encode_view(cut_view(drawn.camera, drawn.frame)));
  announce(std::move(done));
}

void EncodeStage::start(std::shared_ptr<const PreparedScene> scene, int workers) {
  for (int i = 0; i < workers; ++i) {
    workers_.emplace_back([this, scene] {
      while (const std::optional<EncodeJob> job = queues_.rendered.pop()) {
        if (job->rendered) {
          finish(*job->rendered, *scene->description(job->rendered->job.key.object));
        } else if (job->form) {
          finish(*job->form);
        } else {
          finish(*job->view);
        }
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
