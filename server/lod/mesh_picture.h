#pragma once
// An orthographic picture of a mesh, made without a GPU: normals, base colours, and the grain of
// anisotropic surfaces.

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "protocol/model/model.h"

namespace mirage {

/// The placement shared by pictures that are compared.
struct PictureFrame {
  glm::vec3 center{0};
  float extent = 0;         ///< width and height of a picture, object units; 0: nothing is visible
  std::uint32_t edge = 32;  ///< of a picture, px; a power of two
};
/// Returns a frame around the vertices in use, with a resolution that fits the number of triangles.
PictureFrame frame_around(const Mesh& mesh);

inline constexpr std::uint32_t kCoarsestEdge = 8;  ///< px of the smallest halved() picture

/// The part of a picture that is kept: a mesh that fits into its frame from all sides covers about
/// a third of it. Its corners are multiples of edge / kCoarsestEdge, so that it can be halved.
struct PictureWindow {
  std::uint32_t x = 0, y = 0, width = 0, height = 0;  ///< px
  std::size_t pixels() const { return std::size_t{width} * height; }
};

struct PicturePixel {
  glm::vec3 normal{0};  ///< unit, towards the viewer
  float cover = 0;      ///< covered share; the other members are sums over it
  glm::vec3 color{0};   ///< base colour, square root of linear
  float near = 0;       ///< while drawing: larger is nearer
};

struct MeshPicture {
  PictureWindow window;
  std::vector<PicturePixel> pixels;
  std::vector<glm::vec3> grain;  ///< tangents, unit or zero; empty: nothing is drawn along them
};

/// Returns the window that shows the whole mesh under a rotation.
PictureWindow window_around(const Mesh& mesh, const PictureFrame& frame, const glm::mat3& rotation);

/// Draws the triangles of a mesh into the window of `out`; its memory is used again. `with_grain`
/// fills MeshPicture::grain.
void draw_picture(const Mesh& mesh, const std::vector<Material>& materials,
                  const std::vector<Image>& images, const PictureFrame& frame,
                  const glm::mat3& rotation, bool with_grain, MeshPicture& out);

/// Sets `out` to means of 2 x 2 pixels.
void halve(const MeshPicture& in, MeshPicture& out);

}  // namespace mirage
