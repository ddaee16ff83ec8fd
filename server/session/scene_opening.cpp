#include "server/session/scene_opening.h"

#include "server/prepare/grouping.h"
#include "server/prepare/prepared_scene.h"

namespace mirage {
namespace {

// Groups behind the eye count as this many times farther away.
constexpr double kBehind = 4;

}  // namespace

GroupOpening::GroupOpening(const PreparedScene& scene, const std::vector<std::uint32_t>& groups,
                           const Opening& opening)
    : scene_(scene), opening_(opening) {
  for (const std::uint32_t id : groups) add(id);
}

// Needed groups are ranked by how far inside their opening distance the eye is, those ahead of the
// eye first. The other groups follow while fewer than `least` have been sent.
void GroupOpening::add(std::uint32_t id) {
  if (id >= scene_.instance_count()) return;
  const InstanceGroup* group = scene_.group_of_instance(id);
  if (!group || group->members == 0 || !seen_.insert(id).second) return;
  const double radius = glm::length(glm::dvec3(group->bounds.half));
  OpenRule rule = opening_.rule;
  rule.tau_px *= tolerance(group->importance);
  const glm::dvec3 way = group->bounds.center - opening_.eye;
  const double distance = glm::length(way);
  const double urgency = open_distance(rule, radius) / std::max(distance, 1e-9);
  const bool before = glm::dot(way, opening_.forward) > -radius;
  if (urgency > 1) {
    needed_.push({before ? urgency : urgency / kBehind, id});
  } else {
    others_.push({urgency, id});
  }
}

std::optional<std::uint32_t> GroupOpening::next() {
  const bool wanted = !needed_.empty() || (told_ < opening_.least && !others_.empty());
  if (!wanted || told_ >= opening_.most) return std::nullopt;
  std::priority_queue<Ranked>& from = needed_.empty() ? others_ : needed_;
  const std::uint32_t id = from.top().id;
  from.pop();
  const InstanceGroup& group = *scene_.group_of_instance(id);
  told_ += group.members;
  for (std::uint32_t i = 0; i < group.members; ++i) {
    add(scene_.grouping.members[group.first_member + i]);
  }
  return id;
}

}  // namespace mirage
