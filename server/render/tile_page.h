#pragma once
// Renders a batch of tiles into one page. Each tile is drawn supersampled at the same place of a
// separate target, then filtered down to colour and depth code at its place in the page. GL thread
// only.
//
// The place must be the same because interpolation rounds by absolute position. Drawn elsewhere, a
// tile would differ in its last bits, and would no longer be a pure function of its key.

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
class TouchingDepth;

/// Extra output for proofs of need analysis (need_proof.h).
struct TileExtras {
  NeedMask forced = 0;       ///< MeshPass::force
  bool float_color = false;  ///< colour as 32-bit floats, linear
  bool fine_depth = false;   ///< 24-bit depth, red the highest byte; alpha is the 8-bit code
};

/// Returns the matrix to clip space from positions relative to the capture's eye.
glm::mat4 capture_projection(const Capture& capture);

class TilePageRenderer {
 public:
  TilePageRenderer(TilePageRenderer&& other) noexcept;
  TilePageRenderer& operator=(TilePageRenderer&& other) noexcept;
  ~TilePageRenderer();
  /// `supersample` is per axis, at least 3 for alpha-tested objects. `shadow`, which must outlive
  /// this object, is for shadow tiles; nullptr: none will be drawn. Error kGraphicsShader.
  static Result<TilePageRenderer> create(const GpuScene& scene, int supersample,
                                         SceneShadow* shadow = nullptr,
                                         const TileExtras& extras = {});

  /// Compiles every variant of the scene and draws every kind of tile of each look once, so that no
  /// client waits for a first use. Also makes the targets for pages of `page_edge` texels. Errors
  /// kGraphicsShader, kGraphicsGl.
  Result<void> warm_up(int page_edge);
  /// Compiles the variants of the uploaded levels of detail, as far as whole meshes have others.
  Result<void> warm_up_levels();

  /// Draws `jobs` at the packer's places. Returns the page, bound for reading and valid until the
  /// next call; the surface of relit tiles is its third attachment. nullptr: a target cannot be
  /// made, or would exceed the limit.
  const gl::RenderTarget* render(const std::vector<TileJob>& jobs, const PagePacker& packer);

  /// Begins a tile that is drawn in slices of about the given work, in samples shaded. Pages of
  /// other tiles may be drawn in between. False as render().
  bool begin_slow(const TileJob& job, double slice_samples);
  /// Draws a slice and waits for it. Returns the tile's pixels once they are complete. One must be
  /// under way.
  std::shared_ptr<const PagePixels> draw_slow_slice();
  void drop_slow() { slow_.reset(); }

  /// True if a page of these tiles uses its third attachment: PageTexels::surface.
  bool writes_surface(const std::vector<TileJob>& jobs) const;

  /// Limits the graphics memory, bytes, of targets plus `ring` pages in read-back. Without this
  /// call there is no limit.
  void limit(std::size_t bytes, std::size_t ring) {
    most_bytes_ = bytes;
    ring_ = ring;
  }
  /// Bytes of graphics memory that the render targets hold.
  std::size_t gpu_bytes() const;

  /// Returns the names of the mesh shader's variants compiled so far, for lit and for relit tiles.
  std::vector<std::string> variants() const;

