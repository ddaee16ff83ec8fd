#include "server/stage/encode_stage.h"

#include "protocol/clock.h"
#include "server/tile/tile_encode.h"
#include "server/tile/tile_form.h"
#include "server/tile/view_cut.h"

namespace mirage {

void EncodeStage::announce(Completion done) {
  queues_.completions.push(std::move(done));
  wake_();
}

// The form without loss is kept whatever was asked for: others are made from it.
void EncodeStage::finish(const RenderedTile& rendered, const ObjectDescription& object) {
  const SteadyClock clock;
  const TileJob& job = rendered.job;
  const Tile tile = cut_and_measure(rendered, object);
  wire::TileReplyT fields = tile_fields(rendered);
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
