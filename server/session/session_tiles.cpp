// Sessions: tiles, from the ask to the reply.
#include <algorithm>

#include "protocol/impostor/sun_frame.h"
#include "protocol/impostor/tile_key.h"
#include "server/prepare/prepared_scene.h"
#include "server/session/session.h"
#include "server/tile/tile_identity.h"

namespace mirage {
namespace {
constexpr double kNewTileShare = 1.0 / 16;  // weight of a new tile in the mean time of tiles
}  // namespace

bool SessionHub::can_be(std::uint8_t channels, const ObjectDescription& object,
                        const Lighting& lighting) const {
  switch (channels) {
    case kRelitTile:
      return can_relight(object.needs);
    case kLayeredTile:
      return layered(object.needs) && !object.group;
    case kShadowTile:
      return options_.shadows && (object.needs & kNeedLighting) && sun_of(lighting);
    case kCasterTile:
      return options_.shadows && object.casts();
    default:
      return true;
  }
}

void SessionHub::ask(SessionId id, const wire::Ask& a, const Lighting& lighting, TileCodec codec) {
  if (a.object() >= scene_->object_count() || a.instance() >= scene_->instance_count() ||
      scene_->instance(a.instance()).object != a.object()) {
    return refuse(id, a.request_id(), wire::RefusalReason::UnknownObject);
  }
  TileKey key;
  key.scene_revision = revision_;
  key.object = a.object();
  key.cell = {a.view_level(), a.view_x(), a.view_y()};
  key.distance = {a.distance_level(), a.distance_index()};
  key.size_class = a.size_class();
  key.channels = a.channels();
  key.phase = a.phase();
  const std::shared_ptr<const ObjectDescription> described = scene_->description(a.object());
  const ObjectDescription& object = *described;
  if (!valid(key.cell) || !valid(key.distance) || key.size_class > limits::kMaxSizeClass ||
      !valid_channels(key.channels) || object.radius <= 0 ||
      !valid_phase(a.phase(), object.motion.moving())) {
    return refuse(id, a.request_id(), wire::RefusalReason::BadKey);
  }
  const bool shadow = key.channels == kShadowTile;
  if (!can_be(key.channels, object, lighting)) {
    return refuse(id, a.request_id(), wire::RefusalReason::BadKey);
  }
  ObjectLighting light;
  if (shadow) {
    key.instance = a.instance() + 1;
    key.lighting = lighting_hash(lighting);
  } else if ((object.needs & kNeedLighting) && is_lit(key.channels)) {
    light = object_lighting(lighting, scene_->instance(a.instance()).world_from_object,
                            object.center, object.radius);
    key.lighting = light.hash();
  }
  const Lighting world = shadow ? lighting : Lighting{};
  TileAsk asked{key, tile_identity(key, light, world), light, world, {}};
  const bool colors = key.channels & kChannelColor;
  asked.waiter = {id, a.request_id(), a.error_px(), 0};
  asked.waiter.codec = colors || !is_lossy(codec) ? codec : TileCodec::kZstd;
  asked.waiter.asked_us = clock_.now_us();
  if (a.deadline_ms() > 0) {
    asked.waiter.deadline_us = asked.waiter.asked_us + a.deadline_ms() * 1000ll;
  }
  if (answer_from_memory(asked)) return;
  if (draining_) return refuse(id, a.request_id(), wire::RefusalReason::Busy);
  if (store_.has_sources() && fetches_.wait(asked)) return;
  have_rendered(asked);
}

bool SessionHub::answer_from_memory(const TileAsk& asked) {
  if (const StoredTilePtr form = store_.find(asked.id, asked.waiter.codec)) {
    push_tile(asked.waiter, *form);
    return true;
  }
  const StoredTilePtr other = store_.find_lossless(asked.id);
  if (other) convert(asked.waiter, asked.id, other);
  return other != nullptr;
}

void SessionHub::have_rendered(const TileAsk& asked) {
  // An ask that would be late is refused now, so the client may ask for something else.
  const std::int64_t deadline_us = asked.waiter.deadline_us;
  const double left_us = static_cast<double>(deadline_us - clock_.now_us());
  if (deadline_us != 0 && queue_.wait_us(asked.waiter.session, tile_us_) > left_us) {
    ++counters_.tiles_late;
    const SessionId late = asked.waiter.session;
    return refuse(late, asked.waiter.request_id, wire::RefusalReason::Busy);
  }
  const auto admission =
      queue_.submit(asked.key, asked.id, asked.lighting, asked.waiter, asked.world);
  if (admission != TileQueue::Admission::kBusy) return;
  const SessionId id = asked.waiter.session;
  refuse(id, asked.waiter.request_id, wire::RefusalReason::Busy);
}

void SessionHub::finish(FinishedFetch done) {
  for (const TileAsk& asked : fetches_.take(done.id, done.codec)) {
    const FetchedTile& found = done.found;
    if (found.form || found.lossless) ++counters_.store_hits;
    if (found.form) {
      push_tile(asked.waiter, *found.form);
    } else if (found.lossless) {
      convert(asked.waiter, asked.id, found.lossless);
    } else if (!answer_from_memory(asked)) {
      have_rendered(asked);
    }
  }
}

void SessionHub::finish(PendingFetch done) {
  ++counters_.tiles_left_to_others;
  fetches_.be_patient(done.id, done.codec);
}

void SessionHub::give_up_fetches() {
  for (const TileAsk& asked : fetches_.take_overdue()) {
    ++counters_.fetches_given_up;
    if (!answer_from_memory(asked)) have_rendered(asked);
  }
}

void SessionHub::push_tile(const Waiter& waiter, const StoredTile& tile) {
  if (waiter.session == kGetters) return got(waiter, tile);
  const auto at = sessions_.find(waiter.session);
  if (at == sessions_.end()) return;
  if (at->second.outbox.full()) {
    return refuse(waiter.session, waiter.request_id, wire::RefusalReason::Busy);
  }
  wire::TileReplyT reply = tile.reply;
  reply.request_id = waiter.request_id;
  reply.server_us = static_cast<std::uint32_t>(clock_.now_us() - waiter.asked_us);
  counters_.whole_times.add(reply.server_us);
  push(waiter.session, Outbox::Lane::kTiles, encode_message(std::move(reply), tile.planes));
}

void SessionHub::convert(const Waiter& waiter, const TileId& id, const StoredTilePtr& lossless) {
  if (forms_.wait(id, lossless, waiter)) return;
  const auto at = sessions_.find(waiter.session);
  if (at == sessions_.end()) {
    if (waits_still(waiter.session)) {
      refuse(waiter.session, waiter.request_id, wire::RefusalReason::Busy);
    }
    return;
  }
  const std::vector<TileCodec>& taken = at->second.codecs;
  const auto codec = static_cast<TileCodec>(lossless->reply.codec);
  if (std::find(taken.begin(), taken.end(), codec) != taken.end()) {
    return push_tile(waiter, *lossless);
  }
  refuse(waiter.session, waiter.request_id, wire::RefusalReason::Busy);
}

void SessionHub::finish(FinishedTile done) {
  for (const Waiter& w : forms_.take_waiting(done.id, done.codec)) push_tile(w, *done.tile);
  if (!done.lossless) return;
  counters_.queue_times.add(done.tile->reply.queue_us);
  counters_.render_times.add(done.tile->reply.render_us);
  counters_.encode_times.add(done.tile->reply.encode_us);
  const double took = static_cast<double>(done.tile->reply.render_us) + done.tile->reply.encode_us;
  tile_us_ += (took - tile_us_) * (tile_us_ > 0 ? kNewTileShare : 1);
  for (const Waiter& w : queue_.finish(done.id)) {
    if (w.codec == done.codec) {
      push_tile(w, *done.tile);
    } else {
      convert(w, done.id, done.lossless);
    }
  }
}

}  // namespace mirage
