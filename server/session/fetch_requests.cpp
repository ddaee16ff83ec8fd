#include "server/session/fetch_requests.h"

#include <algorithm>
#include <iterator>

#include "protocol/base/limits.h"
#include "protocol/codec/tile_codec.h"

namespace mirage {
namespace {

// Longer than the time a server may take to render a tile that others wait for (RedisSource).
constexpr std::int64_t kPatienceWithOthersUs = 12'000'000;
// First and last duration for which slow sources are left alone. A disk that paused once is soon
// asked again; one that hangs is asked once in ten seconds.
constexpr std::int64_t kFirstAvoidUs = 250'000, kLongestAvoidUs = 10'000'000;

}  // namespace

bool FetchRequests::sources_are_slow() const {
  return clock_.now_us() < avoid_until_us_ || (on_trial_ && !looked_for_.empty());
}

bool FetchRequests::wait(const TileAsk& ask) {
  const FormId wanted{ask.id, ask.waiter.codec};
  const std::pair request(ask.waiter.session, ask.waiter.request_id);
  if (requests_.size() >= limits::kMaxQueuedAsksPerClient || requests_.count(request) != 0) {
    return false;
  }
  const auto found = looked_for_.find(wanted);
  if (found == looked_for_.end()) {
    FetchJob job{ask.id, ask.waiter.codec};
    if (sources_are_slow() || !jobs_.try_push(job)) return false;
    looked_for_[wanted] = {clock_.now_us() + patience_us_, {ask}};
  } else {
    found->second.asks.push_back(ask);
  }
  requests_[request] = wanted;
  return true;
}

std::vector<TileAsk> FetchRequests::take(const TileId& id, TileCodec codec) {
  auto node = looked_for_.extract(FormId{id, codec});
  if (node.empty()) return {};  // these asks were given up before
  on_trial_ = false;
  avoid_us_ = 0;
  std::vector<TileAsk> out = std::move(node.mapped().asks);
  for (const TileAsk& ask : out) requests_.erase({ask.waiter.session, ask.waiter.request_id});
  return out;
}

void FetchRequests::be_patient(const TileId& id, TileCodec codec) {
  const auto found = looked_for_.find(FormId{id, codec});
  if (found != looked_for_.end()) {
    found->second.until_us = clock_.now_us() + kPatienceWithOthersUs;
  }
}

std::vector<TileAsk> FetchRequests::take_overdue() {
  const std::int64_t now = clock_.now_us();
  const bool late = std::any_of(looked_for_.begin(), looked_for_.end(),
                                [&](const auto& entry) { return now > entry.second.until_us; });
  if (!late) return {};
  avoid_us_ = avoid_us_ > 0 ? std::min(2 * avoid_us_, kLongestAvoidUs) : kFirstAvoidUs;
  avoid_until_us_ = now + avoid_us_;
  on_trial_ = true;
  while (jobs_.try_pop()) {
  }
  std::vector<TileAsk> out;
  for (auto& [wanted, entry] : looked_for_) {
    std::move(entry.asks.begin(), entry.asks.end(), std::back_inserter(out));
  }
  looked_for_.clear();
  requests_.clear();
  return out;
}

bool FetchRequests::cancel(SessionId session, std::uint32_t request_id) {
  const auto request = requests_.find({session, request_id});
  if (request == requests_.end()) return false;
  std::vector<TileAsk>& asks = looked_for_.at(request->second).asks;
  asks.erase(std::remove_if(asks.begin(), asks.end(),
                            [&](const TileAsk& ask) {
                              return ask.waiter.session == session &&
                                     ask.waiter.request_id == request_id;
                            }),
             asks.end());
  requests_.erase(request);
  return true;
}

std::size_t FetchRequests::asks_of(SessionId session) const {
  const auto first = requests_.lower_bound({session, 0});
  return static_cast<std::size_t>(std::distance(first, requests_.lower_bound({session + 1, 0})));
}

void FetchRequests::remove_session(SessionId session) {
  std::vector<std::uint32_t> gone;
  for (auto at = requests_.lower_bound({session, 0});
       at != requests_.end() && at->first.first == session; ++at) {
    gone.push_back(at->first.second);
  }
  for (const std::uint32_t request : gone) cancel(session, request);
}

}  // namespace mirage
