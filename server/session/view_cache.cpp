#include "server/session/view_cache.h"

namespace mirage {
namespace {
// Most views under way. A view takes as long as twenty tiles.
constexpr std::size_t kMostWaiting = 16;
}  // namespace

std::shared_ptr<const EncodedView> ViewCache::find(const TileId& id) const {
  const auto at = made_.find(id);
  return at == made_.end() ? nullptr : at->second;
}

bool ViewCache::wait(ViewJob job, Waiting waiting) {
  const bool again =
      making_.any([&](const Waiting& other) { return other.session == waiting.session; });
  if (again) return false;
  waiting.kept = making_.under_way(job.id);
  if (!waiting.kept && making_.under_way() >= kMostWaiting) return false;
  making_.add(job.id, waiting);
  if (waiting.kept) {
    queue_.want_view(job.id);
  } else {
    queue_.submit(std::move(job));
  }
  return true;
}

void ViewCache::keep_ready(ViewJob job) {
  home_ = job.id;
  job.wanted = false;
  if (making_.begin(job.id)) queue_.submit(std::move(job));
}

std::vector<ViewCache::Waiting> ViewCache::finish(const TileId& id,
                                                  std::shared_ptr<const EncodedView> view) {
  if (view) {
    if (!home_ || !(id == *home_)) budget_.add(id, view->payload.size());
    made_[id] = std::move(view);
    while (const std::optional<TileId> oldest = budget_.take_excess()) made_.erase(*oldest);
  }
  return making_.take(id);
}

std::size_t ViewCache::asks_of(SessionId session) const {
  return making_.count([&](const Waiting& waiting) { return waiting.session == session; });
}

void ViewCache::remove_session(SessionId session) {
  // Clients that come, ask and go must not leave work behind.
  making_.remove(
      [&](const Waiting& waiting) { return waiting.session == session; },
      [&](const TileId& id) { return !(home_ && id == *home_) && queue_.drop_view(id); });
}

}  // namespace mirage
