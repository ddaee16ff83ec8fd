#pragma once
// Frame renderer: draws sky, geometry and impostors with the true camera.
// Input:  the draw list of a frame; pixels and meshes that arrive.
// Output: the picture, in the frame target.
// Thread: the GL thread (the frame loop's).
// Full:   an upload without room in graphics memory fails with kGraphicsGl.

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "client/draw/gpu_bytes.h"
#include "client/frame/method_choice.h"
#include "protocol/base/result.h"

namespace mirage {

struct AssetId;
struct AtlasPlanes;
struct Camera;
class FrameTarget;
struct Image;
struct ObjectModel;
struct PlannedFrame;
class SceneView;
struct Tints;
struct ViewTile;

class FrameRenderer {
 public:
  FrameRenderer(FrameRenderer&& other) noexcept;
  FrameRenderer& operator=(FrameRenderer&& other) noexcept;
  ~FrameRenderer();
  /// Creates the renderer. `flat` as in ImpostorPass::create.
  static Result<FrameRenderer> create(int atlas_edge, int atlas_layers,
                                      const std::set<DrawMethod>& flat = kAutoFlatMethods);

  /// Learns a new scene. Error kGraphicsShader: the scene is drawn without its fog.
  Result<void> reset(const SceneView& scene);
  /// Both uploads fail with kGraphicsGl if no graphics memory is left. `plane` as in
  /// ShadowAtlas::upload().
  Result<void> upload(const TileRecord& record, const AtlasPlanes& planes);
  Result<void> upload_shadow(const ShadowRecord& record, const std::vector<std::uint8_t>& plane);
  void upload_view(const ViewTile& view);
  /// Adds a level of geometry. Error kGraphicsShader: it cannot be drawn as it should.
  Result<void> add_mesh(std::uint32_t object, std::uint8_t lod, ObjectModel model);
  /// Adds a level of an image with its mip levels; none: the driver makes them.
  void add_image(std::uint32_t index, const Image& image, const std::vector<Image>& mips);
  void drop(const SceneView& scene, const AssetId& id);

  void draw(const FrameTarget& target, const PlannedFrame& frame);

  /// Draws the frame into the bound framebuffer, which has the camera's size, a colour without a
  /// curve and a float depth: each thing in its tint where the picture shows it. `camera` is the
  /// frame's, at the size of that framebuffer. Error kGraphicsShader.
  Result<void> draw_tints(const Camera& camera, const PlannedFrame& frame, const Tints& tints);

  /// Reads textures `levels` mip levels sharper from now on, those of alpha tests `tested_levels`.
  void sharpen(float levels, float tested_levels);
  void sharpen_as_usual();
  /// ImpostorPass::draw_edges_last()
  void draw_edges_last(bool on);

  /// Draws nothing behind the objects from now on, or again: the picture is premultiplied there.
  void show_background(bool shown);
  /// Draws this colour, linear, in place of the scene's sky and studio from now on; the shadow on
  /// the studio's floor stays. nullopt: the scene's own.
  void set_background(const std::optional<glm::vec3>& color);

  /// Returns the draw calls of the last frame.
  int draw_calls() const;
  GpuBytes gpu_bytes() const;

 private:
  struct Parts;
  explicit FrameRenderer(std::unique_ptr<Parts> parts);

  std::unique_ptr<Parts> parts_;
};

}  // namespace mirage
