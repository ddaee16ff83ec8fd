#pragma once
// The shading of a mesh from all sides. A coarser mesh must look like it, besides having its
// surfaces in the right place.

#include <array>
#include <vector>

#include "protocol/model/model.h"
#include "server/base/workers.h"

namespace mirage {

/// Six orthographic pictures of a mesh, made without a GPU: normals, base colours, and the grain of
/// anisotropic surfaces.
class MeshPictures {
 public:
  /// The placement shared by pictures that are compared.
  struct Frame {
    glm::vec3 center{0};
    float extent = 0;         ///< width and height of a picture, object units
    std::uint32_t edge = 32;  ///< of a picture, px; a power of two
  };
  /// Returns a frame around the vertices in use, with a resolution that fits the number of
  /// triangles. Extent 0: nothing is visible.
  static Frame frame_around(const Mesh& mesh);

  /// Draws triangles only, because lines and points are the same in every level.
  MeshPictures(const Mesh& mesh, const std::vector<Material>& materials,
               const std::vector<Image>& images, const Frame& frame, const Workers& workers);

  const Frame& frame() const { return frame_; }

  struct Pixel {
    glm::vec3 normal{0};  ///< unit, towards the viewer
    glm::vec3 color{0};   ///< base colour, square root of linear
    glm::vec3 grain{0};   ///< tangent, unit; zero if nothing is drawn along it
    float cover = 0;      ///< covered share; the other members are sums over it
  };
  using Picture = std::vector<Pixel>;
  static constexpr std::size_t kSides = 6;
  const std::array<Picture, kSides>& sides() const { return sides_; }

 private:
  Frame frame_;
  std::array<Picture, kSides> sides_;
};

/// Root mean square difference of normals, grain (half weight) and colours up to which two pictures
/// count as equal.
inline constexpr double kSameShading = 0.03;

/// Returns the smallest pixel size, object units, at which both look the same within kSameShading;
/// 0 if they do at the resolution of the pictures. Larger pixels show means of their content. Both
/// must have the same frame.
float shading_size(const MeshPictures& full, const MeshPictures& level);

}  // namespace mirage
