#include "server/tile/tile_queue.h"

#include <algorithm>
#include <utility>

#include "protocol/base/limits.h"

namespace mirage {
namespace {

// Work of a tile in texels: its own, plus a constant for any tile. Triangles are unknown here; an
// object that is drawn often costs about the same triangles in every tile.
constexpr double kAnyTileTexels = 64 * 64;
double work_of(const TileJob& job) {
  const double edge = tile_edge(job.key.size_class);
  return kAnyTileTexels + edge * edge;
}

}  // namespace

TileQueue::Admission TileQueue::submit(const TileKey& key, const TileId& id,
                                       const ObjectLighting& lighting, const Waiter& waiter,
                                       const Lighting& world) {
  const std::lock_guard<std::mutex> lock(mutex_);
  SessionQueue& session = sessions_[waiter.session];
  if (session.requests.size() >= limits::kMaxQueuedAsksPerClient) return Admission::kBusy;
  // The id is in use: a second waiter under it would escape the bound and every removal.
  if (session.requests.count(waiter.request_id) != 0) return Admission::kBusy;
  Request& request = session.requests[waiter.request_id];
  request.id = id;
  const auto found = entries_.find(id);
  const bool merged = found != entries_.end();
  Entry& entry = merged ? found->second : entries_[id];
  entry.waiters.push_back(waiter);
  if (merged) {
    ++counters_.tiles_merged;
  } else {
    entry.job = {key, id, lighting, clock_.now_us(), world, waiter.codec};
  }
  // A NaN error would break the order, so it counts as the worst.
  const float error = waiter.error_px >= 0 && waiter.error_px < 1e30f ? waiter.error_px : 1e30f;
  if (!entry.rendering) {
    // An idle session does not save up turns.
    if (session.ranked.empty()) session.served = std::max(session.served, served_);
    request.rank = Rank{error, ++order_};
    session.ranked.emplace(*request.rank, id);
  }
  not_empty_.notify_one();
  return merged ? Admission::kMerged : Admission::kQueued;
}

bool TileQueue::submit(ReferenceJob job) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const bool again = std::any_of(references_.begin(), references_.end(),
                                 [&](const ReferenceJob& r) { return r.session == job.session; });
  if (again) return false;
  references_.push_back(std::move(job));
  not_empty_.notify_one();
  return true;
}

void TileQueue::submit(ViewJob job) {
  const std::lock_guard<std::mutex> lock(mutex_);
  views_.push_back(std::move(job));
  not_empty_.notify_one();
}

void TileQueue::want_view(const TileId& id) {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (ViewJob& job : views_) job.wanted = job.wanted || job.id == id;
}

bool TileQueue::drop_view(const TileId& id) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto at =
      std::find_if(views_.begin(), views_.end(), [&](const ViewJob& job) { return job.id == id; });
  if (at == views_.end()) return false;
  views_.erase(at);
  return true;
}

void TileQueue::wait_for_levels() {
  const std::lock_guard<std::mutex> lock(mutex_);
  waits_for_levels_ = true;
}

void TileQueue::levels_made() {
  const std::lock_guard<std::mutex> lock(mutex_);
  waits_for_levels_ = false;
  upload_levels_ = true;
  not_empty_.notify_one();
}

bool TileQueue::waits_for_levels() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return waits_for_levels_;
}

std::deque<ViewJob>::iterator TileQueue::next_view() {
  const auto next = [this](bool wanted) {
    return std::find_if(views_.begin(), views_.end(), [&](const ViewJob& job) {
      return (job.wanted || !wanted) && (job.shot.whole || !waits_for_levels_);
    });
  };
  const auto wanted = next(true);
  return wanted != views_.end() ? wanted : next(false);
}

