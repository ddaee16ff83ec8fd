#pragma once
// Network model: how long the network delays a message.

#include <cstdint>
#include <string>

#include "protocol/base/result.h"

namespace mirage {

struct NetModel {
  double rtt_ms = 0;
  double jitter_ms = 0;     ///< standard deviation of the one-way delay; messages stay in order
  double rate_mbps = 0;     ///< both ways; 0: unlimited
  double loss_percent = 0;  ///< share of messages lost; each is sent again, 1.5 round trips later
  double server_ms = -1;    ///< time of a tile; negative: the time the server really took (auto)
  std::uint64_t seed = 1;
};
/// Parses "rtt=100,jitter=20,rate=20,loss=0.5,server-ms=auto|X,seed=1". Error kUsage names the bad
/// part.
Result<NetModel> parse_net_model(const std::string& text);

/// Draws the delays of a model, one after the other; equal seeds give equal delays.
class NetDelays {
 public:
  explicit NetDelays(const NetModel& model);
  /// Continues the random sequence with another model.
  void change(const NetModel& model) { model_ = model; }
  /// Returns the delay of the next message without its transmission: half a round trip, jitter,
  /// retransmissions.
  std::int64_t one_way_us();
  /// Returns how long `bytes` occupy the link; 0 if its rate is unlimited.
  std::int64_t transmission_us(std::size_t bytes) const;

 private:
  double uniform();

  NetModel model_;
  std::uint64_t random_;
};

}  // namespace mirage
