#include "server/session/form_requests.h"

#include "protocol/base/limits.h"
#include "protocol/codec/tile_codec.h"

namespace mirage {
namespace {
constexpr std::size_t kMaxWaiting = 65'536;
}  // namespace

bool FormRequests::wait(const TileId& id, const StoredTilePtr& lossless, const Waiter& waiter) {
  if (waiting_.size() >= kMaxWaiting) return false;
  if (asks_of(waiter.session) >= limits::kMaxQueuedAsksPerClient) return false;
  const FormId form{id, waiter.codec};
  if (!waiting_.under_way(form)) {
    EncodeJob job = FormJob{id, lossless, waiter.codec};
    if (!jobs_.try_push(job)) return false;
  }
  waiting_.add(form, waiter);
  ++asks_[waiter.session];
  return true;
}

std::vector<Waiter> FormRequests::take_waiting(const TileId& id, TileCodec codec) {
  std::vector<Waiter> out = waiting_.take({id, codec});
  for (const Waiter& w : out) {
    const auto asks = asks_.find(w.session);
    if (--asks->second == 0) asks_.erase(asks);
  }
  return out;
}

void FormRequests::remove_session(SessionId session) {
  if (asks_.erase(session) == 0) return;
  // A form under way is still made and kept for later asks.
  waiting_.remove([&](const Waiter& waiter) { return waiter.session == session; },
                  [](const FormId&) { return false; });
}

std::size_t FormRequests::asks_of(SessionId session) const {
  const auto asks = asks_.find(session);
  return asks == asks_.end() ? 0 : asks->second;
}

}  // namespace mirage
