#include "client/price/error_model.h"

#include <algorithm>
#include <cmath>

namespace mirage {
namespace {

double& at(Wrongs& wrongs, Wrong kind) { return wrongs[static_cast<std::size_t>(kind)]; }

double capped(double px) { return px >= 0 && px < kWorstPx ? px : px < 0 ? 0 : kWorstPx; }

struct Coefficient {
  Wrong kind;
  double flip;
};
// Fitted by `mirage-report calibrate` of 2026-11-24 to 10,538 objects of forest and clutter, drawn
// in ten ways; tested on 11,911 objects of city, museum and another forest. Levels that are off by
// more than a pixel were too few to fit, so their number is set by hand: slabs for leaves, with a
// FLIP of .14 over a view's .08.
constexpr Coefficient kCoefficients[] = {
    {Wrong::kMesh, 0.018},       {Wrong::kMeshEdge, 0.485},     {Wrong::kTested, 0.034},
    {Wrong::kMeshAlias, 0.0134}, {Wrong::kTestedAlias, 0.0264}, {Wrong::kMeshError, 0.04},
    {Wrong::kTile, 0.025},       {Wrong::kTileEdge, 0.535},     {Wrong::kTestedTile, 0.0086},
    {Wrong::kTileAlias, 0.0048}, {Wrong::kTileError, 0.0257},   {Wrong::kTileBlur, 0.0379},
    {Wrong::kView, 0.1115},      {Wrong::kViewEdge, 0.621},     {Wrong::kNothing, 0.23},
    {Wrong::kNothingEdge, 3.66}, {Wrong::kUpscaled, 0.0333}};

ErrorModel calibrated() {
  ErrorModel model;
  for (const Coefficient& c : kCoefficients) at(model.flip, c.kind) = c.flip;
  return model;
}

}  // namespace

const char* wrong_name(Wrong kind) {
  constexpr const char* kNames[kWrongs] = {
      "mesh", "mesh_edge", "tested",      "mesh_alias",   "tested_alias", "mesh_error",
      "tile", "tile_edge", "tested_tile", "tile_alias",   "tile_error",   "tile_blur",
      "view", "view_edge", "nothing",     "nothing_edge", "upscaled"};
  return kNames[static_cast<std::size_t>(kind)];
}

double edge_share(double area_px) { return area_px > 1 ? 1 / std::sqrt(area_px) : 1; }

Wrongs mesh_wrongs(double area_px, bool alpha_tested, double error_px, int samples, double scale) {
  Wrongs out{};
  at(out, Wrong::kMesh) = 1;
  at(out, Wrong::kMeshEdge) = edge_share(area_px);
  at(out, Wrong::kTested) = alpha_tested;
  if (samples <= 1) at(out, alpha_tested ? Wrong::kTestedAlias : Wrong::kMeshAlias) = 1;
  // An error within a pixel does not show.
  at(out, Wrong::kMeshError) = std::sqrt(capped(error_px - 1));
  at(out, Wrong::kUpscaled) = 1 / scale - 1;
  return out;
}

Wrongs tile_wrongs(double area_px, bool alpha_tested, double error_px, double texel_px, int samples,
                   double scale) {
  Wrongs out{};
  at(out, Wrong::kTile) = 1;
  at(out, Wrong::kTileEdge) = edge_share(area_px);
  at(out, Wrong::kTestedTile) = alpha_tested;
  at(out, Wrong::kTileAlias) = samples <= 1;
  at(out, Wrong::kTileError) = std::sqrt(capped(error_px));
  // The blur is that of a texel or that of an upscaled pixel, whichever is coarser.
  at(out, Wrong::kTileBlur) = std::sqrt(capped(texel_px - 1 / scale));
  at(out, Wrong::kUpscaled) = 1 / scale - 1;
  return out;
}

Wrongs view_wrongs(double area_px) {
  Wrongs out{};
  at(out, Wrong::kView) = 1;
  at(out, Wrong::kViewEdge) = edge_share(area_px);
  return out;
}

Wrongs nothing_wrongs(double area_px) {
  Wrongs out{};
  at(out, Wrong::kNothing) = 1;
  at(out, Wrong::kNothingEdge) = edge_share(area_px);
  return out;
}

double ErrorModel::flip_of(const Wrongs& wrongs) const {
  double sum = 0;
  for (std::size_t i = 0; i < kWrongs; ++i) sum += flip[i] * wrongs[i];
  return std::min(sum, 1.0);
}

const ErrorModel& error_model() {
  static const ErrorModel kModel = calibrated();
  return kModel;
}

}  // namespace mirage
