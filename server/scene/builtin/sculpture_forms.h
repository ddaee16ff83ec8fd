#pragma once
// Kinds of sculptures. Each kind is a family of shapes, one for every seed.

#include <array>
#include <cstdint>
#include <variant>

#include "server/scene/builtin/sculpture_mesh.h"

namespace mirage::builtin {

using SculptureShape = std::variant<GridSurface, Solid>;

struct SculptureKind {
  const char* name;
  float height_m;  ///< typical of this kind
  SculptureShape (*shape)(std::uint32_t seed);
};

// Swept and turned surfaces.
SculptureShape shape_urn(std::uint32_t seed);
SculptureShape shape_twisted_column(std::uint32_t seed);
SculptureShape shape_cut_stone(std::uint32_t seed);
SculptureShape shape_coral(std::uint32_t seed);
SculptureShape shape_knot(std::uint32_t seed);
SculptureShape shape_ribbon(std::uint32_t seed);
SculptureShape shape_ring(std::uint32_t seed);
SculptureShape shape_shell(std::uint32_t seed);
// Solids.
SculptureShape shape_bust(std::uint32_t seed);
SculptureShape shape_reclining(std::uint32_t seed);
SculptureShape shape_lattice(std::uint32_t seed);
SculptureShape shape_totem(std::uint32_t seed);

/// All kinds, ordered so that neighbours differ.
inline constexpr std::array<SculptureKind, 12> kSculptureKinds = {{
    {"bust", 0.85f, shape_bust},
    {"torus knot", 1.15f, shape_knot},
    {"urn", 1.3f, shape_urn},
    {"reclining figure", 1.0f, shape_reclining},
    {"twisted column", 1.9f, shape_twisted_column},
    {"lattice egg", 1.2f, shape_lattice},
    {"ring", 1.35f, shape_ring},
    {"cut stone", 1.0f, shape_cut_stone},
    {"totem", 1.9f, shape_totem},
    {"shell", 1.0f, shape_shell},
    {"coral", 1.1f, shape_coral},
    {"ribbon", 1.3f, shape_ribbon},
}};

}  // namespace mirage::builtin
