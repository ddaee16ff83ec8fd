#pragma once
#include <memory>

#include "protocol/base/result.h"

namespace mirage {

struct GpuScene;
struct PreparedScene;
class ReferenceRenderer;
struct RenderOptions;
class SceneShadow;
class TilePageRenderer;

/// Everything the GL thread owns; made and destroyed on it.
struct GlWorld {
  std::unique_ptr<GpuScene> scene;
  std::unique_ptr<SceneShadow> shadow;  ///< none without --shadows
  std::unique_ptr<TilePageRenderer> pages;
  std::unique_ptr<ReferenceRenderer> references;

  GlWorld();
  GlWorld(GlWorld&& other) noexcept;
  GlWorld& operator=(GlWorld&& other) noexcept;
  ~GlWorld();
  /// Graphics memory that it takes whatever is drawn.
  std::size_t scene_bytes() const;
};

/// Uploads the scene and compiles every shader. Errors kGraphicsShader, kGraphicsGl (also: over the
/// budget).
Result<GlWorld> make_world(std::shared_ptr<const PreparedScene> scene,
                           const RenderOptions& options);

}  // namespace mirage
