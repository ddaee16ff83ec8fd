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

/// The objects that the GL thread owns; made and destroyed on it.
struct GlWorld {
  std::unique_ptr<GpuScene> scene;
  std::unique_ptr<SceneShadow> shadow;  ///< null without --shadows
  std::unique_ptr<TilePageRenderer> pages;
  std::unique_ptr<ReferenceRenderer> references;

  GlWorld();
  GlWorld(GlWorld&& other) noexcept;
  GlWorld& operator=(GlWorld&& other) noexcept;
  ~GlWorld();
  /// Returns the graphics memory in bytes that is in use whatever is drawn.
  std::size_t scene_bytes() const;
};

/// Uploads the scene and compiles every shader. Errors kGraphicsShader, kGraphicsGl (also: over the
/// memory budget).
Result<GlWorld> make_world(std::shared_ptr<const PreparedScene> scene,
                           const RenderOptions& options);

}  // namespace mirage
