#pragma once
// Proof that leaving out changes nothing, and what it saves (numerics.md section 5): every object's
// tiles are drawn twice, FULL and LEAN, compared byte by byte and timed in turns.
//
// FULL is the same server without need analysis: one mesh shader with every feature, absent maps
// read as neutral textures and materials as they were imported; every light that was set, black or
// out of reach; blending on; one kind of tile with all channels (shaded colour, normal, material,
// depth in 24 bits) and its whole window. What is no rule of
// leaving out is the same for both: geometry and its levels, samples, the depth written ahead for
// alpha tests, codec, measuring of the tile. LEAN is what the product does.

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
  int objects_per_class = 3;  ///< of objects that have the same left out
  int supersample = 2;
  std::string device = "auto";
  std::function<void(const std::string&)> progress;  ///< a line to show
};

/// What one rule leaves out of one object, and what came of drawing it both ways. Without an object
/// it is a whole object, or scene, by all rules at once.
struct ProofRow {
  std::string object;
  NeedRule rule = NeedRule::kBlending;
  std::string left_out, why;
  std::size_t tiles = 0;                 ///< compared
  std::size_t differing_components = 0;  ///< of colour in 8 bits, in floats, and of depth
  /// Per tile, medians of alternating runs: drawing, reading back, cutting, measuring, encoding.
  /// With a software rasteriser processor time, on all cores together.
  double full_ms = 0, lean_ms = 0;
  double full_bytes = 0, lean_bytes = 0;  ///< per tile, mean
  double full_bytes_lit = 0;              ///< of whole rows: FULL without normals and material
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
  std::vector<DroppedFigure> dropped;  ///< what rules that are not kept would save on LEAN's tiles
};

/// Needs a scene that kept what it came with. Errors kGraphics*.
Result<Proof> prove_needs(std::shared_ptr<const PreparedScene> scene, const ProofOptions& options);

}  // namespace mirage
