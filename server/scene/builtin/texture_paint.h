#pragma once
// Procedurally drawn images. Colours given are linear; images are sRGB.

#include <cstdint>
#include <glm/glm.hpp>

#include "protocol/model/model.h"

namespace mirage::builtin {

/// A linear component, clamped, as images hold it.
std::uint8_t srgb_byte(float linear);

struct LeafStyle {
  int count = 12;
  float length = 0.3f;  ///< of the image's side
  float width = 0.3f;   ///< of the leaf's length
  glm::vec3 dark{0.03f, 0.09f, 0.02f};
  glm::vec3 light{0.12f, 0.25f, 0.05f};
  bool lobed = false;  ///< wavy outline, as an oak's
};

/// Leaves around a centre, alpha outside; transparent texels carry the mean leaf colour, so that
/// filtering leaves no dark fringes.
Image paint_leaf_cluster(std::uint32_t seed, const LeafStyle& style);
/// A conifer's frond growing from the image's bottom edge to its top.
Image paint_needle_frond(std::uint32_t seed, const LeafStyle& style);
/// Grass blades growing from the bottom edge.
Image paint_grass(std::uint32_t seed, const LeafStyle& style);
/// Vertical ridges and cracks; tiles in both directions.
Image paint_bark(std::uint32_t seed, glm::vec3 ridge, glm::vec3 crack);
/// White with dark horizontal lenticels; tiles.
Image paint_birch_bark(std::uint32_t seed);
/// Mottled detail around white, to multiply with vertex colours; tiles.
Image paint_mottle(std::uint32_t seed, float contrast, float frequency);
/// Floor boards along u; tiles.
Image paint_planks(std::uint32_t seed, int boards);
/// An abstract landscape for a picture frame.
Image paint_picture(std::uint32_t seed);
/// A screen with a few windows and lines of text.
Image paint_screen(std::uint32_t seed);

}  // namespace mirage::builtin
