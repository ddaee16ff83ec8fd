#include "server/stage/gl_world.h"

#include <string>

#include "server/render/gpu_scene.h"
#include "server/render/reference_renderer.h"
#include "server/render/scene_shadow.h"
#include "server/render/tile_page.h"
#include "server/stage/render_options.h"
#include "shaders/gl/health.h"

namespace mirage {

GlWorld::GlWorld() = default;
GlWorld::GlWorld(GlWorld&& other) noexcept = default;
GlWorld& GlWorld::operator=(GlWorld&& other) noexcept = default;
GlWorld::~GlWorld() = default;

std::size_t GlWorld::scene_bytes() const {
  return scene->gpu_bytes() + (shadow ? shadow->gpu_bytes() : 0);
}

Result<void> GlWorld::share_memory(const RenderOptions& options) {
  const std::size_t budget = options.gpu_mb << 20, taken = scene_bytes();
  if (taken > budget) {
    return make_error(ErrorId::kGraphicsGl,
                      "the scene takes " + std::to_string(taken >> 20) +
                          " MB of graphics memory, more than " + std::to_string(options.gpu_mb),
                      "--gpu-mb takes more");
  }
  pages->limit(budget - taken, options.ring);
  return {};
}

Result<void> GlWorld::upload_levels(const RenderOptions& options) {
  scene->upload_levels();
  if (Result<void> enough = share_memory(options); !enough) return enough;
  if (Result<void> compiled = pages->warm_up_levels(); !compiled) return compiled;
  return gl::check_health("uploading levels of detail");
}

Result<GlWorld> make_world(std::shared_ptr<const PreparedScene> scene,
                           const RenderOptions& options) {
  GlWorld world;
  world.scene = std::make_unique<GpuScene>(std::move(scene));
  if (options.shadows) {
    Result<SceneShadow> shadow = SceneShadow::create(*world.scene);
    if (!shadow) return shadow.error();
    world.shadow = std::make_unique<SceneShadow>(shadow.take());
  }
  Result<TilePageRenderer> pages =
      TilePageRenderer::create(*world.scene, options.supersample, world.shadow.get());
  if (!pages) return pages.error();
  world.pages = std::make_unique<TilePageRenderer>(pages.take());
  if (Result<void> enough = world.share_memory(options); !enough) return enough.error();
  if (Result<void> warm = world.pages->warm_up(options.page_edge); !warm) return warm.error();
  Result<ReferenceRenderer> references =
      ReferenceRenderer::create(*world.scene, world.shadow.get());
  if (!references) return references.error();
  world.references = std::make_unique<ReferenceRenderer>(references.take());
  if (Result<void> warm = world.references->warm_up(); !warm) return warm.error();
  if (const GLenum error = glGetError(); error != GL_NO_ERROR) {
    return make_error(ErrorId::kGraphicsGl, "GL error " + std::to_string(error) + " at start");
  }
  return world;
}

}  // namespace mirage
