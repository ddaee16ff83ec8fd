#pragma once
// Name list: names out of a file, in errors and hints.

#include <string>
#include <vector>

namespace mirage::gltf {

/// Returns the name in one line, cut to a few dozen bytes.
std::string shown_name(const std::string& name);
/// Returns "its variants: a, b", or "the file has no variants", with `kind` "variants".
std::string listed_names(const std::string& kind, const std::vector<std::string>& names);

}  // namespace mirage::gltf
