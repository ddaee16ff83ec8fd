#pragma once
// The network as a model: what a message is delayed by.

#include <cstdint>
#include <string>

#include "protocol/base/result.h"

namespace mirage {

struct NetModel {
  double rtt_ms = 0;
  double jitter_ms = 0;     ///< standard deviation of the one-way delay, in order delivery kept
  double rate_mbps = 0;     ///< both ways; 0: unlimited
  double loss_percent = 0;  ///< of messages; a lost one comes a retransmission (1.5 RTT) later
  double server_ms = -1;    ///< per tile; negative: as the server really took (auto)
  std::uint64_t seed = 1;
};
/// "rtt=100,jitter=20,rate=20,loss=0.5,server-ms=auto|X,seed=1"; error kUsage names the bad part.
Result<NetModel> parse_net_model(const std::string& text);

/// A model's delays, one after the other; the same for the same seed.
class NetDelays {
 public:
  explicit NetDelays(const NetModel& model);
  /// Those of another model from now on, in the same sequence of chances.
  void change(const NetModel& model) { model_ = model; }
  /// Of the next message, without its transmission: half a round trip, jitter, retransmissions.
  std::int64_t one_way_us();
  /// How long `bytes` occupy the link; 0 when it is unlimited.
  std::int64_t transmission_us(std::size_t bytes) const;

 private:
  double uniform();

  NetModel model_;
  std::uint64_t random_;
};

}  // namespace mirage
