#pragma once
#include <memory>

#include "protocol/base/result.h"
#include "server/render/gpu_scene.h"
#include "server/render/reference_renderer.h"
#include "server/render/scene_shadow.h"
#include "server/render/tile_page.h"

namespace mirage {

struct RenderOptions;

/// Everything the GL thread owns; made and destroyed on it.
struct GlWorld {
  std::unique_ptr<GpuScene> scene;
  std::unique_ptr<SceneShadow> shadow;  ///< none without --shadows
  std::unique_ptr<TilePageRenderer> pages;
  std::unique_ptr<ReferenceRenderer> references;

  std::size_t scene_bytes() const {
    return scene->gpu_bytes() + (shadow ? shadow->gpu_bytes() : 0);
  }
};

/// Uploads the scene and compiles every shader. Errors kGraphicsShader, kGraphicsGl (also: over the
/// budget).
Result<GlWorld> make_world(std::shared_ptr<const PreparedScene> scene,
                           const RenderOptions& options);

}  // namespace mirage
