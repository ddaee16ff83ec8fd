#include "server/source/redis_source.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <random>
#include <thread>

namespace mirage {
namespace {

// Limit of one call, µs. Asks wait longer than this in the fetch stage (patience_us()).
constexpr std::int64_t kLimitUs = 10'000;
constexpr int kFailures = 2;  // a single failure may come from this machine being busy
constexpr std::int64_t kFirstPauseUs = 250'000, kLongestPauseUs = 5'000'000;
constexpr std::int64_t kShortestLeaseMs = 100, kFirstLeaseMs = 2'000, kLongestLeaseMs = 10'000;
constexpr std::size_t kMostClaims = 4096;
// A write goes on for 2 s, so it outlasts the first pauses: a store that was slow for a moment
// still gets the tile.
constexpr int kWriteTries = 20;
constexpr std::chrono::milliseconds kWritePause{100};

std::string hex(const TileId& id) { return fmt::format("{:016x}{:016x}", id.high, id.low); }

std::string record_key(const FormId& id) {
  return "mirage:tile:" + hex(id.id) + (id.codec == TileCodec::kWebp ? ".webp" : "");
}

std::string chance_name() {
  std::random_device random;
  return fmt::format("{:08x}{:08x}", random(), random());
}

}  // namespace

RedisSource::RedisSource(StoreAddress address, const Clock& clock)
    : address_(std::move(address)), clock_(clock), name_(chance_name()) {}

std::unique_ptr<RedisLink> RedisSource::take() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const std::int64_t now = clock_.now_us();
    if (now < alone_until_us_) return nullptr;
    // The server did not answer lately. This caller tries it again; the others still leave it
    // alone.
    if (pause_us_ > 0) alone_until_us_ = now + pause_us_;
    if (!idle_.empty()) {
      std::unique_ptr<RedisLink> link = std::move(idle_.back());
      idle_.pop_back();
      return link;
    }
  }
  Result<std::unique_ptr<RedisLink>> fresh = RedisLink::connect(address_, kLimitUs);
  if (fresh) return fresh.take();
  failed(fresh.error());
  return nullptr;
}

void RedisSource::give_back(std::unique_ptr<RedisLink> link) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (pause_us_ > 0) spdlog::info("store: {} answers again", address_.name());
  pause_us_ = failures_ = 0;
  alone_until_us_ = INT64_MIN;
  idle_.push_back(std::move(link));
}

void RedisSource::failed(const Error& error) {
  const std::lock_guard<std::mutex> lock(mutex_);
  idle_.clear();  // these reach the same server and are as old
  if (++failures_ < kFailures) return;
  if (pause_us_ == 0) {
    spdlog::warn("store: {} does not answer ({}): tiles are rendered here until it does",
                 address_.name(), error.text);
  }
  pause_us_ = std::clamp(2 * pause_us_, kFirstPauseUs, kLongestPauseUs);
  alone_until_us_ = clock_.now_us() + pause_us_;
}

std::optional<Bytes> RedisSource::fetch(const FormId& id) {
  std::unique_ptr<RedisLink> link = take();
  if (!link) return std::nullopt;
  Result<std::optional<Bytes>> record = link->get(record_key(id));
  if (!record) {
    failed(record.error());
    return std::nullopt;
  }
  give_back(std::move(link));
  return record.take();
}

// Retries are affordable: only the writer thread waits, and a lost tile is rendered again
// elsewhere.
bool RedisSource::offer(const FormId& id, const Bytes& record) {
  note_made(id.id);
  for (int tries = 0; tries < kWriteTries; ++tries) {
    if (tries > 0) std::this_thread::sleep_for(kWritePause);
    if (write(id, record)) return true;
  }
  return false;
}

bool RedisSource::write(const FormId& id, const Bytes& record) {
  std::unique_ptr<RedisLink> link = take();
  if (!link) return false;
  const Result<void> kept = link->set(record_key(id), record);
  if (!kept) {
    failed(kept.error());
    return false;
  }
  give_back(std::move(link));
  return true;
}

bool RedisSource::claim(const TileId& id) {
  std::unique_ptr<RedisLink> link = take();
  if (!link) return true;
  const Result<std::string> holder = link->hold("mirage:lease:" + hex(id), name_, lease_ms());
  if (!holder) {
    failed(holder.error());
    return true;
  }
  give_back(std::move(link));
  if (*holder != name_) return false;
  const std::lock_guard<std::mutex> lock(mutex_);
  // claims whose tile was no longer wanted
  if (claimed_us_.size() >= kMostClaims) claimed_us_.clear();
  claimed_us_.try_emplace(id, clock_.now_us());
  return true;
}

void RedisSource::note_made(const TileId& id) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto claimed = claimed_us_.extract(id);
  if (claimed.empty()) return;
  made_us_[made_++ % made_us_.size()] = clock_.now_us() - claimed.mapped();
}

// Twice the time that 99 of 100 of the last tiles stayed below.
std::int64_t RedisSource::lease_ms() {
  const std::lock_guard<std::mutex> lock(mutex_);
  const std::size_t known = std::min(made_, made_us_.size());
  if (known == 0) return kFirstLeaseMs;
  std::array<std::int64_t, 128> times = made_us_;
  const std::size_t rank = known * 99 / 100;
  std::nth_element(times.begin(), times.begin() + rank, times.begin() + known);
  return std::clamp(2 * times[rank] / 1000, kShortestLeaseMs, kLongestLeaseMs);
}

}  // namespace mirage
