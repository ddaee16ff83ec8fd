#pragma once
// Messages that wait to be written to one client: small answers, tiles by credit, images, and one
// large reply at a time.
// Input:  whole messages
// Output: packets in the order of sending
// Thread: the network loop's
// Full:   full() is true, and the session refuses asks; large replies are made when their turn
//         comes

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>

#include "protocol/base/bytes.h"

namespace mirage {

using PacketPtr = std::shared_ptr<const Bytes>;

class Outbox {
 public:
  enum class Lane : std::uint8_t { kControl, kTiles, kBulk, kLarge };

  /// `most_bytes`: limit of bytes waiting, without large replies, above which the client counts as
  /// full.
  explicit Outbox(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  void push(Lane lane, Bytes message);
  /// Raises the client's credit: the total bytes of tiles that may be sent.
  void allow(std::uint64_t credit_bytes) { credit_bytes_ = std::max(credit_bytes_, credit_bytes); }

  /// Returns the next answer, which precedes everything else; nullptr: none.
  PacketPtr next_control() { return pop(Lane::kControl); }
  /// Returns the next packet of tiles or bulk, which share the link in equal parts; nullptr: none
  /// may be sent.
  PacketPtr next_tile_or_bulk();

  /// Bytes waiting, large replies included.
  std::size_t bytes() const { return bytes_ + bytes_of(Lane::kLarge); }
  bool full() const { return bytes_ >= most_bytes_; }
  /// True if the client does not even read refusals.
  bool hopeless() const { return bytes_of(Lane::kControl) > most_bytes_; }
  bool large_waits() const { return !lanes_[index(Lane::kLarge)].packets.empty(); }
  bool control_waits() const { return !lanes_[index(Lane::kControl)].packets.empty(); }
  /// True if a packet may be sent now.
  bool ready() const;

 private:
  struct Queue {
    std::list<PacketPtr> packets;  ///< a list, because an empty deque takes 0.5 KiB
    std::size_t bytes = 0;
  };
  static std::size_t index(Lane lane) { return static_cast<std::size_t>(lane); }
  std::size_t bytes_of(Lane lane) const { return lanes_[index(lane)].bytes; }
  bool tiles_ready() const {
    return !lanes_[index(Lane::kTiles)].packets.empty() && tile_bytes_sent_ < credit_bytes_;
  }
  PacketPtr pop(Lane lane);

  const std::size_t most_bytes_;
  std::array<Queue, 4> lanes_;
  std::size_t bytes_ = 0;             ///< bytes in all lanes except kLarge
  std::int64_t tile_lead_bytes_ = 0;  ///< tile bytes sent ahead of bulk while both waited
  std::uint64_t tile_bytes_sent_ = 0;
  std::uint64_t credit_bytes_ = 0;
  std::uint32_t next_transfer_ = 1;
};

}  // namespace mirage
