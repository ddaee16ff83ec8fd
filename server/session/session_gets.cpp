// Sessions: single tiles by HTTP. To the tile queue, all HTTP requests together are one client.
#include "protocol/wire/tile_address.h"
#include "server/prepare/prepared_scene.h"
#include "server/session/session.h"

namespace mirage {
namespace {
// A cache in front of the server asks again after this time.
constexpr std::uint32_t kDeadlineMs = 5'000;
}  // namespace

std::uint32_t SessionHub::get(const TileAddress& address) {
  const std::uint32_t request = next_get_++;
  if (address.instance >= scene_->instance_count()) {
    refuse(kGetters, request, wire::RefusalReason::UnknownObject);
    return request;
  }
  const std::vector<TileCodec>& codecs = options_.codecs;
  if (std::find(codecs.begin(), codecs.end(), address.codec) == codecs.end()) {
    refuse(kGetters, request, wire::RefusalReason::BadKey);
    return request;
  }
  ++counters_.tiles_asked;
  const wire::Ask asked(request, address.instance, scene_->instance(address.instance).object, 0,
                        kDeadlineMs, address.distance.index, address.cell.x, address.cell.y,
                        address.cell.level, address.distance.level, address.size_class,
                        address.channels, address.phase);
  ask(kGetters, asked, scene_->scene.lighting, address.codec);
  return request;
}

void SessionHub::cancel_get(std::uint32_t request) {
  pictures_.cancel(request);
  if (!fetches_.cancel(kGetters, request)) queue_.cancel(kGetters, request);
}

std::vector<GotTile> SessionHub::take_got() { return std::exchange(got_, {}); }

// Request id and times are cleared, so that equal tiles give equal bytes from any server.
void SessionHub::got(const Waiter& waiter, const StoredTile& tile) {
  wire::TileReplyT reply = tile.reply;
  reply.request_id = reply.server_us = 0;
  reply.queue_us = reply.render_us = reply.encode_us = 0;
  const std::uint64_t hash = reply.content_hash;
  got_.push_back({waiter.request_id, encode_message(std::move(reply), tile.planes), hash});
}

}  // namespace mirage
