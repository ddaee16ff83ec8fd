#pragma once
// What a visible thing may be drawn as, and what was decided: handed from the selector to the frame
// plan and back.

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "client/price/error_model.h"

namespace mirage {

/// A way to draw a thing, from the cheapest to the dearest.
enum class Look : std::uint8_t {
  kNothing,  ///< a placeholder
  kView,     ///< its part of the view tile
  kFlat,     ///< a tile on a flat proxy
  kDeep,     ///< a tile by marching its depth
  kMesh      ///< geometry
};
const char* look_name(Look look);

/// What a visible thing may be drawn as. Errors in px; a way that is not there is nullopt.
struct Alternatives {
  struct Tile {
    double error_px = 0, texel_px = 0;
    double share = 1;  ///< of the thing's area
  };
  /// A level of its geometry that is here.
  struct Level {
    std::uint8_t lod = 0;
    std::uint32_t triangles = 0;
    double error_px = 0;  ///< lod_excess at tau 1
  };
  std::uint32_t instance = 0;
  std::uint32_t object = 0;  ///< whose geometry it is drawn from
  double area_px = 0;        ///< of its disc, as far as it is in view (shown_area_px)
  bool alpha_tested = false;
  bool mesh_only = false;  ///< it is what one stands in, or no picture can stand for it
  std::vector<Level> levels;
  std::optional<Tile> flat, deep;
  bool viewed = false;          ///< the view tile shows it
  std::optional<Look> shown;    ///< in the last frame; nullopt: it was not in it
  std::optional<Look> leaving;  ///< still drawn beneath, while what is shown fades in over it
};

/// How a thing is drawn.
struct Choice {
  Look look = Look::kNothing;
  std::uint8_t lod = 0;  ///< of geometry
  bool fades = true;     ///< what was there goes on beneath; false: there is no time for it
  Wrongs wrongs{};       ///< what its error is made of
  double error = 0;      ///< FLIP times px
  double ms = 0;         ///< without what it fades in over
};

}  // namespace mirage
