#pragma once
// Turns `--environment` into the light of a scene.

#include <string>
#include <vector>

#include "server/base/workers.h"
#include "server/scene/environment/equirect.h"
#include "server/scene/scene.h"

namespace mirage {

/// Returns the surroundings of a file or `builtin:` name; empty: the studio. Counted defects go to
/// `warnings`. Errors: kUsage for an unknown built-in, those of read_environment().
Result<Equirect> surroundings(const std::string& spec, std::vector<std::string>& warnings);

/// Sets the environment of a scene. `spec`: a file, `builtin:studio`, `builtin:sky`, `none`; empty:
/// the studio for a scene without lights of its own, else none. An entirely unlit scene gets none.
/// The probe replaces the ambient light, and the default lights of a scene without its own. Errors:
/// those of surroundings().
Result<void> set_environment(const std::string& spec, Scene& scene, const Workers& workers);

/// Shows a scene as one shows a model in a studio, if it is lit by the studio and has no lights of
/// its own: before a soft backdrop, on its floor (Environment::floor), highlights compressed.
/// Otherwise, and if `studio` is false, it has no floor. `spec` as above.
void set_look(bool studio, const std::string& spec, Scene& scene);

}  // namespace mirage
