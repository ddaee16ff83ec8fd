#include "client/frame/draw_list.h"

#include <algorithm>

#include "protocol/impostor/tile_key.h"
#include "protocol/impostor/view_tile.h"

namespace mirage {

bool DrawnView::shows(std::uint32_t id) const {
  const std::vector<std::uint32_t>& ids = tile->instances;
  const auto at = std::lower_bound(ids.begin(), ids.end(), id);
  return at != ids.end() && *at == id && owners[static_cast<std::size_t>(at - ids.begin())];
}

}  // namespace mirage
