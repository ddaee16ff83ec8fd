#include "server/session/view_cache.h"

#include <algorithm>

namespace mirage {
namespace {
constexpr std::size_t kMost = 128;  // some 100 KB each
}  // namespace

std::shared_ptr<const EncodedView> ViewCache::find(const TileId& id) const {
  const auto at = made_.find(id);
  return at == made_.end() ? nullptr : at->second;
}

bool ViewCache::wait(ViewJob job, Waiting waiting) {
  for (const auto& [id, all] : making_) {
    const bool again = std::any_of(all.begin(), all.end(),
                                   [&](const Waiting& w) { return w.session == waiting.session; });
    if (again) return false;
  }
  const auto [at, is_new] = making_.try_emplace(job.id);
  waiting.kept = !is_new;
  at->second.push_back(waiting);
  if (is_new) {
    queue_.submit(std::move(job));
  } else {
    queue_.want_view(job.id);
  }
  return true;
}

void ViewCache::keep_ready(ViewJob job) {
  home_ = job.id;
  job.wanted = false;
  if (making_.try_emplace(job.id).second) queue_.submit(std::move(job));
}

std::vector<ViewCache::Waiting> ViewCache::finish(const TileId& id,
                                                  std::shared_ptr<const EncodedView> view) {
  auto node = making_.extract(id);
  if (view) {
    made_[id] = std::move(view);
    if (!home_ || !(id == *home_)) order_.push_back(id);
    if (order_.size() > kMost) {
      made_.erase(order_.front());
      order_.pop_front();
    }
  }
  return node.empty() ? std::vector<Waiting>{} : std::move(node.mapped());
}

void ViewCache::remove_session(SessionId session) {
  for (auto at = making_.begin(); at != making_.end();) {
    auto& [id, all] = *at;
    const auto left = std::remove_if(all.begin(), all.end(),
                                     [&](const Waiting& w) { return w.session == session; });
    const bool waited = left != all.end();
    all.erase(left, all.end());
    // Who comes, asks and goes must not leave work behind.
    const bool unwanted = waited && all.empty() && !(home_ && id == *home_);
    at = unwanted && queue_.drop_view(id) ? making_.erase(at) : std::next(at);
  }
}

}  // namespace mirage
