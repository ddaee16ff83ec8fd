#pragma once
// glTF 2.0 (.glb, .gltf) -> Scene. Everything is validated before use; see gltf_import.cpp.

#include <string>

#include "server/base/workers.h"
#include "server/scene/scene.h"

namespace mirage {

struct ImportOptions {
  /// Refuses what viewers forgive against the specification (README, "What is forgiven").
  bool strict = false;
  /// Of KHR_materials_variants; empty: the materials that the file starts with.
  std::string variant = {};
};

/// Loads and validates a glTF file.
/// Errors: kSceneMissing, kSceneFormat, kSceneRange, kSceneReference, kSceneCycle, kSceneLimit,
/// kSceneUri, kSceneExtension, kSceneEmpty, kUsage (no such variant); the text names the file and
/// the offending element. Images are decoded by `workers`. Recoverable defects (a NaN vertex, an
/// unreadable texture) are mended and listed in warnings, one line a kind.
Result<Scene> import_gltf(const std::string& path, const Workers& workers = Workers(),
                          const ImportOptions& options = {});

/// The same of `FILE?variant=NAME`, unless there is a file of that very name. Errors: also kUsage.
Result<Scene> import_gltf_spec(const std::string& spec, const Workers& workers = Workers(),
                               ImportOptions options = {});

}  // namespace mirage
