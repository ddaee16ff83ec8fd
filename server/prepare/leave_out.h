#pragma once
// Removes from a scene everything that no pixel depends on (numerics.md section 5), before anything
// is derived from it. Removed content is then in no shader variant, no key, no byte of geometry and
// no client.

#include <cstdint>
#include <string>
#include <vector>

#include "protocol/model/need_rules.h"
#include "server/scene/scene.h"

namespace mirage {

/// Something left out, and the fact that allows it.
struct LeftOut {
  NeedRule rule = NeedRule::kBlending;
  std::string what;
  std::string why;
};

/// All that was left out, by material and by object of the scene.
struct LeftOutOfScene {
  std::vector<std::vector<LeftOut>> materials;
  std::vector<std::vector<LeftOut>> objects;
  std::size_t equal_objects = 0;      ///< objects that repeated another one
  std::size_t covered_instances = 0;  ///< nothing of them is seen (leave_out_covered.h)
  std::size_t covered_triangles = 0;  ///< not seen from one side or either
};

/// Leaves out maps that are neutral in every texel, alpha that is 1 everywhere, vertex attributes
/// that no material reads, unused images, surfaces that a later one covers exactly, and objects
/// that equal an earlier one. Exact: no pixel changes, but for those of surfaces that would tie in
/// depth. A texture that is nearly white does not count as white.
LeftOutOfScene leave_out_unneeded(Scene& scene);

}  // namespace mirage
