#include "protocol/model/need_rules.h"

namespace mirage {
namespace {
constexpr RuleState kApplied = RuleState::kApplied, kDropped = RuleState::kDropped;
}  // namespace

const std::array<NeedRuleInfo, kNeedRules>& need_rules() {
  static constexpr std::array<NeedRuleInfo, kNeedRules> kRules = {{
      {NeedRule::kBlending, "blending",
       "no BLEND material, or alpha 1 in every texel, vertex and factor; no alpha below a "
       "mask's cutoff",
       "sort, blend state, alpha test and its pass ahead", kApplied, "server/prepare/leave_out.cpp",
       "NeedsProof.NeutralFeaturesChangeNoComponent", "knot 1.05 x time"},
      {NeedRule::kMaskBits, "mask bits", "a tile's alpha is 0 or 255 everywhere", "8-bit alpha",
       kDropped, "", "census of every proof",
       "4 of 60 tiles of clutter, where a bit a texel is 14 bytes a tile more than what zstd "
       "makes of it; none of knot, city, Delft, forest, unlit"},
      {NeedRule::kAlpha, "alpha", "alpha is 255 in the whole crop", "the alpha plane", kDropped, "",
       "census of every proof",
       "no tile of forest, knot, clutter, city, Delft, unlit: a crop keeps a margin of empty "
       "texels for the filter"},
      {NeedRule::kDepth, "depth", "the bound without depth is met over the cell", "the depth plane",
       kDropped, "", "census of every proof",
       "10 to 64 % of a tile, but never unread: every impostor writes it, to hide and be "
       "hidden rightly"},
      {NeedRule::kDepthBits, "depth bits", "a step of 1/254 of the range is within the bound",
       "16 of 24 depth bits", kApplied, "protocol/impostor/tile.h",
       "ErrorBound, ProtocolTile; rows of every proof",
       "forest 1.6 to 2.0 x bytes, knot 2.6 x, unlit 3.8 x"},
      {NeedRule::kHdr, "HDR", "no component above 1 leaves a shader", "float targets, a tone map",
       kApplied, "shaders/mesh/mesh.frag", "rows of every proof: 0 components out of range",
       "half the memory of targets; time within noise (0.97 to 1.08 x)"},
      {NeedRule::kGray, "gray", "red and blue equal green",
       "the colours' differences from green, all 0 then", kApplied, "protocol/codec/tile_codec.cpp",
       "ProtocolTile round trips; rows of every proof",
       "forest 1.09 x bytes, Delft (all gray) 1.06 x, knot 1.04 x"},
      {NeedRule::kSolidColor, "solid colour", "no base colour map, or white in every texel",
       "the map; one texel for a tile is left to zstd", kApplied, "server/prepare/leave_out.cpp",
       "NeedsProof, Needs.NeutralElementsChangeNoByteAndNoKey",
       "knot 1.06 x time, unlit 1.10 x; no tile of six scenes has one colour"},
      {NeedRule::kCrop, "crop", "the box of what is not empty",
       "texels around it, on the wire and in the atlas", kApplied, "server/tile/tile_measure.cpp",
       "rows of every proof",
       "1.01 to 1.03 x bytes, as empty texels compress; an octagon would save 17 to 28 % "
       "more atlas texels and no bytes, and is not kept"},
      {NeedRule::kAttributes, "attributes",
       "no material reads texture coordinates, tangents, normals; colours all white",
       "vertex bytes, and differences in revision and key", kApplied,
       "server/prepare/leave_out.cpp, protocol/codec/model_codec.cpp",
       "Needs.NeutralElementsChangeNoByteAndNoKey",
       "knot 1.06 x time without vertex colours; 4 bytes of 28 a vertex for each stream"},
      {NeedRule::kMaps, "neutral maps",
       "metal-rough, normal, occlusion map absent, 1 in every texel or of factor 0",
       "sampler, code, image, bytes", kApplied,
       "server/prepare/leave_out.cpp, protocol/model/need_mask.cpp",
       "NeedsProof, Needs.WhatIsNeededShowsWhenItIsLeftOut",
       "knot 1.42 x time, rock 1.28 x, beech 1.08 x"},
      {NeedRule::kEmission, "emission", "factor 0, map black or white in every texel",
       "map, and emission; then the client may relight", kApplied, "server/prepare/leave_out.cpp",
       "NeedsProof, Needs.WhatIsNeededShowsWhenItIsLeftOut", "knot 1.12 x time, beech 1.07 x"},
      {NeedRule::kExtensions, "material extensions", "absent or neutral factor",
       "lobes, their maps", kApplied, "server/prepare/leave_out_lobes.cpp",
       "NeedsProof.NeutralFeaturesChangeNoComponent, Needs.WhatIsNeededShowsWhenItIsLeftOut",
       "not measured on its own; relit tiles stay possible"},
      {NeedRule::kLighting, "lighting", "all unlit; or the light is in the key",
       "lights, light in the key, maps; normals and material of lit tiles", kApplied,
       "server/session/session.cpp, protocol/model/need_mask.cpp",
       "NeedsProof.UnlitScenesAndThoseThatNeedAllAreDrawnAlike, "
       "Needs.LightsThatAddNothingAreInNoKey",
       "beech 1.8 x bytes and 1.07 x time, knot 2.0 x and 1.19 x, unlit 1.2 x and 1.46 x"},
      {NeedRule::kLights, "lights", "black, or its range or cone ends before the object",
       "loop steps, and requests when it changes", kApplied, "protocol/impostor/lighting_state.cpp",
       "Needs.LightsThatAddNothingAreInNoKey, Needs.WhatIsNeededShowsWhenItIsLeftOut",
       "three lamps off: knot 1.35 x time, beech 1.17 x; and their switching asks for "
       "nothing"},
      {NeedRule::kViewDependence, "view-dependent shading", "diffuse only",
       "re-shading for each view", kDropped, "", "protocol/model/need_mask.cpp",
       "no lit material is: a dielectric keeps its lobe at roughness 1 and no map is neutral "
       "for it; tiles are per view for their shape anyway"},
      {NeedRule::kSymmetry, "symmetry", "equal tiles by hash", "their bytes", kDropped, "",
       "census of every proof",
       "8 of 24 tiles of the unlit cubes, of 585 bytes each; none of knot, city, clutter, "
       "Delft"},
      {NeedRule::kShadows, "shadows", "not asked for, no caster, no sun",
       "shadow pass, shadow tiles, shader variants", kApplied,
       "server/main.cpp, server/session/session.cpp", "ShadowsEndToEnd.ExplainSaysWhyThereAreNone",
       "a map of 4096 x 4096 texels, and a tile of half the edge for each instance"},
      {NeedRule::kAnimation, "animation", "no channels, or no vertex moves",
       "skinning, phases, the clock", kApplied, "server/prepare/prepared_scene.cpp",
       "GltfAnimation, ServerMotion", "up to 256 phases of every tile"},
      {NeedRule::kStillness, "stillness",
       "all that drawing reads is what it was; nothing is left to ask for",
       "rendering, sending, the client's frame", kApplied,
       "client/session/stillness.cpp, client/view/viewer.cpp", "Stillness, CoreStillness",
       "still forest, 900 frames: 106 drawn, 32 of them to refine the picture at rest, then none, "
       "and no byte; a window at rest: 0 ticks of processor time in 5 s on both ends"},
      {NeedRule::kBackFaces, "back faces", "closed, opaque, double-sided", "back faces", kDropped,
       "", "census of every proof; tried on terrain_low_poly.glb",
       "found in one of ten shared scenes (4 of 6 objects), 1.2 x time there, but "
       "silhouettes change: 18 to 84 components of 36 tiles; and the eye may go inside "
       "geometry"},
      {NeedRule::kInstances, "instances", "same object; objects equal to the last vertex are one",
       "tiles and geometry of the others", kApplied,
       "server/prepare/leave_out.cpp, protocol/impostor/tile_key.h",
       "ServerLeaveOut.EqualObjectsAreOne",
       "terrain_low_poly.glb: 29 of 35 objects; forest: 14 objects for 552 instances"},
      {NeedRule::kInvisible, "invisible", "outside the guarded view, or under half a pixel",
       "draw and request", kApplied, "client/plan/selector.cpp", "CoreSelector", "most of a scene"},
      {NeedRule::kPrediction, "prediction", "the eye stands, or all is at rest",
       "prefetch; the predictor", kApplied,
       "client/plan/selector.cpp, client/session/client_session.cpp", "CoreSelector, Stillness",
       "no ask ahead while standing"},
      {NeedRule::kCrossFade, "cross-fade", "the pop is below a threshold", "second fetch, blend",
       kDropped, "", "counted once on the walks",
       "1.6 % of the impostors drawn on the forest walk and 3.8 % on clutter's are fading: "
       "nothing to gain; a fade of nothing is not exact either"},
      {NeedRule::kCodec, "codec", "loopback, small bytes", "encode, decode", kDropped, "",
       "census of every proof",
       "encoding with cutting and measuring is 8 % of a tile's time in the forest, 16 to 39 "
       "% in city, knot, clutter and Delft, and a raw tile is measured as well; --codec raw "
       "is there for who wants it"},
      {NeedRule::kMips, "mips", "a tile is asked for at 0.7 to 1.4 texels a pixel",
       "its mip levels", kApplied, "client/draw/impostor_atlas.cpp", "CoreSelector",
       "a third of the atlas"},
      {NeedRule::kAntiAliasing, "anti-aliasing", "all samples of a texel equal", "samples",
       kDropped, "", "census of every proof",
       "flat texels are 0.3 % of the forest, 4 to 5 % of city and clutter; where they are "
       "many (knot 23 %, Delft 27 %, unlit 74 %) shading is cheap, and finding them takes a "
       "pass of its own"},
      {NeedRule::kCovered, "covered surfaces", "a later opaque triangle on the same three corners",
       "the sides of the earlier triangle that it covers", kApplied,
       "server/prepare/leave_out_covered.cpp", "ServerLeaveOutCovered",
       "rocks with copies for collisions: FLIP 0.02, 0.36 where each tile decides anew"},
  }};
  return kRules;
}

const NeedRuleInfo& need_rule(NeedRule rule) {
  return need_rules()[static_cast<std::size_t>(rule) - 1];
}

}  // namespace mirage
