#pragma once
// Imports glTF 2.0 (.glb, .gltf) as a Scene. Everything is validated before use; see
// gltf_import.cpp.

#include <cstdint>
#include <string>

#include "server/base/workers.h"
#include "server/scene/scene.h"

namespace mirage {

struct ImportOptions {
  /// Refuses files that violate the specification in ways that viewers forgive (README, "What is
  /// forgiven").
  bool strict = false;
  /// The one clip that plays, by name or by its place from 0, and the variant of
  /// KHR_materials_variants. Empty: all clips play, and the file's initial materials.
  SceneChoice choice = {};
  /// Memory that the scene may take, MB; files that need more are refused.
  std::uint64_t megabytes = 3072;
};

/// Loads and validates a glTF file. Errors: kSceneMissing, kSceneFormat, kSceneRange,
/// kSceneReference, kSceneCycle, kSceneLimit, kSceneUri, kSceneExtension, kSceneEmpty, kUsage (no
/// such variant or clip); the text names the file and the offending element. `workers` decode
/// images. Recoverable defects (a NaN vertex, an unreadable texture) are repaired and listed in
/// warnings, one line a kind.
Result<Scene> import_gltf(const std::string& path, const Workers& workers = Workers(),
                          const ImportOptions& options = {});

/// Imports `FILE?variant=NAME`, `FILE?clip=NAME` or `FILE?clip=N`, or both with '&' between, unless
/// a file of that whole name exists. What `options` choose counts before that. Errors: also kUsage.
Result<Scene> import_gltf_spec(const std::string& spec, const Workers& workers = Workers(),
                               ImportOptions options = {});

}  // namespace mirage
