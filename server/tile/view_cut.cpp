#include "server/tile/view_cut.h"

#include <algorithm>
#include <map>

#include "protocol/base/limits.h"

namespace mirage {
namespace {

/// The nearest surface of a cell.
struct Cell {
  float depth = 0;       ///< eye depth, m; 0: sky
  std::uint32_t id = 0;  ///< instance + 1; 0: sky
};

std::vector<Cell> nearest_surfaces(const ViewTile& view, const SceneFrame& frame) {
  std::vector<Cell> cells(std::size_t{view.columns()} * view.rows());
  for (std::uint32_t y = 0; y < view.rows() * kViewCellTexels; ++y) {
    for (std::uint32_t x = 0; x < view.columns() * kViewCellTexels; ++x) {
      const std::size_t at = std::size_t{y} * view.camera.width + x;
      const float depth = frame.depth[at];
      Cell& cell = cells[std::size_t{y / kViewCellTexels} * view.columns() + x / kViewCellTexels];
      if (depth > 0 && (cell.depth == 0 || depth < cell.depth)) cell = {depth, frame.ids[at]};
    }
  }
  return cells;
}

/// Returns the instances with the most cells, up to the number that a view can tell apart; ids
/// rising.
std::vector<std::uint32_t> owners_of(const std::vector<Cell>& cells) {
  std::map<std::uint32_t, std::size_t> counts;
  for (const Cell& cell : cells) {
    if (cell.id > 0) ++counts[cell.id - 1];
  }
  std::vector<std::pair<std::size_t, std::uint32_t>> most;
  for (const auto& [id, count] : counts) most.emplace_back(count, id);
  std::sort(most.rbegin(), most.rend());
  most.resize(std::min(most.size(), limits::kMaxViewInstances));
  std::vector<std::uint32_t> out;
  for (const auto& [count, id] : most) out.push_back(id);
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace

ViewTile cut_view(const Camera& camera, const SceneFrame& frame) {
  ViewTile view;
  view.camera = camera;
  view.rgba = frame.rgba;
  const std::vector<Cell> cells = nearest_surfaces(view, frame);
  float nearest = 0, farthest = 0;
  for (const Cell& cell : cells) {
    if (cell.depth == 0) continue;
    nearest = nearest == 0 ? cell.depth : std::min(nearest, cell.depth);
    farthest = std::max(farthest, cell.depth);
  }
  if (nearest > 0) {
    view.near_m = double{nearest};
    view.far_m = double{farthest};
  }
  view.instances = owners_of(cells);
  for (const Cell& cell : cells) {
    view.depth.push_back(cell.depth > 0 ? view.encode_depth(double{cell.depth}) : 0);
    const auto at = std::lower_bound(view.instances.begin(), view.instances.end(), cell.id - 1);
    const bool listed = cell.id > 0 && at != view.instances.end() && *at == cell.id - 1;
    view.owners.push_back(cell.id == 0 ? std::uint16_t{0}
                          : listed ? static_cast<std::uint16_t>(1 + (at - view.instances.begin()))
                                   : ViewTile::kNobody);
  }
  return view;
}

}  // namespace mirage
