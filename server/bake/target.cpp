#include "server/bake/target.h"

#include <algorithm>

namespace mirage {
namespace {

using C = MapChannel;
using When = TargetRule::When;

const std::vector<BakeLayout> kHemiAndWhole{BakeLayout::kHemi, BakeLayout::kOctahedral};
const std::vector<BakeLayout> kAll{BakeLayout::kHemi, BakeLayout::kOctahedral, BakeLayout::kRing};

const std::vector<MapChannel> kColorCoverage{C::kRed, C::kGreen, C::kBlue, C::kCoverage};
const std::vector<MapChannel> kNormalDepth{C::kNormalX, C::kNormalY, C::kNormalZ, C::kDepthNear};

constexpr std::string_view kFold =
    "the diagonal along which its shader blends crosses the fold of the whole sphere, so frames "
    "of different places mix there; the layout hemi has no fold";
constexpr std::string_view kBelow =
    "the roll of its frames straight from below could not be checked";
constexpr std::string_view kNoPower =
    "the import rescales or keeps without mips a texture whose side is no power of two";

// Rows: the axes of the consumer in glTF's.
glm::dmat3 axes_of(const glm::dvec3& x, const glm::dvec3& y, const glm::dvec3& z) {
  return glm::transpose(glm::dmat3(x, y, z));
}

TargetFacts generic() {
  return {
      .name = "generic",
      .consumer = "Mirage's own shader, examples/three",
      .layouts = kAll,
      .margin = 2,
      .premultiplied = true,
      .geometry_fill = kWholeFrame,
      .maps = {{"color", "NAME.color.png", kColorCoverage, true},
               {"normal", "NAME.normal.png", kNormalDepth},
               {"depth", "NAME.depth.png", {C::kDepthNear}, false, true},
               {"orm", "NAME.orm.png", {C::kOcclusion, C::kRoughness, C::kMetallic}}},
  };
}

// Its frames near the pole are rolled as its shader rolls them, not as its own baker does.
TargetFacts three() {
  return {
      .name = "three",
      .consumer = "octahedral-impostor for three.js, WebGL",
      .source = "github.com/agargaro/octahedral-impostor",
      .commit = "ca0046a",
      .layouts = {BakeLayout::kHemi},
      .roll = {.999, {-1, 0, 0}},
      .margin = 2,
      .rows_from_bottom = true,
      .premultiplied = true,
      .geometry_fill = 16,
      .maps = {{"color", "NAME.albedo.png", kColorCoverage, true},
               {"normal",
                "NAME.normalDepth.png",
                {C::kViewRight, C::kViewUp, C::kViewToward, C::kDepthNear}}},
      .texts = EngineText::kThree,
  };
}

TargetFacts three_tsl() {
  return {
      .name = "three-tsl",
      .consumer = "octahedral-impostor-component for three.js, WebGPU",
      .source = "github.com/ektogamat/octahedral-impostor-component",
      .commit = "367c681",
      .layouts = kHemiAndWhole,
      .grid = 17,
      .tile = 240,
      .framing = Framing::kLongestEdge,
      .tiles_upside_down = true,
      .color_fill = 32,
      .maps = {{"color", "NAME.impostor.png", kColorCoverage, true}},
      .rules = {{When::kGridNotPowerPlusOne, 0, false,
                 "its gridSize is 8, 16 or 32, one less than the frames a side"},
                {When::kOctahedral, 0, false, kFold},
                {When::kOctahedral, 0, false, kBelow}},
  };
}

// The frames of both follow the shader's rule for the pole, but the shader turns normals by the
// view's tangent, which knows no such rule.
TargetFacts godot(std::string_view name) {
  constexpr std::string_view kNormals =
      "frames within 2.6 degrees of the pole are rolled, and its shader does not roll their "
      "normals with them; even grids up to 24 have no such frames";
  TargetFacts facts{
      .name = name,
      .layouts = kHemiAndWhole,
      .roll = {.999, {0, 0, 1}},
      .color_fill = 32,
      .geometry_fill = 32,
      .rules = {{When::kOddGrid, 0, false, kNormals},
                {When::kGridAbove, 24, false, kNormals},
                {When::kOctahedral, 0, false, kFold}},
  };
  return facts;
}

const std::vector<MapChannel> kGodotNormal{C::kViewLeft, C::kViewUp, C::kViewToward};
const std::vector<MapChannel> kGodotOrm{C::kOcclusion, C::kRoughness, C::kMetallic};

TargetFacts godot4() {
  TargetFacts facts = godot("godot4");
  facts.consumer = "godot-imposter for Godot 4";
  facts.source = "github.com/zhangjt93/godot-imposter";
  facts.commit = "b004ca7";
  facts.maps = {{"color", "base_NAME_albedo.png", kColorCoverage, true},
                {"normal", "base_NAME_normal.png", kGodotNormal},
                {"depth", "base_NAME_depth.png", {C::kDepthFar}},
                {"orm", "base_NAME_orm.png", kGodotOrm}};
  facts.texts = EngineText::kGodot4;
  return facts;
}

TargetFacts godot3() {
  TargetFacts facts = godot("godot3");
  facts.consumer = "Godot-Octahedral-Impostors for Godot 3";
  facts.source = "github.com/wojtekpil/Godot-Octahedral-Impostors";
  facts.commit = "706e9a5";
  facts.grid = 12;
  facts.maps = {{"color", "NAME/result_albedo.png", kColorCoverage, true},
                {"normal", "NAME/result_normal.png", kGodotNormal},
                {"depth", "NAME/result_depth.png", {C::kDepthFar}},
                {"orm", "NAME/result_orm.png", kGodotOrm}};
  facts.texts = EngineText::kGodot3;
  return facts;
}

TargetFacts unity_imp() {
  return {
      .name = "unity-imp",
      .consumer = "IMP for Unity",
      .source = "github.com/xraxra/IMP",
      .commit = "a9391b4",
      .layouts = {BakeLayout::kHemi},
      .margin = 2,
      .hemi_order = FrameOrder::kQuarterTurn,
      .rows_from_bottom = true,
      .axes = axes_of({-1, 0, 0}, {0, 1, 0}, {0, 0, 1}),
      .color_fill = kWholeFrame,
      .geometry_fill = 16,
      // Its cut, alpha > .3^(1 / .3) = .018, then falls halfway between the last texel inside
      // and the first outside.
      .field_reach = 27.7f,
      .cleared_border = 1,
      .maps =
          {{"color", "NAME_ImposterBase.png", {C::kRed, C::kGreen, C::kBlue, C::kInnerField}, true},
           {"normal", "NAME_ImposterPack.png", kNormalDepth}},
      .texts = EngineText::kUnity,
      .rules = {{When::kOddGrid, 0, true,
                 "an odd grid has a frame straight from above, whose axes are NaN in its shader"},
                {When::kGridAbove, 32, true, "it takes 4 to 32 frames a side"},
                {When::kGridBelow, 4, true, "it takes 4 to 32 frames a side"},
                {When::kNoPowerOfTwo, 0, false, kNoPower}},
  };
}

TargetFacts unreal() {
  return {
      .name = "unreal",
      .consumer = "ImpostorBaker for Unreal",
      .source = "github.com/ictusbrucks/ImpostorBaker",
      .commit = "c75d365",
      .layouts = kHemiAndWhole,
      .roll = {RollRule{}.polar_from, {1, 0, 0}},
      .margin = 2,
      .hemi_order = FrameOrder::kMirrorJ,
      .axes = axes_of({1, 0, 0}, {0, 0, 1}, {0, 1, 0}),
      .units_per_meter = 100,
      .color_fill = kWholeFrame,
      .geometry_fill = 16,
      .field_reach = 16,
      .maps = {{"color",
                "T_NAME_Impostor_BaseColor.png",
                {C::kRed, C::kGreen, C::kBlue, C::kSignedField},
                true},
               {"normal", "T_NAME_Impostor_Normal.png", kNormalDepth},
               {"orm",
                "T_NAME_Impostor_MetallicRoughnessSpecularAO.png",
                {C::kMetallic, C::kRoughness, C::kHalf, C::kOcclusion}}},
      .texts = EngineText::kUnreal,
      .rules = {{When::kNoPowerOfTwo, 0, false, kNoPower},
                {When::kOctahedral, 0, false, kFold},
                {When::kOctahedral, 0, false, kBelow}},
  };
}

TargetFacts boimp() {
  return {
      .name = "boimp",
      .consumer = "boimp for Bevy",
      .source = "github.com/robtfm/boimp",
      .commit = "df11c31",
      .layouts = kAll,
      .grid = 8,
      .tile = 64,
      .roll = {.99, {0, 0, 1}},
      .geometry_fill = 2,
      .packed = true,
      .rules = {{When::kOctahedral, 0, false, kFold}},
  };
}

bool power_of_two(int n) { return n > 0 && (n & (n - 1)) == 0; }

bool met(const TargetRule& rule, BakeLayout layout, int grid, int tile) {
  switch (rule.when) {
    case When::kOddGrid:
      return grid % 2 == 1 && layout != BakeLayout::kRing;
    case When::kGridAbove:
      return grid > rule.number;
    case When::kGridBelow:
      return grid < rule.number;
    case When::kNoPowerOfTwo:
      return !power_of_two(grid * tile);
    case When::kGridNotPowerPlusOne:
      return !power_of_two(grid - 1);
    case When::kOctahedral:
      return layout == BakeLayout::kOctahedral;
  }
  return false;
}

std::string names_of(const std::vector<BakeLayout>& layouts) {
  std::string out;
  for (const auto layout : layouts) out += (out.empty() ? "" : ", ") + std::string(name_of(layout));
  return out;
}

}  // namespace

glm::ivec2 captured_frame(FrameOrder order, int grid, int i, int j) {
  switch (order) {
    case FrameOrder::kSame:
      return {i, j};
    case FrameOrder::kMirrorJ:
      return {i, grid - 1 - j};
    case FrameOrder::kQuarterTurn:
      return {grid - 1 - j, i};
  }
  return {i, j};
}

const std::vector<TargetFacts>& bake_targets() {
  static const std::vector<TargetFacts> all{generic(), three(),     three_tsl(), godot4(),
                                            godot3(),  unity_imp(), unreal(),    boimp()};
  return all;
}

const TargetFacts* target_of(std::string_view name) {
  for (const auto& target : bake_targets()) {
    if (target.name == name) return &target;
  }
  return nullptr;
}

Result<std::vector<std::string>> check_target(const TargetFacts& target, BakeLayout layout,
                                              int grid, int tile) {
  const std::string name(target.name);
  const auto& layouts = target.layouts;
  if (std::find(layouts.begin(), layouts.end(), layout) == layouts.end()) {
    return make_error(ErrorId::kUsage,
                      "target " + name + " has no layout " + std::string(name_of(layout)),
                      "it reads: " + names_of(layouts));
  }
  if (grid < kFewestFrames || grid > kMostFrames || tile < 1) {
    return make_error(ErrorId::kUsage, "a grid of " + std::to_string(grid) + " frames of " +
                                           std::to_string(tile) + " texels cannot be baked");
  }
  std::vector<std::string> warnings;
  for (const auto& rule : target.rules) {
    if (!met(rule, layout, grid, tile)) continue;
    const std::string line = "target " + name + ", " + std::to_string(grid) + " frames of " +
                             std::to_string(tile) + " texels a side: " + std::string(rule.reason);
    if (rule.refused) return make_error(ErrorId::kUsage, line);
    if (std::find(warnings.begin(), warnings.end(), line) == warnings.end()) {
      warnings.push_back(line);
    }
  }
  return warnings;
}

double framed_radius(const TargetFacts& target, double sphere, const glm::dvec3& box, int tile) {
  if (target.framing == Framing::kLongestEdge) {
    return std::max({box.x, box.y, box.z}) / .72 / 2;
  }
  return sphere * tile / std::max(tile - 2 * target.margin, 1);
}

bool rolled_alike(const RollRule& a, const RollRule& b, BakeLayout layout, int grid) {
  for (int j = 0; j < grid; ++j) {
    for (int i = 0; i < grid; ++i) {
      const glm::dvec3 direction = frame_direction(layout, grid, i, j);
      if (glm::dot(frame_basis(a, direction).right, frame_basis(b, direction).right) < 1 - 1e-9) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace mirage
