#pragma once
// The error of a bake against its mesh, by the field's protocol: docs/measured and numerics.md
// section 7.

#include <optional>
#include <string>
#include <vector>

#include "server/bake/bake_eye.h"
#include "server/bake/bake_renderer.h"

namespace mirage {

/// How much is measured.
struct ErrorEffort {
  int edge = 256;      ///< pixels of a picture each way
  int directions = 4;  ///< held out: none of them is a frame's
  std::vector<double> radii = {4};
  std::vector<BakeMethod> methods = {BakeMethod::kNearest, BakeMethod::kBlend, BakeMethod::kDepth};
  int offset = 0;  ///< another set of directions for each number
};

/// Means over the directions at one distance. nullopt: nothing to compare, or no difference at all.
struct BakeErrorRow {
  BakeMethod method = BakeMethod::kDepth;
  double radii = 4;
  double angle_deg = 0;  ///< mean angle between the view and the nearest frame
  std::optional<double> psnr_db, ssim, iou;
};

/// Draws the bake and the subject's mesh, shades both alike (ambient 0.6 and a sun of 2.5 from
/// (2,3,1), diffuse), and compares them before grey. The bake must be of 8-bit precision. Errors as
/// BakeRenderer::draw. GL thread.
Result<std::vector<BakeErrorRow>> measure_bake(BakeRenderer& renderer, const BakeSubject& subject,
                                               const BakeMaster& master, const ErrorEffort& effort,
                                               const Workers& workers);

}  // namespace mirage
