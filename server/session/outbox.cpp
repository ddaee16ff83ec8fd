#include "server/session/outbox.h"

#include <utility>

#include "protocol/wire/wire.h"

namespace mirage {

void Outbox::push(Lane lane, Bytes message) {
  Queue& queue = lanes_[index(lane)];
  for (Bytes& frame : split_into_frames(std::move(message), next_transfer_++)) {
    queue.bytes += frame.size();
    if (lane != Lane::kLarge) bytes_ += frame.size();
    queue.frames.push_back(std::make_shared<const Bytes>(std::move(frame)));
  }
}

FramePtr Outbox::pop(Lane lane) {
  Queue& queue = lanes_[index(lane)];
  if (queue.frames.empty()) return nullptr;
  FramePtr frame = std::move(queue.frames.front());
  queue.frames.pop_front();
  queue.bytes -= frame->size();
  if (lane != Lane::kLarge) bytes_ -= frame->size();
  return frame;
}

FramePtr Outbox::next_tile_or_bulk() {
  const bool tiles = tiles_ready();
  const Lane bulk = lanes_[index(Lane::kBulk)].frames.empty() ? Lane::kLarge : Lane::kBulk;
  const bool both = tiles && !lanes_[index(bulk)].frames.empty();
  if (!both) tile_lead_bytes_ = 0;
  const bool tile_now = tiles && (!both || tile_lead_bytes_ <= 0);
  FramePtr frame = pop(tile_now ? Lane::kTiles : bulk);
  if (!frame) return nullptr;
  const auto bytes = static_cast<std::int64_t>(frame->size());
  if (tile_now) tile_bytes_sent_ += frame->size();
  tile_lead_bytes_ += tile_now ? bytes : -bytes;
  return frame;
}

bool Outbox::ready() const {
  return control_waits() || tiles_ready() || large_waits() ||
         !lanes_[index(Lane::kBulk)].frames.empty();
}

}  // namespace mirage
