#pragma once
// How each consumer of a bake reads its files, written from their documentation and sources
// and from nothing of Mirage: where a frame lies, which way it looks, what its channels mean.
// A consumer's space: its own axes, lengths in radii from the centre.

#include <array>
#include <functional>
#include <glm/glm.hpp>
#include <map>
#include <string>
#include <vector>

namespace mirage::consumer {

/// A picture as a consumer loads it: bytes, the top row first.
struct Picture {
  int width = 0, height = 0, channels = 0;
  std::vector<std::uint8_t> bytes;

  /// Returns a texel's channels, 0 to 1.
  glm::dvec4 at(int x, int y) const;
};
/// One of each map: color, normal, depth, orm.
using Pictures = std::map<std::string, Picture>;

struct Axes {
  glm::dvec3 right, up;
};

/// A texel as the consumer's shader understands it.
struct Sample {
  bool covered = false;
  glm::dvec3 color{0};                   ///< linear, straight
  double height = 0;                     ///< toward the camera, in radii
  glm::dvec3 normal{0};                  ///< the consumer's axes; 0: it reads none
  double roughness = -1, metallic = -1;  ///< -1: it reads none
};

enum class Lattice { kHemi, kWhole, kRing };

struct Consumer {
  std::string name;
  glm::dmat3 gltf_from_own;               ///< axes
  bool hemi_swapped = false;              ///< H2 of the two hemisphere formulas, otherwise H1
  int right_axis, forward_axis, up_axis;  ///< of the formulas: first, second and upward
  std::function<Axes(const glm::dvec3&)> axes;
  bool row_0_at_bottom = false, tiles_upside_down = false;
  bool reads_depth = true;
  /// `raw`: the channels of each map at one texel.
  std::function<Sample(const std::map<std::string, glm::dvec4>& raw, const Axes&,
                       const glm::dvec3& toward)>
      decode;

  /// Returns the direction to the camera of frame (i, j), unit length, in the consumer's axes.
  glm::dvec3 direction(Lattice lattice, int grid, int i, int j) const;
  /// Returns the pixel of the file that shows texel (x, y) of a frame, y from its top.
  glm::ivec2 pixel(int grid, int tile, int i, int j, int x, int y) const;
  /// Returns where a direction lies in the lattice, 0 to grid - 1 each way.
  glm::dvec2 place(Lattice lattice, int grid, const glm::dvec3& direction) const;
};

struct Blend {
  std::array<glm::ivec2, 3> frame;
  std::array<double, 3> weight;
};
Blend blend(const glm::dvec2& place, int grid);

const std::vector<Consumer>& all();
const Consumer& named(const std::string& name);

}  // namespace mirage::consumer
