#include "server/stage/encode_stage.h"

#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <unistd.h>

#include <new>

#include "protocol/base/clock.h"
#include "protocol/impostor/tile_key.h"
#include "protocol/wire/view_codec.h"
#include "server/prepare/prepared_scene.h"
#include "server/tile/picture_encode.h"
#include "server/tile/reference_encode.h"
#include "server/tile/stage_queues.h"
#include "server/tile/tile_encode.h"
#include "server/tile/tile_form.h"
#include "server/tile/view_cut.h"

namespace mirage {
namespace {

constexpr int kGivesWay = 10;  // increase of the nice value

/// Lowers the priority of this thread: it runs when the others of the process leave a core free.
void give_way() { setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kGivesWay); }

}  // namespace

void EncodeStage::announce(Completion done) {
  queues_.completions.push(std::move(done));
  wake_();
}

// The lossless form is always kept, whatever codec was asked for: others are made from it.
void EncodeStage::finish(const RenderedTile& rendered, const ObjectDescription& object) {
  const SteadyClock clock;
  const TileJob& job = rendered.job;
  const Tile tile = cut_and_measure(rendered, object);
  wire::TileReplyT fields = tile_fields(rendered);
  fields.encode_us = static_cast<std::uint32_t>(clock.now_us());
  const StoredTilePtr lossless = make_form(tile, fields, lossless_codec(job.codec));
  const StoredTilePtr asked =
      is_lossy(job.codec) ? smaller_form(lossless, make_form(tile, fields, job.codec)) : lossless;
  queues_.store.put(job.id, lossless_codec(job.codec), lossless);
  if (is_lossy(job.codec)) queues_.store.put(job.id, job.codec, asked);
  announce(FinishedTile{job.id, job.codec, asked, lossless});
  save(job.id, lossless_codec(job.codec), lossless);
  if (is_lossy(job.codec)) save(job.id, job.codec, asked);
}

void EncodeStage::finish(const FormJob& job) {
  StoredTilePtr form = convert_form(job.lossless, job.codec);
  if (!form) form = job.lossless;
  queues_.store.put(job.id, job.codec, form);
  ++queues_.counters.forms_made;
  announce(FinishedTile{job.id, job.codec, form});
  if (is_lossy(job.codec)) save(job.id, job.codec, form);  // all lossless forms share one file
}

void EncodeStage::save(const TileId& id, TileCodec codec, StoredTilePtr tile) {
  if (!queues_.store.has_sources()) return;
  SaveJob job{id, codec, std::move(tile)};
  if (!queues_.saves.try_push(job)) ++queues_.counters.tiles_not_saved;
}

void EncodeStage::finish(const RenderedView& drawn) {
  ViewTile view = cut_view(drawn.camera, drawn.frame);
  view.time_s = drawn.time_s;
  announce(FinishedView{drawn.id, std::make_shared<const EncodedView>(encode_view(view))});
}

void EncodeStage::finish(RenderedReference& drawn) {
  if (drawn.picture) {
    Result<Bytes> file = encode_picture(drawn, *drawn.picture);
    if (!file) spdlog::warn("refused: {}", file.error().line());
    announce(FinishedPicture{drawn.picture->key,
                             file ? std::make_shared<const Bytes>(file.take()) : nullptr});
    return;
  }
  const SessionId session = drawn.session;
  announce(FinishedReference{session, encode_reference(std::move(drawn))});
}

void EncodeStage::work(EncodeJob& job, const PreparedScene& scene) {
  try {
    finish(job, scene);
  } catch (const std::bad_alloc&) {
    spdlog::warn("refused: there is no memory to encode something");
    refuse(job);
  }
}

void EncodeStage::refuse(const EncodeJob& job) {
  if (const auto* rendered = std::get_if<RenderedTile>(&job)) {
    announce(TooLargeTile{rendered->job.id});
  } else if (const auto* form = std::get_if<FormJob>(&job)) {
    announce(FinishedTile{form->id, form->codec, form->lossless});
  } else if (const auto* view = std::get_if<RenderedView>(&job)) {
    announce(FinishedView{view->id, nullptr});
  } else {
    const auto& full = std::get<RenderedReference>(job);
    if (full.picture) return announce(FinishedPicture{full.picture->key, nullptr});
    announce(refused_reference(full.session, full.request_id));
  }
}

void EncodeStage::finish(EncodeJob& job, const PreparedScene& scene) {
  if (const auto* rendered = std::get_if<RenderedTile>(&job)) {
    finish(*rendered, *scene.description(rendered->job.key.object));
  } else if (const auto* form = std::get_if<FormJob>(&job)) {
    finish(*form);
  } else if (const auto* view = std::get_if<RenderedView>(&job)) {
    finish(*view);
  } else {
    finish(std::get<RenderedReference>(job));
  }
}

void EncodeStage::start(std::shared_ptr<const PreparedScene> scene, int workers) {
  for (int i = 0; i < workers; ++i) {
    workers_.emplace_back([this, scene] {
      while (std::optional<EncodeJob> job = queues_.rendered.pop()) work(*job, *scene);
    });
  }
  workers_.emplace_back([this, scene] {
    give_way();
    while (std::optional<EncodeJob> job = queues_.slow.pop()) {
      queues_.tiles.look_again();  // there is room for the next slow job
      work(*job, *scene);
    }
  });
}

void EncodeStage::join() {
  for (std::thread& worker : workers_) {
    if (worker.joinable()) worker.join();
  }
}

}  // namespace mirage
