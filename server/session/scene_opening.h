#pragma once
// The order in which a scene's tree is sent: groups whose members a viewer needs, nearest need
// first.

#include <cstdint>
#include <optional>
#include <queue>
#include <unordered_set>
#include <vector>

#include "protocol/impostor/camera.h"
#include "protocol/impostor/instance_group.h"

namespace mirage {

struct PreparedScene;

/// A viewer's pose and rule, and limits on how much is sent.
struct Opening {
  glm::dvec3 eye{0};
  glm::dvec3 forward{0, 0, -1};  ///< groups ahead of the eye come first
  OpenRule rule;
  /// instances and groups to send even beyond the rule, if there are so many
  std::size_t least = 0;
  std::size_t most = 1u << 16;  ///< sent at once; the client asks again for the rest
};

/// Yields the groups whose members are needed, out of some groups (numbered as instances) and the
/// groups nested in them. The nearest need comes first, a group precedes its nested groups, and
/// none comes twice. A step costs as much as the group has members; 10 µs for 64.
class GroupOpening {
 public:
  /// Ids that are no groups are ignored.
  GroupOpening(const PreparedScene& scene, const std::vector<std::uint32_t>& groups,
               const Opening& opening);
  /// Returns the next group; nullopt: no more are needed, or `most` have been sent.
  std::optional<std::uint32_t> next();

 private:
  struct Ranked {
    double urgency = 0;  ///< above 1: the rule requires it
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
