#pragma once
// What `--environment` says, made the light of a scene.

#include <string>
#include <vector>

#include "server/base/workers.h"
#include "server/scene/environment/equirect.h"
#include "server/scene/scene.h"

namespace mirage {

/// What a file or `builtin:` name shows; empty: the studio. Counted defects go to `warnings`.
/// Errors: kUsage for another builtin, those of read_environment().
Result<Equirect> surroundings(const std::string& spec, std::vector<std::string>& warnings);

/// `spec`: a file, `builtin:studio`, `builtin:sky`, `none`; empty: the studio for a scene without
/// lights of its own, else none. A scene in which nothing is lit gets none. The probe takes the
/// place of the ambient light, and of the default lights of a scene without its own.
/// Errors: those of surroundings().
Result<void> set_environment(const std::string& spec, Scene& scene, const Workers& workers);

}  // namespace mirage
