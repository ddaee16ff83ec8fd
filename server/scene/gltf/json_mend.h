#pragma once
// Mends JSON that exporters write and parsers refuse.

#include <string>
#include <string_view>

namespace mirage::gltf {

/// Returns the text with each byte of a string that is not UTF-8 replaced by '?', as other viewers
/// show such names, and with null in the place of numbers that are not finite: NaN, Infinity, and
/// those beyond double precision.
std::string mend_json(std::string_view text);

}  // namespace mirage::gltf
