#pragma once
// How a mesh is shaded, seen from around: what a coarser one must look like, not only where its
// surfaces must lie.

#include <array>
#include <vector>

#include "protocol/model/model.h"
#include "server/base/workers.h"

namespace mirage {

/// Six orthographic pictures of a mesh, of its normals, base colours and the grain of what is
/// anisotropic, made without a GPU.
class MeshPictures {
 public:
  /// What pictures that are compared have in common.
  struct Frame {
    glm::vec3 center{0};
    float extent = 0;         ///< width and height of a picture, object units
    std::uint32_t edge = 32;  ///< of a picture, pixels; a power of two
  };
  /// Around the vertices in use, as fine as the mesh has triangles to show. Extent 0: nothing to
  /// see.
  static Frame frame_around(const Mesh& mesh);

  /// Lines and points are left out, as they are the same in every level.
  MeshPictures(const Mesh& mesh, const std::vector<Material>& materials,
               const std::vector<Image>& images, const Frame& frame, const Workers& workers);

  const Frame& frame() const { return frame_; }

  struct Pixel {
    glm::vec3 normal{0};  ///< unit, towards the viewer
    glm::vec3 color{0};   ///< base colour, square root of linear
    glm::vec3 grain{0};   ///< the tangent, unit; zero where nothing is drawn along it
    float cover = 0;      ///< share that shows anything; the others are sums over it
  };
  using Picture = std::vector<Pixel>;
  static constexpr std::size_t kSides = 6;
  const std::array<Picture, kSides>& sides() const { return sides_; }

 private:
  Frame frame_;
  std::array<Picture, kSides> sides_;
};

/// Root of the mean squared difference of normals and grain (half) and colours that passes for
/// equal.
inline constexpr double kSameShading = 0.03;

/// Object units: the smallest pixels at which both look the same, within kSameShading; 0 when they
/// do at the pictures' own. Larger pixels show means of what lies in them. Both are of one frame.
float shading_size(const MeshPictures& full, const MeshPictures& level);

}  // namespace mirage
