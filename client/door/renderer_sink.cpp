#include "client/door/renderer_sink.h"

#include <utility>

#include "client/draw/frame_renderer.h"

namespace mirage {
namespace {

template <typename... Args>
void time(std::function<void(Args...)>& of, const std::function<double()>& now_ms, double& ms) {
  of = [inner = std::move(of), now_ms, &ms](Args... args) {
    const double began = now_ms();
    inner(std::forward<Args>(args)...);
    ms += now_ms() - began;
  };
}

}  // namespace

TileSink timed(TileSink sink, std::function<double()> now_ms, double& ms) {
  time(sink.tile, now_ms, ms);
  time(sink.shadow, now_ms, ms);
  time(sink.mesh, now_ms, ms);
  time(sink.image, now_ms, ms);
  time(sink.scene, now_ms, ms);
  time(sink.view, now_ms, ms);
  return sink;
}

TileSink renderer_sink(FrameRenderer& renderer, SinkHooks hooks) {
  const auto say = [failed = std::move(hooks.failed)](const Result<void>& done) {
    if (!done) failed(done.error());
  };
  const auto scene = std::move(hooks.scene);
  const auto changed = std::move(hooks.changed);
  TileSink sink;
  sink.tile = [&renderer, say, changed](const TileRecord& record, const AtlasPlanes& planes) {
    changed();
    say(renderer.upload(record, planes));
  };
  sink.shadow = [&renderer, say, changed](const ShadowRecord& record,
                                          const std::vector<std::uint8_t>& plane) {
    changed();
    say(renderer.upload_shadow(record, plane));
  };
  sink.mesh = [&renderer, say, changed](std::uint32_t object, std::uint8_t lod, ObjectModel model) {
    changed();
    say(renderer.add_mesh(object, lod, std::move(model)));
  };
  sink.image = [&renderer, changed](std::uint32_t index, const Image& image,
                                    const std::vector<Image>& mips) {
    changed();
    renderer.add_image(index, image, mips);
  };
  // No picture changes here: what a frame draws is never dropped.
  sink.drop = [&renderer, scene](const AssetId& id) { renderer.drop(scene(), id); };
  sink.view = [&renderer, changed](const ViewTile& view) {
    changed();
    renderer.upload_view(view);
  };
  sink.scene = [&renderer, say, changed](const SceneView& now) {
    changed();
    say(renderer.reset(now));
  };
  return sink;
}

}  // namespace mirage
