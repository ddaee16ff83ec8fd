#pragma once
// Parses `name?key=value&key=value` into checked numbers.

#include <span>
#include <string>
#include <vector>

#include "protocol/base/result.h"

namespace mirage::builtin {

struct OptionRule {
  const char* key;
  double fallback;
  double low;
  double high;
  bool whole = true;  ///< integers only
};

/// Values in the order of the rules.
using OptionValues = std::vector<double>;

/// Parses the part after '?'. Error kSceneBuiltin: an unknown or repeated key, or a value that is
/// no number or out of range.
Result<OptionValues> parse_options(const std::string& scene, const std::string& text,
                                   std::span<const OptionRule> rules);

/// Returns a text such as "trees=400 species=4 seed=1".
std::string describe_options(std::span<const OptionRule> rules);

/// Returns the candidate with the smallest edit distance, if it is close enough to be a typo; else
/// "".
std::string closest_name(const std::string& name, const std::vector<std::string>& candidates);

}  // namespace mirage::builtin
