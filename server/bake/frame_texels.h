#pragma once
// Reads one frame of a bake for a target: straightens colours, fills what is empty around the
// object and makes the fields that stand in for coverage.

#include "server/bake/alpha_field.h"
#include "server/bake/master.h"
#include "server/bake/target.h"

namespace mirage {

/// A texel before its channels are encoded.
struct FrameTexel {
  glm::vec3 color{0};   ///< linear; premultiplied or straight, as the target says
  float coverage = 0;   ///< 0 to 1
  glm::vec3 normal{0};  ///< the object's space; 0 in the background
  float depth = 0;      ///< s / r
  glm::vec3 orm{1, 1, 0};
  float inner = 0, signed_edge = 0;  ///< inner_field and signed_field; 0 unless the target has them
};

/// Returns the texel where neither object nor filling is.
FrameTexel empty_texel();

class FrameTexels {
 public:
  /// `first`: number of the frame's first texel in the master, which outlives this.
  FrameTexels(const BakeMaster& master, const TargetFacts& target, std::size_t first);

  /// Returns a texel, counted from the top left of the frame.
  FrameTexel at(int texel) const;

 private:
  int source(const NearestTexels& nearest, int texel, int fill) const;

  const BakeMaster& master_;
  const TargetFacts& target_;
  std::size_t first_;
  TexelMask covered_;      ///< by anything at all
  NearestTexels colored_;  ///< covered texels, for colours
  NearestTexels shaped_;   ///< texels with a surface, for normal, depth and orm
  std::vector<float> inner_, signed_;
};

}  // namespace mirage
