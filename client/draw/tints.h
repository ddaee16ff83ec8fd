#pragma once
// Tints: the colours by which a picture shows how it was made.

#include <glm/glm.hpp>
#include <vector>

namespace mirage {

/// Premultiplied RGBA; all 0: the thing hides others, and is not tinted.
struct Tints {
  std::vector<glm::vec4> impostors;  ///< one each, in the order of DrawList::impostors
  glm::vec4 placeholders{0};
  glm::vec4 meshes{0};
};

}  // namespace mirage
