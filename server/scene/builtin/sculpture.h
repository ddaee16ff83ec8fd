#pragma once
// One sculpture of the museum, with a mesh and images of its own.

#include <cstddef>
#include <cstdint>
#include <string>

#include "server/scene/builtin/sculpture_paint.h"

namespace mirage::builtin {

/// The base is on the ground at the origin, the face looks to +x; the mesh uses one material.
struct Sculpture {
  std::string name;
  Mesh mesh;
  SculptureFinish finish;
  float height = 0;  ///< metres
};

/// Returns sculpture `number` of the museum of this seed, with about so many triangles.
Sculpture make_sculpture(std::uint32_t seed, std::uint32_t number, std::size_t triangles);

}  // namespace mirage::builtin
