#include "server/bake/bake_fit.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>

namespace mirage {
namespace {

constexpr int kSizes[] = {256, 384, 512, 768, 1024, 1536, 2048, 3072, 4096};
// Once there is depth, texels are worth more than directions; without, directions are.
constexpr std::array<int, 3> kDepthGrids = {8, 12, 16}, kBlendGrids = {16, 12, 8};
constexpr int kSmallestTile = 16;
// A size whose first grid is this far below is left for the next one. Of the last sizes all grids
// are tried: some objects need directions.
constexpr double kFarDb = 1;
constexpr int kLastSizes = 3072;
// Above what was asked for, because other directions may be worse.
constexpr double kReserveDb = 0.3;
constexpr int kDirections = 6, kPicture = 512;

bool takes(const TargetFacts& target, BakeLayout layout, int grid, int tile) {
  const Result<std::vector<std::string>> checked = check_target(target, layout, grid, tile);
  return checked.ok() && checked->empty();
}

}  // namespace

BakeMethod method_of(const TargetFacts& target) {
  return target.name == "generic" ? BakeMethod::kDepth : BakeMethod::kBlend;
}

Result<FittedBake> fit_bake(BakeRenderer& renderer, const BakeSubject& subject,
                            const TargetFacts& target, const BakeShot& shot, double error_db,
                            const Workers& workers,
                            const std::function<void(const std::string&)>& told) {
  ErrorEffort effort;
  effort.directions = kDirections;
  effort.edge = kPicture;
  effort.methods = {method_of(target)};
  const auto& grids = method_of(target) == BakeMethod::kDepth ? kDepthGrids : kBlendGrids;
  FittedBake best;
  best.psnr_db = -1;
  for (const int size : kSizes) {
    for (const int grid : grids) {
      const int tile = size / grid;
      if (tile < kSmallestTile || !takes(target, shot.layout, grid, tile)) continue;
      BakeShot tried = shot;
      tried.grid = grid;
      tried.tile = tile;
      tried.radius = framed_radius(target, subject.radius, subject.extent, tile);
      const Result<BakeMaster> master = renderer.bake(subject, tried);
      if (!master) return master.error();
      const auto rows = measure_bake(renderer, subject, as_bytes(*master), effort, workers);
      if (!rows) return rows.error();
      const double psnr = rows->front().psnr_db.value_or(99);  // n/a: nothing differs
      told(fmt::format("{} x {} frames of {} px: {:.1f} dB", grid, grid, tile, psnr));
      if (psnr > best.psnr_db) best = {tried, psnr, false};
      if (psnr >= error_db + kReserveDb) return FittedBake{tried, psnr, true};
      if (size < kLastSizes && psnr < error_db - kFarDb) break;
    }
  }
  return best;
}

}  // namespace mirage
