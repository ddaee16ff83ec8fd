#pragma once
// Ground map: the ground as far as the client knows it. Not thread-safe.

#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <vector>

#include "protocol/model/ground.h"

namespace mirage {

class GroundMap {
 public:
  /// Forgets all, for a scene walked by this body.
  void reset(const WalkBody& body);
  const WalkBody& body() const { return body_; }

  /// Adds a block. The one added longest ago is dropped when there are too many.
  void add(GroundBlock block);
  /// True if the ground at this place of the world is known, with or without floors.
  bool knows(double x, double z) const { return find(block_of(x, z)) != nullptr; }
  /// Returns the blocks within a block's edge of the place that are not known, nearest first.
  std::vector<GroundBlockId> missing_around(double x, double z) const;

  /// Returns the height of the highest floor at a place that is not above `most_m`; nullopt: none,
  /// or the place is not known.
  std::optional<double> floor_below(double x, double z, double most_m) const;
  /// Returns the height of the floor at a place that is nearest to `height_m` and within a step of
  /// it; nullopt as above.
  std::optional<double> floor_near(double x, double z, double height_m) const;
  /// Returns the height between the floors of the four nearest cells, for eyes that glide. A cell
  /// without a floor within a step of `height_m` counts as `height_m`.
  double smooth_height(double x, double z, double height_m) const;

 private:
  struct Known {
    GroundBlock block;
    std::vector<std::uint32_t> first;  ///< by cell: index of its lowest floor
  };
  GroundBlockId block_of(double x, double z) const;
  const Known* find(GroundBlockId id) const;
  /// Calls `visit` with the height of each floor of the cell at a place, lowest first.
  template <typename Visit>
  void each_floor(double x, double z, const Visit& visit) const;

  WalkBody body_;
  std::map<GroundBlockId, Known> blocks_;
  std::vector<GroundBlockId> order_;  ///< oldest first
};

}  // namespace mirage
