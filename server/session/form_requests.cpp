#include "server/session/form_requests.h"

namespace mirage {
namespace {
constexpr std::size_t kMaxWaiting = 65'536;
}  // namespace

bool FormRequests::wait(const TileId& id, const StoredTilePtr& lossless, const Waiter& waiter) {
  if (waiting_.size() >= kMaxWaiting) return false;
  const FormId form{id, waiter.codec};
  if (!waiting_.under_way(form)) {
    EncodeJob job = FormJob{id, lossless, waiter.codec};
    if (!jobs_.try_push(job)) return false;
  }
  waiting_.add(form, waiter);
  return true;
}

}  // namespace mirage
