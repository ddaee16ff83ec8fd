#include "tests/relay/packet_direction.h"

#include <algorithm>
#include <cmath>

namespace mirage {
namespace {
constexpr double kLateMs = 5;  // several packets, at the rates of the tests
}

bool PacketDirection::chance(double percent) {
  return std::uniform_real_distribution<double>(0, 100)(random_) < percent;
}

void PacketDirection::put(std::string packet, std::int64_t now_us) {
  ++counts_.packets;
  const double waits_us = static_cast<double>(free_us_ - now_us);
  if (shape_.rate_mbps > 0 && waits_us > shape_.buffer_ms * 1e3) {
    ++counts_.dropped;
    return;
  }
  const double bits = static_cast<double>(packet.size()) * 8;
  const double takes_us = shape_.rate_mbps > 0 ? bits / shape_.rate_mbps : 0;
  free_us_ = std::max(free_us_, now_us) + std::llround(takes_us);
  if (chance(shape_.loss_percent)) {
    ++counts_.lost;
    return;
  }
  const bool late = chance(shape_.reorder_percent);
  counts_.late += late ? 1 : 0;
  const double delay_ms = shape_.delay_ms + (late ? kLateMs : 0);
  under_way_.emplace(free_us_ + std::llround(delay_ms * 1e3), std::move(packet));
}

std::optional<std::string> PacketDirection::take(std::int64_t now_us) {
  if (next_us() > now_us) return std::nullopt;
  std::string packet = std::move(under_way_.begin()->second);
  under_way_.erase(under_way_.begin());
  return packet;
}

}  // namespace mirage
