#pragma once
// View place: a camera as people write it, by two points.

#include <glm/glm.hpp>
#include <string>

#include "protocol/base/result.h"

namespace mirage {

/// Where the eye is, and a point that it looks at, metres; the two differ.
struct ViewPlace {
  glm::dvec3 eye{0}, target{0};
};

/// Reads "EX,EY,EZ,TX,TY,TZ", each up to 1e9. Error kUsage.
Result<ViewPlace> parse_view_place(const std::string& text);
/// Returns the text that parse_view_place() reads.
std::string to_text(const ViewPlace& place);

}  // namespace mirage
