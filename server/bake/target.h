#pragma once
// Targets of a bake: for each consumer (an engine's plug-in, or our own shader) the facts about
// what it reads. The exporter (export.h) is driven by these facts and by nothing else.

#include <glm/glm.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/base/result.h"
#include "server/bake/lattice.h"

namespace mirage {

/// The content of one channel of a file. n: the normal, in the consumer's axes; e: the same along a
/// frame's right, up and toward; s / r: BakeMaster::depth.
enum class MapChannel : std::uint8_t {
  kRed,  ///< colour, as TargetFacts::premultiplied says
  kGreen,
  kBlue,
  kCoverage,    ///< 0 to 1
  kInnerField,  ///< inner_field of the texels with half coverage or more
  kSignedField,
  kNormalX,  ///< n.x * .5 + .5
  kNormalY,
  kNormalZ,
  kViewRight,  ///< e.x * .5 + .5
  kViewLeft,   ///< .5 - e.x * .5
  kViewUp,
  kViewToward,
  kDepthNear,  ///< .5 + s / 2r: what is near is white
  kDepthFar,   ///< .5 - s / 2r: what is near is black
  kOcclusion,
  kRoughness,
  kMetallic,
  kHalf,  ///< .5 everywhere
};

/// A file of a target. `file` names it; the word NAME in it stands for the object's.
struct TargetMap {
  std::string_view map;  ///< color, normal, depth or orm
  std::string_view file;
  std::vector<MapChannel> channels;
  bool srgb = false;        ///< the sRGB curve is applied to red, green and blue
  bool on_request = false;  ///< written only if the choice names it
};

/// Order of a consumer's frames among those of a capture with `grid` frames a side.
enum class FrameOrder : std::uint8_t {
  kSame,         ///< its frame (i, j) is the capture's
  kMirrorJ,      ///< (i, grid - 1 - j)
  kQuarterTurn,  ///< (grid - 1 - j, i)
};
glm::ivec2 captured_frame(FrameOrder order, int grid, int i, int j);

enum class Framing : std::uint8_t {
  kSphere,       ///< frames span the bounding sphere
  kLongestEdge,  ///< the edge of a frame is the longest edge of the bounding box / .72
};

/// Other files that a target has, written by engine_texts.h.
enum class EngineText : std::uint8_t { kNone, kThree, kGodot3, kGodot4, kUnity, kUnreal };

/// A case that a consumer cannot show, or not well.
struct TargetRule {
  enum class When : std::uint8_t {
    kOddGrid,
    kGridAbove,            ///< grid > number
    kGridBelow,            ///< grid < number
    kNoPowerOfTwo,         ///< grid * tile is none
    kGridNotPowerPlusOne,  ///< grid - 1 is no power of two
    kOctahedral,
  };
  When when;
  int number = 0;
  bool refused = false;  ///< an error; otherwise a warning
  std::string_view reason{};
};

/// Filling reaches as far as the frame does.
constexpr int kWholeFrame = 1 << 20;

struct TargetFacts {
  std::string_view name{};
  std::string_view consumer{};  ///< whose files these are
  std::string_view source{};    ///< repository, empty for our own
  std::string_view commit{};    ///< the layout was checked against this one
  std::vector<BakeLayout> layouts{};
  int grid = 16, tile = 128;  ///< the consumer's usual ones
  RollRule roll{};            ///< the capture needs this one
  Framing framing = Framing::kSphere;
  int margin = 0;  ///< texels between the sphere and the edge of a frame: filters reach over it
  FrameOrder hemi_order = FrameOrder::kSame;
  bool rows_from_bottom = false;   ///< frame row 0 is the lowest in the file
  bool tiles_upside_down = false;  ///< inside each frame, the lowest row comes first
  glm::dmat3 axes{1};              ///< consumer's axes from glTF's; lengths stay
  double units_per_meter = 1;
  bool premultiplied = false;
  int color_fill = 0;      ///< texels around the object that take its nearest colour
  int geometry_fill = 0;   ///< the same for normal, depth and orm
  float field_reach = 0;   ///< texels, of alpha_field.h
  int cleared_border = 0;  ///< texels at the edge of each frame without coverage
  std::vector<TargetMap> maps{};
  bool packed = false;  ///< one boimp_file.h in place of the maps
  EngineText texts = EngineText::kNone;
  std::vector<TargetRule> rules{};
};

const std::vector<TargetFacts>& bake_targets();
/// Returns the target of a name, or null.
const TargetFacts* target_of(std::string_view name);

/// Returns what the consumer does badly with such a bake, a sentence each. Error kUsage: it has no
/// such layout, or shows nothing useful.
Result<std::vector<std::string>> check_target(const TargetFacts& target, BakeLayout layout,
                                              int grid, int tile);

/// Returns the radius (half the edge) of the target's frames. `sphere`: radius of the bounding
/// sphere; `box`: size of the bounding box; `tile`: texels a side of a frame.
double framed_radius(const TargetFacts& target, double sphere, const glm::dvec3& box, int tile);

/// True if both rules give each frame the same roll: one capture serves both.
bool rolled_alike(const RollRule& a, const RollRule& b, BakeLayout layout, int grid);

}  // namespace mirage