void TileQueue::drop_waiter(SessionId session, std::uint32_t request_id, const TileId& id) {
  const auto found = entries_.find(id);
  if (found == entries_.end()) return;
  std::vector<Waiter>& waiters = found->second.waiters;
  waiters.erase(std::remove_if(waiters.begin(), waiters.end(),
                               [&](const Waiter& w) {
                                 return w.session == session && w.request_id == request_id;
                               }),
                waiters.end());
  if (waiters.empty() && !found->second.rendering) entries_.erase(found);
}

void TileQueue::end_request(SessionQueue& session, std::uint32_t request_id) {
  const auto request = session.requests.find(request_id);
  if (request == session.requests.end()) return;
  if (request->second.rank) session.ranked.erase(*request->second.rank);
  session.requests.erase(request);
}

void TileQueue::end_requests(const std::vector<Waiter>& waiters) {
  for (const Waiter& w : waiters) {
    const auto at = sessions_.find(w.session);
    if (at != sessions_.end()) end_request(at->second, w.request_id);
  }
}

void TileQueue::cancel(SessionId session, std::uint32_t request_id) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto at = sessions_.find(session);
  if (at == sessions_.end()) return;
  const auto request = at->second.requests.find(request_id);
  if (request == at->second.requests.end()) return;
  const TileId id = request->second.id;
  end_request(at->second, request_id);
  drop_waiter(session, request_id, id);
  ++counters_.tiles_cancelled;
}

void TileQueue::remove_session(SessionId session) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto at = sessions_.find(session);
  if (at != sessions_.end()) {
    for (const auto& [request_id, request] : at->second.requests) {
      drop_waiter(session, request_id, request.id);
    }
    sessions_.erase(at);
  }
  references_.erase(std::remove_if(references_.begin(), references_.end(),
                                   [&](const ReferenceJob& r) { return r.session == session; }),
                    references_.end());
  if (reference_for_ == session) reference_for_.reset();
}

bool TileQueue::reference_wanted() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return reference_for_.has_value();
}

bool TileQueue::drop_late(Entry& entry) {
  const std::int64_t now = clock_.now_us();
  const auto is_late = [now](const Waiter& w) { return w.deadline_us != 0 && w.deadline_us < now; };
  for (const Waiter& w : entry.waiters) {
    if (!is_late(w)) return false;  // one request that is not late is enough
  }
  late_.insert(late_.end(), entry.waiters.begin(), entry.waiters.end());
  counters_.tiles_late += entry.waiters.size();
  end_requests(entry.waiters);
  return true;
}

void TileQueue::start(Entry& entry) {
  entry.rendering = true;
  for (const Waiter& w : entry.waiters) {
    SessionQueue& session = sessions_.at(w.session);
    Request& request = session.requests.at(w.request_id);
    session.ranked.erase(*request.rank);
    request.rank.reset();
  }
}

TileQueue::Entry& TileQueue::first_of(const SessionQueue& session) {
  return entries_.at(session.ranked.begin()->second);
}

TileQueue::Entry* TileQueue::next_entry(std::uint32_t slow_edge, bool slow, SessionQueue** turn) {
  for (;;) {
    SessionQueue* next = nullptr;
    for (auto& [id, session] : sessions_) {
      if (session.ranked.empty() || (next && session.served >= next->served)) continue;
      // A session whose next tile is slow keeps its turn and does not block the others.
      if (!slow && tile_edge(first_of(session).job.key.size_class) >= slow_edge) continue;
      next = &session;
    }
    if (!next) return nullptr;
    Entry& entry = first_of(*next);
    if (!drop_late(entry)) {
      *turn = next;
      return &entry;
    }
    entries_.erase(entry.job.id);
  }
}

std::vector<TileJob> TileQueue::take_batch(const Room& room, bool slow) {
  std::vector<TileJob> batch;
  SessionQueue* turn = nullptr;
  while (Entry* entry = next_entry(room.slow_edge, slow && batch.empty(), &turn)) {
    const std::uint32_t edge = tile_edge(entry->job.key.size_class);
    if (!room.fits(edge)) break;
    served_ = turn->served;
    turn->served += work_of(entry->job);
    start(*entry);
    batch.push_back(entry->job);
    if (edge >= room.slow_edge) break;
  }
  return batch;
}

