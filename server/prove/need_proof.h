#pragma once
// Proof that leaving out changes nothing, and a measurement of what it saves (numerics.md section
// 5). Every object's tiles are drawn twice, FULL and LEAN, compared byte by byte, and timed in
// turns.
//
// FULL is the same server without need analysis. It has one mesh shader with every feature; absent
// maps are neutral textures, and materials are as imported. All lights count, even black or distant
// ones, and blending is on. There is one kind of tile with all channels (shaded colour, normal,
// material, depth in 24 bits) and its whole window.
//
// LEAN is the product. Everything that is not a rule of leaving out is the same for both: geometry
// and its levels, samples, the depth prepass of alpha tests, codec, measuring of the tile.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "protocol/base/result.h"
#include "protocol/model/need_rules.h"
#include "server/prove/tile_census.h"

namespace mirage {

struct PreparedScene;

struct ProofOptions {
  int cells = 26;             ///< view cells, 1 to 26: faces, edges and corners of a cube
  int objects_per_class = 3;  ///< for each class of objects with the same content left out
  int supersample = 2;
  std::string device = "auto";
  std::function<void(const std::string&)> progress;  ///< receives progress lines
};

/// The result of one rule on one object, drawn both ways. In Proof::objects and Proof::total, a row
/// covers all rules of an object or of the scene.
struct ProofRow {
  std::string object;
  NeedRule rule = NeedRule::kBlending;
  std::string left_out, why;
  std::size_t tiles = 0;                 ///< number of tiles compared
  std::size_t differing_components = 0;  ///< of colour in 8 bits, of colour in floats, and of depth
  /// Per tile, medians of alternating runs: drawing, reading back, cutting, measuring, encoding. A
  /// software rasteriser is timed in processor time, over all cores.
  double full_ms = 0, lean_ms = 0;
  double full_bytes = 0, lean_bytes = 0;  ///< per tile, mean
  double full_bytes_lit = 0;              ///< for whole rows: FULL without normals and material
  double saved_ms() const { return full_ms - lean_ms; }
  double saved_bytes() const { return full_bytes - lean_bytes; }
};

struct Proof {
  std::string renderer;
  std::vector<std::uint32_t> edges;   ///< of the tiles
  std::vector<std::string> lighting;  ///< states
  std::vector<ProofRow> rows;         ///< by object and rule
  std::vector<ProofRow> objects;      ///< by object, all rules
  ProofRow total;
  std::vector<DroppedFigure> dropped;  ///< savings that dropped rules would have on LEAN's tiles
};

/// Runs the proof. Needs a scene that kept its imported content. Errors kGraphics*.
Result<Proof> prove_needs(std::shared_ptr<const PreparedScene> scene, const ProofOptions& options);

}  // namespace mirage
