#pragma once
// Paid levels: which levels of geometry a frame draws. A level takes time once, however many things
// are drawn from it; the first of them pays.

#include <cstdint>
#include <unordered_map>

#include "client/plan/alternatives.h"

namespace mirage {

class PaidLevels {
 public:
  /// Each level takes `ms`.
  explicit PaidLevels(double ms) : ms_(ms) {}

  /// Adds a thing drawn this way. Returns the ms that it takes beside its own work.
  double add(const Alternatives& thing, const Choice& choice) {
    if (choice.look != Look::kMesh) return 0;
    return ++users_[key(thing, choice)] == 1 ? ms_ : 0;
  }
  /// Returns the ms that are added (negative: saved) if a thing were drawn the other way.
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
  /// Number of things, by object and level.
  std::unordered_map<std::uint64_t, std::uint32_t> users_;
};

}  // namespace mirage
