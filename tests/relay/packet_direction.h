#pragma once
// Packet direction: one direction of a link that carries packets. Each packet is transmitted after
// the former ones and delayed; some are lost or overtaken.
// Input:  packets, and the time.
// Output: packets that have arrived.
// Thread: any one; the time comes with every call.
// Full:   packets that do not fit into its buffer are dropped.

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <random>
#include <string>

namespace mirage {

struct PacketShape {
  double delay_ms = 0;         ///< one way
  double rate_mbps = 0;        ///< 0: any
  double loss_percent = 0;     ///< of packets
  double reorder_percent = 0;  ///< of packets: these arrive kLateMs late
  double buffer_ms = 100;      ///< what may wait to be transmitted, in ms at the rate
  std::uint32_t seed = 1;
};

class PacketDirection {
 public:
  explicit PacketDirection(const PacketShape& shape) : shape_(shape), random_(shape.seed) {}

  struct Counts {
    std::uint64_t packets = 0, lost = 0, dropped = 0, late = 0;
  };

  void put(std::string packet, std::int64_t now_us);
  /// Returns the next packet that has arrived by now.
  std::optional<std::string> take(std::int64_t now_us);
  /// Returns the time of the next arrival; INT64_MAX: nothing is under way.
  std::int64_t next_us() const {
    return under_way_.empty() ? INT64_MAX : under_way_.begin()->first;
  }
  const Counts& counts() const { return counts_; }

 private:
  bool chance(double percent);

  const PacketShape shape_;
  std::mt19937 random_;
  std::multimap<std::int64_t, std::string> under_way_;  ///< by time of arrival
  /// Time when everything given so far is transmitted.
  std::int64_t free_us_ = 0;
  Counts counts_;
};

}  // namespace mirage
