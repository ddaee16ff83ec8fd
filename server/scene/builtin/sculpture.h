#pragma once
// One sculpture of the museum: a mesh and images that no other has.

#include <cstddef>
#include <cstdint>
#include <string>

#include "server/scene/builtin/sculpture_paint.h"

namespace mirage::builtin {

/// Base on the ground at the origin, its face towards +x; its mesh uses one material.
struct Sculpture {
  std::string name;
  Mesh mesh;
  SculptureFinish finish;
  float height = 0;  ///< metres
};

/// The sculpture of that number in the museum of that seed, of about so many triangles.
Sculpture make_sculpture(std::uint32_t seed, std::uint32_t number, std::size_t triangles);

}  // namespace mirage::builtin
