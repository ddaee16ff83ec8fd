#pragma once
// Error model: how wrong an object will look, as FLIP a pixel (0 to 1), for each way of drawing it.
// It uses only what is known before drawing. It is linear, so that it can be fitted.

#include <array>
#include <cstddef>
#include <cstdint>

namespace mirage {

enum class Wrong : std::uint8_t {
  kMesh,         ///< geometry: 1
  kMeshEdge,     ///< geometry: edge_share()
  kTested,       ///< geometry with an alpha test: 1, beside kMesh
  kMeshAlias,    ///< opaque geometry with one sample a pixel: 1
  kTestedAlias,  ///< geometry with an alpha test and one sample a pixel: 1
  kMeshError,    ///< geometry: root of the px over 1 that its level is off by
  kTile,         ///< an impostor: 1
  kTileEdge,     ///< an impostor: edge_share()
  kTestedTile,   ///< an impostor of an object with an alpha test: 1, beside kTile
  kTileAlias,    ///< an impostor with one sample a pixel: 1
  kTileError,    ///< an impostor: root of TileFit::error_px
  kTileBlur,     ///< an impostor: root of the px over 1 that a texel covers
  kView,         ///< shown from the view tile: 1
  kViewEdge,     ///< shown from the view tile: edge_share()
  kNothing,      ///< a placeholder: 1
  kNothingEdge,  ///< a placeholder: edge_share()
  kUpscaled,     ///< px of the shown picture that a drawn pixel covers, less 1
  kCount
};
inline constexpr std::size_t kWrongs = static_cast<std::size_t>(Wrong::kCount);
const char* wrong_name(Wrong kind);

/// The error of one drawn thing, as an amount of each kind.
using Wrongs = std::array<double, kWrongs>;

/// Returns the share of a thing's pixels that are at its outline, where most differences show: 1 /
/// sqrt(area_px), at most 1.
double edge_share(double area_px);

/// Errors in px of the shown picture that are larger count as this.
inline constexpr double kWorstPx = 8;
/// Return the error of a thing drawn as geometry, from a tile, from the view tile, or as a
/// placeholder. `area_px` is its area on the shown picture; `samples` of a pixel is >= 1; `scale`
/// is the edge of the drawn picture over that of the shown one.
Wrongs mesh_wrongs(double area_px, bool alpha_tested, double error_px, int samples,
                   double scale = 1);
Wrongs tile_wrongs(double area_px, bool alpha_tested, double error_px, double texel_px, int samples,
                   double scale = 1);
Wrongs view_wrongs(double area_px);
Wrongs nothing_wrongs(double area_px);

struct ErrorModel {
  Wrongs flip{};  ///< FLIP for one unit of each kind, >= 0
  double flip_of(const Wrongs& wrongs) const;
};
/// Returns the fitted model; error_model.cpp says where its numbers come from.
const ErrorModel& error_model();

}  // namespace mirage
