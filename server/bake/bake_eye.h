#pragma once
// Draws a bake as an engine would, in software, to measure its error. numerics.md section 7.

#include <cstdint>
#include <string_view>
#include <vector>

#include "server/bake/master.h"
#include "server/base/workers.h"

namespace mirage {

enum class BakeMethod : std::uint8_t {
  kNearest,  ///< the frame nearest to the view, on a plane through the centre
  kBlend,    ///< the three frames around the view, on planes, weighted
  kDepth,    ///< the three frames, each traced along the ray through its heights, weighted
};
std::string_view name_of(BakeMethod method);

/// A square picture of a bake or of its mesh: surfaces, not shaded.
struct BakePicture {
  int edge = 0;
  std::vector<glm::vec4> color;   ///< premultiplied, linear; the top row first
  std::vector<glm::vec3> normal;  ///< unit length; 0 where nothing is
};

/// A camera that looks at the centre of a bake, its sphere filling the picture.
struct BakeCamera {
  glm::dvec3 direction;  ///< unit length, from the centre to the eye
  double radii = 4;      ///< distance of the eye from the centre, in radii, above 1

  /// Returns the axes of the picture: right, up, toward the eye.
  FrameBasis basis() const;
  /// Half the picture's edge at distance 1: 5 % more than the sphere's outline.
  double half_tangent() const;
};

/// Returns the bake with the precision of its 8-bit files: colour in sRGB, normals and heights.
BakeMaster as_bytes(BakeMaster master);

/// Draws a bake. `samples`: rays of a pixel each way. Not for a ring.
BakePicture draw_bake(const BakeMaster& master, const BakeCamera& camera, BakeMethod method,
                      int edge, int samples, const Workers& workers);

}  // namespace mirage
