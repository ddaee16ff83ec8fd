#pragma once
// Procedurally drawn images. Colours given are linear; images are sRGB.

#include <cstdint>
#include <glm/glm.hpp>

#include "protocol/model/model.h"

namespace mirage::builtin {

/// Returns the sRGB byte of a linear component, clamped.
std::uint8_t srgb_byte(float linear);

struct LeafStyle {
  int count = 12;
  float length = 0.3f;  ///< relative to the image's side
  float width = 0.3f;   ///< relative to the leaf's length
  glm::vec3 dark{0.03f, 0.09f, 0.02f};
  glm::vec3 light{0.12f, 0.25f, 0.05f};
  bool lobed = false;  ///< wavy outline, like an oak's
};

/// Paints leaves around a centre, with alpha outside. Transparent texels carry the mean leaf
/// colour, so filtering leaves no dark fringes.
Image paint_leaf_cluster(std::uint32_t seed, const LeafStyle& style);
/// Paints a conifer's frond that grows from the image's bottom edge to its top.
Image paint_needle_frond(std::uint32_t seed, const LeafStyle& style);
/// Paints grass blades that grow from the bottom edge.
Image paint_grass(std::uint32_t seed, const LeafStyle& style);
/// Paints vertical ridges and cracks; tiles in both directions.
Image paint_bark(std::uint32_t seed, glm::vec3 ridge, glm::vec3 crack);
/// Paints white bark with dark horizontal lenticels; tiles.
Image paint_birch_bark(std::uint32_t seed);
/// Paints mottled detail around white, to multiply with vertex colours; tiles.
Image paint_mottle(std::uint32_t seed, float contrast, float frequency);
/// Paints floor boards along u; tiles.
Image paint_planks(std::uint32_t seed, int boards);
/// Paints an abstract landscape for a picture frame.
Image paint_picture(std::uint32_t seed);
/// Paints a screen with a few windows and lines of text.
Image paint_screen(std::uint32_t seed);

}  // namespace mirage::builtin
