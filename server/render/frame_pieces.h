#pragma once
// The pieces of a picture of the whole scene. They are small enough that tiles can be drawn between
// two of them, and their order depends on the picture alone.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/render/row_band.h"
#include "server/tile/tile_job.h"

namespace mirage {

struct GpuScene;

/// Instances of one mesh, drawn together.
struct FramePiece {
  std::uint32_t object = 0;
  std::size_t level = 0;  ///< level of detail
  std::vector<std::uint32_t> instances;
  double work = 0;  ///< in samples shaded
};

class FramePieces {
 public:
  FramePieces(const GpuScene& scene, const SceneShot& shot);

  /// Returns the rows of a band for about `samples` of work. The work is raised to that of all
  /// triangles, which may have to be drawn again for each band.
  std::uint32_t rows_of_band(double samples) const;

  /// Returns the opaque surfaces that a band may show, by object, level and instance.
  std::vector<FramePiece> opaque(const RowBand& band) const;
  /// Returns the instances with blended surfaces that a band may show, each a piece, farthest
  /// first.
  std::vector<FramePiece> blended(const RowBand& band) const;

 private:
  struct Visible {
    std::uint32_t object = 0;
    std::size_t level = 0;
    std::uint32_t instance = 0;
    bool in_view = false;
    double distance = 0;       ///< of its centre, m
    double size_px = 0;        ///< radius
    double low = 0, high = 0;  ///< rows it may touch
  };
  Visible look_at(const SceneShot& shot, std::uint32_t instance, const Frustum& frustum) const;
  std::size_t level_of(const SceneShot& shot, const Visible& one) const;
  double work(const Visible& one, const RowBand& band) const;

  const GpuScene* scene_;
  double samples_a_pixel_, samples_a_row_;
  std::uint32_t rows_;
  std::vector<Visible> opaque_, blended_;
};

}  // namespace mirage
