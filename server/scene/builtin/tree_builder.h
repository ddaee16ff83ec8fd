#pragma once
// Grows trees: a skeleton, bark tubes, and foliage as alpha-masked cards.

#include <cstdint>

#include "server/scene/builtin/mesh_builder.h"

namespace mirage::builtin {

struct SceneParts;

/// One kind of tree. Lengths in metres.
struct TreeSpecies {
  const char* name = "";
  bool conifer = false;
  float height = 9;
  float trunk_radius = 0.2f;
  float trunk_top = 0.8f;   ///< leader's height as a share of `height`
  float crown_base = 2.5f;  ///< height where the crown starts
  float crown_radius = 3;
  float droop = 0;    ///< how far twig ends hang
  float card = 0.5f;  ///< side of a leaf card
  int tips = 260;     ///< twig ends (broadleaf) or branches (conifer)
  int cards_per_tip = 18;
  glm::vec3 leaf_dark{0.03f, 0.09f, 0.02f};
  glm::vec3 leaf_light{0.12f, 0.25f, 0.05f};
  float leaf_length = 0.3f;
  float leaf_width = 0.5f;
  bool lobed = false;
  bool birch_bark = false;
  glm::vec3 bark{0.12f, 0.085f, 0.06f};
};

inline constexpr int kTreeSpeciesCount = 8;
const TreeSpecies& tree_species(int index);

/// Adds the species' images and materials to `parts` and grows one tree with its foot at the
/// origin; 12,000 to 20,000 triangles.
Mesh grow_tree(SceneParts& parts, const TreeSpecies& species, std::uint32_t seed);

/// Adds one square leaf card. Its front faces `out` and its normals lean to `out`, so that a crown
/// is lit as a round body rather than as a heap of confetti.
void add_leaf_card(MeshBuilder& builder, glm::vec3 center, glm::vec3 facing, glm::vec3 out,
                   float side, float spin);

}  // namespace mirage::builtin
