#pragma once
// Alternatives: the ways in which a visible thing (instance, group or part) may be drawn, and the
// one that was chosen. The selector hands them to the frame plan, which hands back choices.

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "client/price/error_model.h"

namespace mirage {

/// A way to draw a thing, from the cheapest to the most expensive.
enum class Look : std::uint8_t {
  kNothing,  ///< a placeholder
  kView,     ///< its part of the view tile
  kFlat,     ///< a tile on a flat proxy
  kDeep,     ///< a tile drawn by marching its depth
  kMesh      ///< geometry
};
const char* look_name(Look look);

/// The ways in which one visible thing may be drawn. Errors are in px; an impossible way is
/// nullopt.
struct Alternatives {
  struct Tile {
    double error_px = 0, texel_px = 0;
    double share = 1;  ///< share of the thing's area that the tile covers
  };
  /// A resident level of its geometry.
  struct Level {
    std::uint8_t lod = 0;
    std::uint32_t triangles = 0;
    double error_px = 0;  ///< lod_excess() at a tau of 1 px
  };
  std::uint32_t instance = 0;
  std::uint32_t object = 0;  ///< object whose geometry it is drawn from
  double area_px = 0;        ///< area of its disc as far as it is in view (shown_area_px)
  bool alpha_tested = false;
  bool mesh_only = false;  ///< the eye is inside it, or no picture can stand for it
  std::vector<Level> levels;
  std::optional<Tile> flat, deep;
  bool viewed = false;          ///< the view tile shows it
  std::optional<Look> shown;    ///< way in the last frame; nullopt: it was not drawn
  std::optional<Look> leaving;  ///< way still drawn beneath while the new one fades in
};

/// The way that was chosen for a thing.
struct Choice {
  Look look = Look::kNothing;
  std::uint8_t lod = 0;  ///< level of geometry
  bool fades = true;     ///< the former way is drawn beneath; false: no time for that
  Wrongs wrongs{};       ///< amount of each kind of error
  double error = 0;      ///< FLIP times px
  double ms = 0;         ///< without what is drawn beneath a fade
};

}  // namespace mirage