std::optional<TileQueue::Work> TileQueue::take_reference(bool idle) {
  const auto next = std::find_if(references_.begin(), references_.end(),
                                 [&](const ReferenceJob& job) { return job.idle == idle; });
  reference_was_last_ = next != references_.end();
  if (next == references_.end()) return std::nullopt;
  ReferenceJob job = std::move(*next);
  references_.erase(next);
  reference_for_ = job.session;
  job.shot.whole = waits_for_levels_;
  return Work(std::move(job));
}

std::optional<TileQueue::Work> TileQueue::take_view() {
  const auto view = next_view();
  if (view == views_.end()) return std::nullopt;
  ViewJob job = std::move(*view);
  views_.erase(view);
  view_was_last_ = true;
  return Work(std::move(job));
}

std::optional<TileQueue::Work> TileQueue::take(const Room& room, bool wait) {
  std::unique_lock<std::mutex> lock(mutex_);
  for (;;) {
    if (closed_) return std::nullopt;
    if (std::exchange(upload_levels_, false)) return Work(UploadLevels{});
    const bool slow = room.slow();
    if (slow && !reference_was_last_) {
      if (std::optional<Work> reference = take_reference(false)) return reference;
    }
    const auto view = next_view();
    const bool view_first = slow && view != views_.end() && view->wanted && !view_was_last_;
    std::vector<TileJob> batch;
    if (!view_first && !waits_for_levels_) batch = take_batch(room, slow);
    if (slow) view_was_last_ = false;
    if (!batch.empty()) {
      if (slow) reference_was_last_ = false;
      return Work(std::move(batch));
    }
    if (slow) {
      if (std::optional<Work> reference = take_reference(false)) return reference;
      if (std::optional<Work> drawn = take_view()) return drawn;
      if (room.idle && !waits_for_levels_) {
        if (std::optional<Work> idle = take_reference(true)) return idle;
      }
    }
    if (!wait) return std::nullopt;
    not_empty_.wait(lock);
  }
}

void TileQueue::look_again() {
  // A thread in take() that has checked the room, but does not wait yet, would miss the call.
  { const std::lock_guard<std::mutex> lock(mutex_); }
  not_empty_.notify_all();
}

double TileQueue::wait_us(SessionId session, double tile_us) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto own = sessions_.find(session);
  const std::size_t before = own == sessions_.end() ? 0 : own->second.ranked.size();
  std::size_t all = 0;
  for (const auto& [id, other] : sessions_) all += std::min(other.ranked.size(), before + 1);
  return tile_us * static_cast<double>(all);
}

std::vector<Waiter> TileQueue::finish(const TileId& id) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = entries_.find(id);
  if (found == entries_.end()) return {};
  std::vector<Waiter> waiters = std::move(found->second.waiters);
  entries_.erase(found);
  end_requests(waiters);
  return waiters;
}

std::vector<Waiter> TileQueue::take_late() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return std::exchange(late_, {});
}

std::size_t TileQueue::length() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return entries_.size();
}

std::size_t TileQueue::asks_of(SessionId session) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::ptrdiff_t all = std::count_if(references_.begin(), references_.end(),
                                     [&](const auto& job) { return job.session == session; });
  for (const auto& [id, entry] : entries_) {
    all += std::count_if(entry.waiters.begin(), entry.waiters.end(),
                         [&](const Waiter& waiter) { return waiter.session == session; });
  }
  return static_cast<std::size_t>(all);
}

std::size_t TileQueue::ranks() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::size_t all = 0;
  for (const auto& [id, session] : sessions_) all += session.ranked.size();
  return all;
}

bool TileQueue::closed() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return closed_;
}

void TileQueue::close() {
  const std::lock_guard<std::mutex> lock(mutex_);
  closed_ = true;
  not_empty_.notify_all();
}

}  // namespace mirage
