#pragma once
// Reads the JSON of a file as a stream, in time that grows with its length only.

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string_view>

#include "protocol/base/result.h"
#include "server/scene/gltf/tally.h"

namespace mirage::gltf {

struct SceneLimits;

/// Reads a text as a tree without its extras, of which only `extras.mirage` is kept: files of
/// buildings have millions of properties that nothing needs. Forgives objects that name a property
/// twice (the last counts), text that is not UTF-8, and numbers that are not finite. Errors:
/// kSceneFormat; kSceneLimit for a text nested deeper than kMaxJsonDepth, or with more values
/// than `limits` allow outside of extras.
Result<nlohmann::json> read_json(std::string_view text, const SceneLimits& limits, Tally& tally);

}  // namespace mirage::gltf
