#pragma once
// The shading of a mesh from all sides. A coarser mesh must look like it, besides having its
// surfaces in the right place.

#include <array>
#include <vector>

#include "server/base/workers.h"
#include "server/lod/mesh_picture.h"

namespace mirage {

/// Root mean square difference of normals, grain (half weight) and colours up to which two pictures
/// count as equal.
inline constexpr double kSameShading = 0.03;

/// Six pictures of a full mesh, which coarser meshes are compared with. It compares triangles only,
/// because lines and points are the same in every level.
class MeshShading {
 public:
  /// All of them must outlive it.
  MeshShading(const Mesh& full, const std::vector<Material>& materials,
              const std::vector<Image>& images, const Workers& workers);

  /// Returns the smallest pixel size, object units, at which `level` looks the same within
  /// kSameShading; 0 if it does at the resolution of the pictures. Larger pixels show means of
  /// their content. Levels come in order, finest first: none gets a smaller size than the one
  /// before, so finer pictures are not compared.
  float size_of(const Mesh& level);

 private:
  static constexpr std::size_t kSides = 6;
  struct Side {
    std::vector<MeshPicture> full;       ///< finest first; halved once a comparison needs it
    std::array<MeshPicture, 2> level{};  ///< the compared picture, and room for the next
  };
  /// Draws a mesh in the frame halved so often.
  void draw(const Mesh& mesh, std::size_t side, std::size_t halvings, MeshPicture& out) const;

  const std::vector<Material>& materials_;
  const std::vector<Image>& images_;
  const Workers& workers_;
  const PictureFrame frame_;
  const bool grained_;
  std::array<Side, kSides> sides_;
  std::size_t same_at_ = 0;  ///< halvings after which the level before looked the same
};

}  // namespace mirage