 private:
  TilePageRenderer(const GpuScene& scene, int supersample);
  /// Programs for `supersample` and for the samples of fine tiles. The number is a constant in the
  /// shader, because a software renderer is slow at loops of unknown length.
  struct Resolve {
    gl::Program usual, fine;
  };
  /// The passes, programs and targets of one kind of tile.
  struct Path {
    std::unique_ptr<gl::MeshPass> meshes;
    std::unique_ptr<gl::MeshPass> ranges;  ///< of blended surfaces; null: none are drawn
    Resolve resolve;
    gl::RenderTarget supersampled;
    gl::RenderTarget page;
  };
  /// A tile drawn slice by slice. Its rows are drawn at their place in the tile, because
  /// interpolation rounds by position, and averaged at the bottom of `page`.
  struct Slow {
    TileJob job;
    int slice_rows = 0;  ///< texels
    int done_rows = 0;
    gl::RenderTarget page;
    std::shared_ptr<PagePixels> pixels;
  };
  Path& path_of(const TileJob& job);
  std::vector<GLenum> page_formats(const Path& path) const;
  /// Returns the number of triangles that the tile is drawn from.
  double triangles(const TileJob& job) const;
  /// The object as its capture sees it: in its own space, or for a shadow tile in the world.
  struct Stage {
    glm::mat4 clip_from_relative{1};  ///< from positions relative to the eye
    glm::dvec3 eye{0};
    gl::LightBlock lights;
    Similarity placed;  ///< placement of the object in the space of `eye`
  };
  Stage stage(const TileJob& job, const Capture& capture) const;
  /// Returns a tile of these channels of an instance's object, to draw once; nullopt if the object
  /// has none.
  std::optional<TileJob> first_job(std::uint32_t instance, std::uint8_t channels) const;
  /// True if the tile gets more samples: its object has alpha tests, and it is not too large.
  bool fine(const TileJob& job) const;
  /// True for a lit tile of an object with blended surfaces; such a tile also stores what lies
  /// behind them.
  bool blended(const TileJob& job) const;
  /// Samples per axis.
  int samples(const TileJob& job) const;
  int fine_samples() const;
  /// Makes the target in which tiles with an edge of `big` samples are drawn.
  bool prepare_drawn(Path& path, int big, int page_edge);
  /// Makes the targets of a path. `supersampled_edge`: edge of the largest tile, in samples.
  bool prepare_targets(Path& path, int page_edge, int supersampled_edge);
  /// Makes the extra targets that layered tiles need.
  bool prepare_layers(int supersampled_edge, int page_edge);
  /// Makes the target that tiles of objects which touch others need, if there are such objects.
  bool prepare_touching(int big, int page_edge);
  /// Replaces a target; false, leaving it unchanged, if the new one would exceed the limit.
  bool remake(gl::RenderTarget& target, int edge, const std::vector<GLenum>& colors, GLenum depth,
              int page_edge) const;
  Capture capture_of(const TileJob& job) const;
  /// Draws rows of a tile, in texels.
  void draw_tile(const TileJob& job, const RowBand& rows);
  /// Draws the depth of the ground that hides a part of the group's members, and no colour.
  void draw_ground(const TileJob& job, const Stage& at, const Capture& capture);
  /// Draws the layer behind the front of the tile on its target.
  void draw_behind(const TileJob& job, const RowBand& rows, const Stage& at,
                   const gl::GpuMesh& mesh, const gl::MeshInstance& instance);
  /// Draws the nearest and farthest depth of the blended surfaces of the tile on the target.
  void draw_ranges(const TileJob& job, const Stage& at, const gl::GpuMesh& mesh,
                   const gl::MeshInstance& instance);
  /// Returns what touches the object of the tile; nullptr: nothing, or the tile stores no depth.
  const Touching* touching(const TileJob& job) const;
  /// Pushes the depths of the tile on the target clear of what touches its object.
  void keep_clear(const TileJob& job, const RowBand& rows, const Stage& at, const Capture& capture);
  struct GroupBatch {
    const gl::GpuMesh* mesh;
    std::vector<gl::MeshInstance> members;
  };
  /// Returns the members of a group, by mesh, as seen from `eye` in the world. Members are never
  /// blended.
  std::vector<GroupBatch> group_batches(const InstanceGroup& group, const Capture& capture,
                                        const glm::dvec3& eye) const;
  const gl::GpuMesh& mesh_of(const TileJob& job, const Capture& capture) const;
  /// Resolves a tile into `page`, which has the channels of relit tiles or, for a lit tile, at
  /// least its own.
  void resolve(const TileJob& job, const gl::RenderTarget& page, PagePacker::Place place);

  const GpuScene* scene_;
  int supersample_;
  SceneShadow* shadow_map_ = nullptr;
  TileExtras extras_;
  Path lit_;
  Path relit_;   ///< its page has the surface as third attachment; made at first use
  Path shadow_;  ///< has no page of its own
  std::unique_ptr<TileLayers> layers_;       ///< for layered tiles; null: the scene has none
  std::unique_ptr<TouchingDepth> touching_;  ///< null: no objects touch
  Resolve caster_;                           ///< drawn by the lit path; it keeps only depth
  gl::VertexArray empty_vao_;
  std::size_t most_bytes_ = SIZE_MAX;
  std::size_t ring_ = 0;        ///< pages in read-back at a time
  std::unique_ptr<Slow> slow_;  ///< null: none under way
};

}  // namespace mirage
