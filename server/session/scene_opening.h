#pragma once
// Which groups a viewer needs the members of, nearest need first: what is told of a scene's tree.

#include <cstdint>
#include <optional>
#include <queue>
#include <unordered_set>
#include <vector>

#include "protocol/impostor/camera.h"
#include "protocol/impostor/instance_group.h"

namespace mirage {

struct PreparedScene;

/// Who looks, and how much is told.
struct Opening {
  glm::dvec3 eye{0};
  glm::dvec3 forward{0, 0, -1};  ///< what lies before the eye comes first
  OpenRule rule;
  std::size_t least = 0;  ///< instances and groups that are told of beyond the rule, if there are
  std::size_t most = 1u << 16;  ///< told of at once; what is left over is asked for again
};

/// Of some groups (numbered as instances) and what is nested in them, those whose members are
/// needed, one after the other: the nearest need first, a group before the ones in it, none twice.
/// Each costs as much as its members; 10 µs for 64.
class GroupOpening {
 public:
  /// What is no group is passed over.
  GroupOpening(const PreparedScene& scene, const std::vector<std::uint32_t>& groups,
               const Opening& opening);
  /// nullopt: no more are needed, or `most` have been told of.
  std::optional<std::uint32_t> next();

 private:
  struct Ranked {
    double urgency = 0;  ///< above 1: the rule asks for it
    std::uint32_t id = 0;
    bool operator<(const Ranked& other) const {
      return urgency != other.urgency ? urgency < other.urgency : id > other.id;
    }
  };
  void add(std::uint32_t id);

  const PreparedScene& scene_;
  const Opening opening_;
  std::priority_queue<Ranked> needed_, others_;
  std::unordered_set<std::uint32_t> seen_;
  std::size_t told_ = 0;
};

}  // namespace mirage
