#include "server/session/form_requests.h"

#include <algorithm>

namespace mirage {
namespace {
constexpr std::size_t kMaxWaiting = 65'536;
}  // namespace

bool FormRequests::wait(const TileId& id, const StoredTilePtr& lossless, const Waiter& waiter) {
  if (count_ >= kMaxWaiting) return false;
  std::vector<Waiter>& all = waiting_[id];
  const bool under_way = std::any_of(
      all.begin(), all.end(), [&](const Waiter& other) { return other.codec == waiter.codec; });
  EncodeJob job{nullptr, std::make_shared<FormJob>(FormJob{id, lossless, waiter.codec})};
  if (!under_way && !jobs_.try_push(job)) {
    if (all.empty()) waiting_.erase(id);
    return false;
  }
  all.push_back(waiter);
  ++count_;
  return true;
}

std::vector<Waiter> FormRequests::take_waiting(const TileId& id, TileCodec codec) {
  const auto found = waiting_.find(id);
  if (found == waiting_.end()) return {};
  std::vector<Waiter>& all = found->second;
  const auto others = std::stable_partition(
      all.begin(), all.end(), [codec](const Waiter& waiter) { return waiter.codec == codec; });
  std::vector<Waiter> out(all.begin(), others);
  all.erase(all.begin(), others);
  if (all.empty()) waiting_.erase(found);
  count_ -= out.size();
  return out;
}

}  // namespace mirage
