#pragma once
// Takes out of a scene what no pixel depends on (numerics.md section 5), before anything is made
// from it: what is gone here is in no shader variant, no key, no byte of geometry and no client.

#include <cstdint>
#include <string>
#include <vector>

#include "protocol/model/need_rules.h"
#include "server/scene/scene.h"

namespace mirage {

/// Something left out, and the fact it rests on.
struct LeftOut {
  NeedRule rule = NeedRule::kBlending;
  std::string what;
  std::string why;
};

/// By material and by object of the scene.
struct LeftOutOfScene {
  std::vector<std::vector<LeftOut>> materials;
  std::vector<std::vector<LeftOut>> objects;
  std::size_t equal_objects = 0;  ///< objects that were another one over again
};

/// Maps that are neutral in every texel, alpha that is 1 everywhere, vertex attributes that no
/// material reads, images that nothing uses any more, and objects that equal an earlier one. Exact:
/// no pixel changes. A texture that is nearly white is not white.
LeftOutOfScene leave_out_unneeded(Scene& scene);

}  // namespace mirage
