#include "server/scene_opening.h"

#include <queue>

namespace mirage {
namespace {

// Behind the eye counts as so much farther.
constexpr double kBehind = 4;

struct Ranked {
  double urgency = 0;  // above 1: the rule asks for it
  std::uint32_t id = 0;
  bool operator<(const Ranked& other) const {
    return urgency != other.urgency ? urgency < other.urgency : id > other.id;
  }
};

}  // namespace

std::vector<std::uint32_t> groups_to_open(const PreparedScene& scene,
                                          const std::vector<std::uint32_t>& groups,
                                          const Opening& opening) {
  // Needed ones by how far inside their distance the eye is, first those before it; then, while
  // fewer than `least` have been told of, the others.
  std::priority_queue<Ranked> needed, others;
  const auto add = [&](std::uint32_t id) {
    const InstanceGroup* group = scene.group_of_instance(id);
    if (!group || group->members == 0) return;
    const double radius = glm::length(glm::dvec3(group->bounds.half));
    OpenRule rule = opening.rule;
    rule.tau_px *= tolerance(group->importance);
    const glm::dvec3 way = group->bounds.center - opening.eye;
    const double distance = glm::length(way);
    const double urgency = open_distance(rule, radius) / std::max(distance, 1e-9);
    const bool before = glm::dot(way, opening.forward) > -radius;
    if (urgency > 1) {
      needed.push({before ? urgency : urgency / kBehind, id});
    } else {
      others.push({urgency, id});
    }
  };
  for (const std::uint32_t id : groups) add(id);
  std::vector<std::uint32_t> out;
  std::size_t told = 0;
  const auto wanted = [&] { return !needed.empty() || (told < opening.least && !others.empty()); };
  while (wanted() && told < opening.most) {
    std::priority_queue<Ranked>& from = needed.empty() ? others : needed;
    const std::uint32_t id = from.top().id;
    from.pop();
    out.push_back(id);
    const InstanceGroup& group = *scene.group_of_instance(id);
    told += group.members;
    for (std::uint32_t i = 0; i < group.members; ++i) {
      add(scene.grouping.members[group.first_member + i]);
    }
  }
  return out;
}

}  // namespace mirage
