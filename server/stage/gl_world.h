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
  /// Leaves the memory that the scene does not take to pages. Error kGraphicsGl: the scene takes
  /// more than there is.
  Result<void> share_memory(const RenderOptions& options);
  /// Uploads the scene's levels of detail. Errors as make_world().
  Result<void> upload_levels(const RenderOptions& options);
};

/// Uploads the scene and compiles every shader. Errors kGraphicsShader, kGraphicsGl (also: over the
/// memory budget).
Result<GlWorld> make_world(std::shared_ptr<const PreparedScene> scene,
                           const RenderOptions& options);

}  // namespace mirage
