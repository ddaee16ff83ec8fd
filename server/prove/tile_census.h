#pragma once
// Counts what dropped rules of need analysis would find on the drawn tiles. Every proof measures
// their figures anew.

#include <map>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "protocol/model/need_rules.h"

namespace mirage {

struct Material;
struct ObjectDescription;
struct SceneObject;
struct TileCost;
struct TileJob;
struct TileShot;

/// The saving that a dropped rule would have here.
struct DroppedFigure {
  NeedRule rule = NeedRule::kMaskBits;
  std::string measured;
  double saved_bytes = 0;  ///< per tile, mean; 0 if it is not in bytes
};

class TileCensus {
 public:
  /// Adds a lit tile as the server makes it with its encoding cost; the first of each key counts.
  void add(const TileShot& shot, const TileJob& job, const ObjectDescription& object,
           const TileCost& cost);
  void add_object(const SceneObject& object, const std::vector<Material>& materials);
  std::vector<DroppedFigure> figures() const;

 private:
  std::size_t tiles_ = 0;  ///< not empty
  std::size_t opaque_ = 0, two_alphas_ = 0, gray_ = 0, solid_ = 0, twins_ = 0;
  std::size_t texels_ = 0, outside_octagon_ = 0, flat_ = 0;
  std::size_t objects_ = 0, double_sided_solids_ = 0;
  double bytes_ = 0, mask_bytes_ = 0, alpha_bytes_ = 0, depth_bytes_ = 0;
  double draw_ms_ = 0, encode_ms_ = 0;
  std::set<std::tuple<std::uint32_t, std::uint64_t>> pictures_;  ///< object, content
  /// Object, cell, size, light. Lighting states that do not differ in light reaching the object
  /// share a key.
  std::set<std::tuple<std::uint32_t, std::uint32_t, std::uint8_t, std::uint64_t>> keys_;
};

}  // namespace mirage
