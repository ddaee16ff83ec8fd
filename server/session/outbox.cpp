#include "server/session/outbox.h"

#include <utility>

#include "protocol/wire/wire.h"

namespace mirage {

void Outbox::push(Lane lane, Bytes message) {
  Queue& queue = lanes_[index(lane)];
  for (Bytes& packet : split_into_packets(std::move(message), next_transfer_++)) {
    queue.bytes += packet.size();
    if (lane != Lane::kLarge) bytes_ += packet.size();
    queue.packets.push_back(std::make_shared<const Bytes>(std::move(packet)));
  }
}

PacketPtr Outbox::pop(Lane lane) {
  Queue& queue = lanes_[index(lane)];
  if (queue.packets.empty()) return nullptr;
  PacketPtr packet = std::move(queue.packets.front());
  queue.packets.pop_front();
  queue.bytes -= packet->size();
  if (lane != Lane::kLarge) bytes_ -= packet->size();
  return packet;
}

PacketPtr Outbox::next_tile_or_bulk() {
  const bool tiles = tiles_ready();
  const Lane bulk = lanes_[index(Lane::kBulk)].packets.empty() ? Lane::kLarge : Lane::kBulk;
  const bool both = tiles && !lanes_[index(bulk)].packets.empty();
  if (!both) tile_lead_bytes_ = 0;
  const bool tile_now = tiles && (!both || tile_lead_bytes_ <= 0);
  PacketPtr packet = pop(tile_now ? Lane::kTiles : bulk);
  if (!packet) return nullptr;
  const auto bytes = static_cast<std::int64_t>(packet->size());
  if (tile_now) tile_bytes_sent_ += packet->size();
  tile_lead_bytes_ += tile_now ? bytes : -bytes;
  return packet;
}

bool Outbox::ready() const {
  return control_waits() || tiles_ready() || large_waits() ||
         !lanes_[index(Lane::kBulk)].packets.empty();
}

}  // namespace mirage
