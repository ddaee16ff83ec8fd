#pragma once
// Renders a batch of tiles into one page: each supersampled at the same place of a target of its
// own, then filtered down to colour and depth code at its place in the page. GL thread only.
//
// The same place, because interpolation rounds by absolute position: drawn elsewhere, a tile
// differs in its last bits, and would no longer be a pure function of its key.

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "server/prepare/grouping.h"
#include "server/render/page_packer.h"
#include "server/render/row_band.h"
#include "server/tile/tile_job.h"
#include "shaders/gl/mesh_pass.h"
#include "shaders/gl/program.h"
#include "shaders/gl/render_target.h"

namespace mirage {

struct GpuScene;
class SceneShadow;
class TileLayers;

/// What a proof of need analysis draws beside what the product draws (need_proof.h).
struct TileExtras {
  NeedMask forced = 0;       ///< MeshPass::force
  bool float_color = false;  ///< colour as 32-bit floats, linear
  bool fine_depth = false;   ///< depth in 24 bits: red is the highest byte; alpha is the 8-bit code
};

/// Clip space from positions relative to the capture's eye.
glm::mat4 capture_projection(const Capture& capture);

class TilePageRenderer {
 public:
  TilePageRenderer(TilePageRenderer&& other) noexcept;
  TilePageRenderer& operator=(TilePageRenderer&& other) noexcept;
  ~TilePageRenderer();
  /// `supersample` per axis, at least 3 for alpha-tested objects. `shadow`, which must live as
  /// long, is for shadow tiles; nullptr: none will be asked for. Error kGraphicsShader.
  static Result<TilePageRenderer> create(const GpuScene& scene, int supersample,
                                         SceneShadow* shadow = nullptr,
                                         const TileExtras& extras = {});

  /// Compiles every variant of the scene and draws every kind of tile of each look once, so that no
  /// client pays for a first use; makes the targets for pages of `page_edge` texels. Errors
  /// kGraphicsShader, kGraphicsGl.
  Result<void> warm_up(int page_edge);

  /// Draws `jobs` at `places`; the result is the bound-for-reading target, valid until the next
  /// call; the surface of relit tiles is its third attachment. nullptr when the target cannot be
  /// made, or would be over the limit.
  const gl::RenderTarget* render(const std::vector<TileJob>& jobs, const PagePacker& packer);

  /// A tile to draw a slice of about so much work, in samples shaded, at a time: pages of others
  /// may be drawn between two. False as render().
  bool begin_slow(const TileJob& job, double slice_samples);
  /// Draws a slice and waits for it. The tile's pixels, once they are whole. One must be under way.
  std::shared_ptr<const PagePixels> draw_slow_slice();
  void drop_slow() { slow_.reset(); }

  /// Whether a page of these has a third attachment worth reading: PageTexels::surface.
  bool writes_surface(const std::vector<TileJob>& jobs) const;

  /// Targets, and `ring` pages on their way back, may take this many bytes of graphics memory;
  /// without this call, any number.
  void limit(std::size_t bytes, std::size_t ring) {
    most_bytes_ = bytes;
    ring_ = ring;
  }
  /// Of targets.
  std::size_t gpu_bytes() const;

  /// Names of the mesh shader's variants compiled so far, of lit and of relit tiles.
  std::vector<std::string> variants() const;

