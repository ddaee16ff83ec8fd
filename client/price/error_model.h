#pragma once
// How wrong what is drawn looks: FLIP a pixel (0 to 1) of what an object may be drawn as, from what
// is known before it is drawn. A linear model, so that it can be fitted.

#include <array>
#include <cstddef>
#include <cstdint>

namespace mirage {

enum class Wrong : std::uint8_t {
  kMesh,         ///< geometry: 1
  kMeshEdge,     ///< the same: edge_share()
  kTested,       ///< of geometry, with an alpha test: 1
  kMeshAlias,    ///< opaque geometry with one sample a pixel: 1
  kTestedAlias,  ///< geometry with an alpha test and one sample a pixel: 1
  kMeshError,    ///< geometry: root of the px over 1 by which its level is off (lod_excess)
  kTile,         ///< an impostor: 1
  kTileEdge,     ///< the same: edge_share()
  kTestedTile,   ///< of an object with an alpha test: 1, beside kTile
  kTileAlias,    ///< an impostor with one sample a pixel: 1
  kTileError,    ///< root of TileFit::error_px
  kTileBlur,     ///< root of the px by which a texel covers more than a pixel
  kView,         ///< shown from the view tile: 1
  kViewEdge,     ///< the same: edge_share()
  kNothing,      ///< a placeholder: 1
  kNothingEdge,  ///< the same: edge_share()
  kUpscaled,     ///< px of the shown picture that a drawn pixel covers, less 1
  kCount
};
inline constexpr std::size_t kWrongs = static_cast<std::size_t>(Wrong::kCount);
const char* wrong_name(Wrong kind);

/// What an error of one drawn thing is made of.
using Wrongs = std::array<double, kWrongs>;

/// Of a thing's pixels those at its outline, where most is seen to differ: 1 / sqrt(area_px), at
/// most 1.
double edge_share(double area_px);

/// `area_px` of the thing on the shown picture; `samples` of a pixel, >= 1; `scale` of the drawn
/// picture, over the shown one. Errors in px of the shown picture; what is larger than kWorstPx
/// counts as that.
inline constexpr double kWorstPx = 8;
Wrongs mesh_wrongs(double area_px, bool alpha_tested, double error_px, int samples,
                   double scale = 1);
Wrongs tile_wrongs(double area_px, bool alpha_tested, double error_px, double texel_px, int samples,
                   double scale = 1);
Wrongs view_wrongs(double area_px);
Wrongs nothing_wrongs(double area_px);

struct ErrorModel {
  Wrongs flip{};  ///< of one of each, >= 0
  double flip_of(const Wrongs& wrongs) const;
};
/// error_model.cpp says where its numbers are from.
const ErrorModel& error_model();

}  // namespace mirage
