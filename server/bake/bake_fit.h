#pragma once
// Chooses how many frames and texels an object needs for a given error.

#include <functional>
#include <string>

#include "server/bake/bake_error.h"
#include "server/bake/bake_options.h"

namespace mirage {

/// The way in which a target's consumer draws, as far as the bake's error is measured for it.
BakeMethod method_of(const TargetFacts& target);

struct FittedBake {
  BakeShot shot;
  double psnr_db = 0;    ///< on the directions of the search
  bool reached = false;  ///< false: the largest that is allowed
};

/// Returns the cheapest of the tried grids and sizes whose PSNR at 4 radii is at least `error_db`.
/// It tries sizes upward, and a few grids of each. `shot` is the shot without grid, tile and
/// radius; `told` receives what was tried. Errors as BakeRenderer::bake.
Result<FittedBake> fit_bake(BakeRenderer& renderer, const BakeSubject& subject,
                            const TargetFacts& target, const BakeShot& shot, double error_db,
                            const Workers& workers,
                            const std::function<void(const std::string&)>& told);

}  // namespace mirage