 private:
  TilePageRenderer(const GpuScene& scene, int supersample);
  /// For `supersample`, and for the samples of fine tiles: a constant in the shader, as a software
  /// renderer runs loops of unknown length slowly.
  struct Resolve {
    gl::Program usual, fine;
  };
  /// What one kind of tile is drawn with.
  struct Path {
    std::unique_ptr<gl::MeshPass> meshes;
    std::unique_ptr<gl::MeshPass> ranges;  ///< of blended surfaces; null: none are drawn
    Resolve resolve;
    gl::RenderTarget supersampled;
    gl::RenderTarget page;
  };
  /// A tile that is drawn a slice at a time. Its rows are drawn where they are in the tile, since
  /// interpolation rounds by position, and averaged at the foot of `page`.
  struct Slow {
    TileJob job;
    int slice_rows = 0;  ///< texels
    int done_rows = 0;
    gl::RenderTarget page;
    std::shared_ptr<PagePixels> pixels;
  };
  Path& path_of(const TileJob& job);
  std::vector<GLenum> page_formats(const Path& path) const;
  /// Triangles that the tile is drawn of.
  double triangles(const TileJob& job) const;
  /// The object on a target bound for it, as the capture sees it: in its own space, or for a shadow
  /// tile in the world.
  struct Stage {
    glm::mat4 clip_from_relative{1};  ///< of positions relative to the eye
    glm::dvec3 eye{0};
    gl::LightBlock lights;
    Similarity placed;  ///< of the object in the space of `eye`
  };
  Stage stage(const TileJob& job, const Capture& capture) const;
  /// Objects with alpha tests get more samples than the rest.
  /// A tile of these channels of an instance's object, to draw once; nothing where it has none.
  std::optional<TileJob> first_job(std::uint32_t instance, std::uint8_t channels) const;
  bool fine(const TileJob& job) const;
  /// A lit tile of an object that has blended surfaces: it tells what lies behind them.
  bool blended(const TileJob& job) const;
  /// Per axis.
  int samples(const TileJob& job) const;
  int fine_samples() const;
  /// What tiles of an edge of `big` samples are drawn to.
  bool prepare_drawn(Path& path, int big, int page_edge);
  /// `supersampled_edge` of the largest tile, in samples.
  bool prepare_targets(Path& path, int page_edge, int supersampled_edge);
  /// The same of what layered tiles take besides.
  bool prepare_layers(int supersampled_edge, int page_edge);
  /// Replaces a target unless that is over the limit; it then stays as it was.
  bool remake(gl::RenderTarget& target, int edge, const std::vector<GLenum>& colors, GLenum depth,
              int page_edge) const;
  Capture capture_of(const TileJob& job) const;
  /// Rows of it, in texels.
  void draw_tile(const TileJob& job, const RowBand& rows);
  /// What lies behind the front of the tile that is on its target.
  void draw_behind(const TileJob& job, const RowBand& rows, const Stage& at,
                   const gl::GpuMesh& mesh, const gl::MeshInstance& instance);
  /// Nearest and farthest depth of the blended surfaces that the tile on the target shows.
  void draw_ranges(const TileJob& job, const Stage& at, const gl::GpuMesh& mesh,
                   const gl::MeshInstance& instance);
  struct GroupBatch {
    const gl::GpuMesh* mesh;
    std::vector<gl::MeshInstance> members;
  };
  /// Of a group, none of whose members is blended, seen from `eye` in the world.
  std::vector<GroupBatch> group_batches(const InstanceGroup& group, const Capture& capture,
                                        const glm::dvec3& eye) const;
  const gl::GpuMesh& mesh_of(const TileJob& job, const Capture& capture) const;
  /// Into `page`, which has the channels of relit tiles or, for a lit tile, at least its own.
  void resolve(const TileJob& job, const gl::RenderTarget& page, PagePacker::Place place);

  const GpuScene* scene_;
  int supersample_;
  SceneShadow* shadow_map_ = nullptr;
  TileExtras extras_;
  Path lit_;
  Path relit_;   ///< its page has the surface as a third attachment; made when first needed
  Path shadow_;  ///< without a page of its own
  std::unique_ptr<TileLayers> layers_;  ///< of layered tiles; null: the scene has none
  Resolve caster_;                      ///< the lit path's, but for what is kept
  gl::VertexArray empty_vao_;
  std::size_t most_bytes_ = SIZE_MAX;
  std::size_t ring_ = 0;        ///< pages of it at a time
  std::unique_ptr<Slow> slow_;  ///< null: none is under way
};

}  // namespace mirage
