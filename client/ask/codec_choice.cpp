#include "client/ask/codec_choice.h"

#include <algorithm>

#include "protocol/base/quantile.h"

namespace mirage {
namespace {

constexpr std::size_t kCodecTrips = 33;
constexpr std::size_t kLeastTrips = 9;
constexpr double kThinMbps = 4;
constexpr double kHeldBackS = 1;
constexpr std::int64_t kCodecQueueUs = 10'000;  // wait on the link beyond its shortest trip
constexpr double kThickMbps = 2 * kThinMbps;
constexpr double kLossyGain = 2;  // bytes of zstd over WebP: small tiles 1.6, large ones 2.3
constexpr std::int64_t kRoomyUs = 5'000'000;

}  // namespace

void CodecChoice::reset(std::vector<TileCodec> common) {
  *this = CodecChoice(forced_);
  if (!common.empty()) common_ = std::move(common);
}

bool CodecChoice::has(TileCodec codec) const {
  return std::find(common_.begin(), common_.end(), codec) != common_.end();
}

void CodecChoice::tile_arrived(std::int64_t trip_us, std::int64_t server_us) {
  link_us_.push_back(std::max<std::int64_t>(trip_us - server_us, 0));
  if (link_us_.size() > kCodecTrips) link_us_.pop_front();
}

bool CodecChoice::is_thin(const LinkLoad& load, std::int64_t now_us) {
  if (link_us_.size() < kLeastTrips) return thin_;
  const std::vector<std::int64_t> trips(link_us_.begin(), link_us_.end());
  const std::int64_t shortest = *std::min_element(trips.begin(), trips.end());
  const std::int64_t waits = quantile(trips, 0.5) - shortest;
  const bool full = load.held_back_s >= kHeldBackS && waits > kCodecQueueUs;
  if (full) link_mbps_ = load.down_mbps;
  if (thin_) {
    const bool roomy = !full && load.down_mbps * kLossyGain < 0.5 * link_mbps_;
    if (!roomy) roomy_since_us_ = -1;
    if (roomy && roomy_since_us_ < 0) roomy_since_us_ = now_us;
    return load.down_mbps <= kThickMbps && !(roomy && now_us - roomy_since_us_ > kRoomyUs);
  }
  if (!full || load.down_mbps >= kThinMbps) return false;
  roomy_since_us_ = -1;
  return true;
}

TileCodec CodecChoice::update(const LinkLoad& load, std::int64_t now_us) {
  const TileCodec own = common_.front();
  if (forced_) return has(*forced_) ? *forced_ : own;
  thin_ = is_thin(load, now_us);
  return thin_ && has(TileCodec::kWebp) ? TileCodec::kWebp : own;
}

}  // namespace mirage
