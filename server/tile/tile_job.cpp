#include "server/tile/tile_job.h"

namespace mirage {
namespace {
constexpr std::size_t kTexelBytes = 9;  // of a page: colour, a depth code, a surface
}

std::size_t pixel_bytes(const EncodeJob& job) {
  if (const auto* rendered = std::get_if<RenderedTile>(&job)) {
    const std::size_t edge = tile_edge(rendered->job.key.size_class);
    return kTexelBytes * edge * edge;
  }
  if (const auto* view = std::get_if<RenderedView>(&job)) {
    return view->frame.rgba.size() + 4 * (view->frame.depth.size() + view->frame.ids.size());
  }
  return 0;  // what is made from what is kept
}

}  // namespace mirage
