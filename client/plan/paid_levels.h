#pragma once
// Which levels of geometry a frame draws: each takes time once, however many things are drawn from
// it, and is paid for by the first.

#include <cstdint>
#include <unordered_map>

#include "client/plan/alternatives.h"

namespace mirage {

class PaidLevels {
 public:
  /// Each takes `ms`.
  explicit PaidLevels(double ms) : ms_(ms) {}

  /// ms that a thing takes beside its own work by being drawn so, too.
  double add(const Alternatives& thing, const Choice& choice) {
    if (choice.look != Look::kMesh) return 0;
    return ++users_[key(thing, choice)] == 1 ? ms_ : 0;
  }
  /// ms more, or fewer, if a thing were drawn in this other way.
  double change_ms(const Alternatives& thing, const Choice& from, const Choice& to) const {
    const bool same = from.look == to.look && from.lod == to.lod;
    if (same) return 0;
    double ms = 0;
    if (from.look == Look::kMesh && users_.at(key(thing, from)) == 1) ms -= ms_;
    if (to.look == Look::kMesh && users_.count(key(thing, to)) == 0) ms += ms_;
    return ms;
  }
  void change(const Alternatives& thing, const Choice& from, const Choice& to) {
    if (from.look == Look::kMesh) {
      const auto at = users_.find(key(thing, from));
      if (--at->second == 0) users_.erase(at);
    }
    add(thing, to);
  }

 private:
  static std::uint64_t key(const Alternatives& thing, const Choice& choice) {
    return std::uint64_t{thing.object} << 8 | choice.lod;
  }
  double ms_;
  std::unordered_map<std::uint64_t, std::uint32_t> users_;  ///< things, by object and level
};

}  // namespace mirage
