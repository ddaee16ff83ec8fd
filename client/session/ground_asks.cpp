#include "client/session/ground_asks.h"

#include <algorithm>

#include "client/scene/ground_map.h"

namespace mirage {
namespace {

constexpr std::size_t kMostAtOnce = 4;
constexpr std::int64_t kPauseAfterRefusalUs = 1'000'000;  // after a refusal

}  // namespace

std::vector<GroundBlockId> GroundAsks::plan(const GroundMap& map, double x, double z,
                                            std::int64_t now_us) const {
  if (now_us < not_before_us_ || pending_.size() >= kMostAtOnce) return {};
  std::vector<GroundBlockId> out = map.missing_around(x, z);
  const auto is_asked = [this](const GroundBlockId& block) {
    return std::any_of(pending_.begin(), pending_.end(),
                       [&](const auto& entry) { return entry.second == block; });
  };
  out.erase(std::remove_if(out.begin(), out.end(), is_asked), out.end());
  out.resize(std::min(out.size(), kMostAtOnce - pending_.size()));
  return out;
}

bool GroundAsks::finish(std::uint32_t request_id, GroundBlockId block) {
  const auto at = pending_.find(request_id);
  if (at == pending_.end() || !(at->second == block)) return false;
  pending_.erase(at);
  return true;
}

bool GroundAsks::refused(std::uint32_t request_id, std::int64_t now_us) {
  if (pending_.erase(request_id) == 0) return false;
  not_before_us_ = now_us + kPauseAfterRefusalUs;
  return true;
}

}  // namespace mirage
