#pragma once
// Equirectangular images of surroundings: .hdr, .exr.

#include <string>
#include <vector>

#include "protocol/base/result.h"
#include "server/scene/environment/equirect.h"

namespace mirage {

/// Reads a file, a band of rows at a time, and reduces it to 1024 x 512 at most. Values that are
/// NaN, negative or brighter than 65408 are replaced, with a counted line in `warnings`. A shape
/// other than 2:1 also gives a warning. Errors: kSceneMissing, kSceneFormat, kSceneLimit (above
/// 8192 x 8192).
Result<Equirect> read_environment(const std::string& path, std::vector<std::string>& warnings);

/// Writes `.hdr` or `.exr`, chosen by the name. Error kIo.
Result<void> write_environment(const Equirect& image, const std::string& path);

}  // namespace mirage
