#pragma once
// Ground: where somebody who walks may stand. The world's xz plane is divided into square blocks of
// square cells; a cell has the heights of the floors one can stand on.

#include <cstdint>
#include <vector>

namespace mirage {

inline constexpr int kGroundCells = 64;  ///< of a block, each way
inline constexpr std::size_t kMostFloors = std::size_t{kGroundCells} * kGroundCells * 8;

/// The body of somebody who walks. All its lengths follow the height of the eye, so that scenes in
/// any unit are walked alike.
struct WalkBody {
  double eye_m = 0;  ///< height of the eye over the ground; 0: nobody walks on the ground here

  bool walks() const { return eye_m > 0; }
  double cell_m() const { return eye_m / 7; }
  double block_m() const { return kGroundCells * cell_m(); }
  double radius_m() const { return 0.12 * eye_m; }  ///< free space around it
  double height_m() const { return 1.1 * eye_m; }   ///< free space over the floor
  double climb_m() const { return 0.25 * eye_m; }   ///< highest step, up and down
};

/// Number of a block: it begins at this many times its edge, in world space.
struct GroundBlockId {
  std::int32_t x = 0, z = 0;
  friend bool operator<(const GroundBlockId& a, const GroundBlockId& b) {
    return a.x != b.x ? a.x < b.x : a.z < b.z;
  }
  friend bool operator==(const GroundBlockId& a, const GroundBlockId& b) {
    return a.x == b.x && a.z == b.z;
  }
};

/// Floors of a block. The floor of code c is at the height base_m + c * step_m, world space.
struct GroundBlock {
  GroundBlockId id;
  double base_m = 0;
  double step_m = 0;
  /// Number of floors, cell by cell, x first. kGroundCells squared.
  std::vector<std::uint8_t> counts;
  std::vector<std::uint16_t> floors;  ///< codes, cell by cell, lowest first
};

}  // namespace mirage
