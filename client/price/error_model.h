#pragma once
// How wrong what is drawn looks: FLIP a pixel (0 to 1) of what an object may be drawn as, from what
// is known before it is drawn. A linear model, so that it can be fitted.

#include <array>
#include <cstddef>
#include <cstdint>

namespace mirage {

enum class Wrong : std::uint8_t {
  kMesh,         ///< opaque geometry: 1
  kMeshAlias,    ///< the same with one sample a pixel: 1
  kTested,       ///< geometry with an alpha test: 1
  kTestedAlias,  ///< the same with one sample a pixel: 1
  kMeshError,    ///< px by which a level of geometry is off (lod_excess at tau 1)
  kTile,         ///< an impostor: 1
  kTestedTile,   ///< of an object with an alpha test: 1, beside kTile
  kTileAlias,    ///< the same with one sample a pixel: 1
  kTileError,    ///< px of TileFit::error_px
  kTileBlur,     ///< px by which a texel covers more than a pixel
  kView,         ///< shown from the view tile: 1
  kViewError,    ///< px of ViewFit::error_px
  kNothing,      ///< a placeholder: 1
  kUpscaled,     ///< px of the shown picture that a drawn pixel covers, less 1
  kCount
};
inline constexpr std::size_t kWrongs = static_cast<std::size_t>(Wrong::kCount);
const char* wrong_name(Wrong kind);

/// What an error of one drawn thing is made of.
using Wrongs = std::array<double, kWrongs>;

/// `samples` of a pixel, >= 1; `scale` of the drawn picture, over the shown one. Errors in px of
/// the shown picture; what is larger than kWorstPx counts as that.
inline constexpr double kWorstPx = 8;
Wrongs mesh_wrongs(bool alpha_tested, double error_px, int samples, double scale = 1);
Wrongs tile_wrongs(bool alpha_tested, double error_px, double texel_px, int samples,
                   double scale = 1);
Wrongs view_wrongs(double error_px);
Wrongs nothing_wrongs();

struct ErrorModel {
  Wrongs flip{};  ///< of one of each, >= 0
  double flip_of(const Wrongs& wrongs) const;
};
/// error_model.cpp says where its numbers are from.
const ErrorModel& error_model();

}  // namespace mirage
