#pragma once
// A run of mirage-bake: scene -> subjects -> captures -> files. GL thread.

#include "server/bake/bake_options.h"

namespace mirage {

/// Bakes what the options say, with progress on standard error and the result on standard output.
/// Errors: those of the scene, of graphics, and kIo.
Result<void> run_bake(const BakeOptions& options);

}  // namespace mirage
