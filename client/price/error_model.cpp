#include "client/price/error_model.h"

#include <algorithm>
#include <cmath>

namespace mirage {
namespace {

double& at(Wrongs& wrongs, Wrong kind) { return wrongs[static_cast<std::size_t>(kind)]; }

double capped(double px) { return px >= 0 && px < kWorstPx ? px : px < 0 ? 0 : kWorstPx; }

// By hand, of forest and clutter drawn in one way at a time (held-out models at 320x180: a tile
// .06, alpha-tested geometry with four samples .10; a placeholder half of the picture's .55); not
// fitted yet.
ErrorModel by_hand() {
  ErrorModel m;
  at(m.flip, Wrong::kMesh) = 0.03;
  at(m.flip, Wrong::kMeshAlias) = 0.02;
  at(m.flip, Wrong::kTested) = 0.06;
  at(m.flip, Wrong::kTestedAlias) = 0.02;
  at(m.flip, Wrong::kMeshError) = 0.02;
  at(m.flip, Wrong::kTile) = 0.06;
  at(m.flip, Wrong::kTileAlias) = 0.01;
  at(m.flip, Wrong::kTileError) = 0.02;
  at(m.flip, Wrong::kTileBlur) = 0.04;
  at(m.flip, Wrong::kView) = 0.1;
  at(m.flip, Wrong::kViewError) = 0.02;
  at(m.flip, Wrong::kNothing) = 0.4;
  at(m.flip, Wrong::kUpscaled) = 0.1;
  return m;
}

}  // namespace

const char* wrong_name(Wrong kind) {
  switch (kind) {
    case Wrong::kMesh:
      return "mesh";
    case Wrong::kMeshAlias:
      return "mesh_alias";
    case Wrong::kTested:
      return "tested";
    case Wrong::kTestedAlias:
      return "tested_alias";
    case Wrong::kMeshError:
      return "mesh_error";
    case Wrong::kTile:
      return "tile";
    case Wrong::kTestedTile:
      return "tested_tile";
    case Wrong::kTileAlias:
      return "tile_alias";
    case Wrong::kTileError:
      return "tile_error";
    case Wrong::kTileBlur:
      return "tile_blur";
    case Wrong::kView:
      return "view";
    case Wrong::kViewError:
      return "view_error";
    case Wrong::kNothing:
      return "nothing";
    case Wrong::kUpscaled:
      return "upscaled";
    case Wrong::kCount:
      break;
  }
  return "";
}

Wrongs mesh_wrongs(bool alpha_tested, double error_px, int samples, double scale) {
  Wrongs out{};
  at(out, alpha_tested ? Wrong::kTested : Wrong::kMesh) = 1;
  if (samples <= 1) at(out, alpha_tested ? Wrong::kTestedAlias : Wrong::kMeshAlias) = 1;
  at(out, Wrong::kMeshError) = capped(error_px);
  at(out, Wrong::kUpscaled) = 1 / scale - 1;
  return out;
}

Wrongs tile_wrongs(bool alpha_tested, double error_px, double texel_px, int samples, double scale) {
  Wrongs out{};
  at(out, Wrong::kTile) = 1;
  if (alpha_tested) at(out, Wrong::kTestedTile) = 1;
  if (samples <= 1) at(out, Wrong::kTileAlias) = 1;
  at(out, Wrong::kTileError) = capped(error_px);
  // The coarser of both is what blurs.
  at(out, Wrong::kTileBlur) = capped(texel_px - 1 / scale);
  at(out, Wrong::kUpscaled) = 1 / scale - 1;
  return out;
}

Wrongs view_wrongs(double error_px) {
  Wrongs out{};
  at(out, Wrong::kView) = 1;
  at(out, Wrong::kViewError) = capped(error_px);
  return out;
}

Wrongs nothing_wrongs() {
  Wrongs out{};
  at(out, Wrong::kNothing) = 1;
  return out;
}

double ErrorModel::flip_of(const Wrongs& wrongs) const {
  double sum = 0;
  for (std::size_t i = 0; i < kWrongs; ++i) sum += flip[i] * wrongs[i];
  return std::min(sum, 1.0);
}

const ErrorModel& error_model() {
  static const ErrorModel kModel = by_hand();
  return kModel;
}

}  // namespace mirage
