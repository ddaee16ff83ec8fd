#include "server/tile/tile_job.h"

namespace mirage {
namespace {
constexpr std::size_t kTexelBytes = 9;  // of a page: colour (4), depth code (1), surface (4)
}

std::size_t pixel_bytes(const EncodeJob& job) {
  if (const auto* rendered = std::get_if<RenderedTile>(&job)) {
    const std::size_t edge = tile_edge(rendered->job.key.size_class);
    return kTexelBytes * edge * edge;
  }
  const auto of_frame = [](const SceneFrame& frame) {
    return frame.rgba.size() + 4 * (frame.depth.size() + frame.ids.size());
  };
  if (const auto* view = std::get_if<RenderedView>(&job)) return of_frame(view->frame);
  if (const auto* full = std::get_if<RenderedReference>(&job)) return of_frame(full->frame);
  return 0;  // made from a form that is kept anyway
}

}  // namespace mirage
