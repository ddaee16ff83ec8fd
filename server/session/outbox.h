#pragma once
// What waits to be written to one client: small answers, tiles by credit, images, and one large
// reply at a time.
// Input:  whole messages. Output: WebSocket messages in the order in which they are sent.
// Thread: the network loop's.
// Full:   full() says so; who asks is then refused. Large replies are made as their turn comes.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>

#include "protocol/base/bytes.h"

namespace mirage {

using FramePtr = std::shared_ptr<const Bytes>;

class Outbox {
 public:
  enum class Lane : std::uint8_t { kControl, kTiles, kBulk, kLarge };

  /// `most_bytes` of what is answered at once, before the client counts as full.
  explicit Outbox(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  void push(Lane lane, Bytes message);
  /// Tiles of so many bytes may be sent in all, by what the client has told.
  void allow(std::uint64_t credit_bytes) { credit_bytes_ = std::max(credit_bytes_, credit_bytes); }

  /// An answer, before anything else; nullptr: none.
  FramePtr next_control() { return pop(Lane::kControl); }
  /// Tiles and what is large share the link in equal parts; nullptr: nothing may be sent.
  FramePtr next_tile_or_bulk();

  /// Waiting.
  std::size_t bytes() const { return bytes_ + bytes_of(Lane::kLarge); }
  bool full() const { return bytes_ >= most_bytes_; }
  /// Even the refusals are not read any more.
  bool hopeless() const { return bytes_of(Lane::kControl) > most_bytes_; }
  bool large_waits() const { return !lanes_[index(Lane::kLarge)].frames.empty(); }
  bool control_waits() const { return !lanes_[index(Lane::kControl)].frames.empty(); }
  /// Something may be sent now.
  bool ready() const;

 private:
  struct Queue {
    std::list<FramePtr> frames;  ///< a deque of none takes half a KiB
    std::size_t bytes = 0;
  };
  static std::size_t index(Lane lane) { return static_cast<std::size_t>(lane); }
  std::size_t bytes_of(Lane lane) const { return lanes_[index(lane)].bytes; }
  bool tiles_ready() const {
    return !lanes_[index(Lane::kTiles)].frames.empty() && tile_bytes_sent_ < credit_bytes_;
  }
  FramePtr pop(Lane lane);

  const std::size_t most_bytes_;
  std::array<Queue, 4> lanes_;
  std::size_t bytes_ = 0;             ///< of all lanes but what is large
  std::int64_t tile_lead_bytes_ = 0;  ///< tiles sent ahead of bulk while both waited
  std::uint64_t tile_bytes_sent_ = 0;
  std::uint64_t credit_bytes_ = 0;
  std::uint32_t next_transfer_ = 1;
};

}  // namespace mirage
