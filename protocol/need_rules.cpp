#include "protocol/need_rules.h"

namespace mirage {
namespace {
constexpr RuleState kApplied = RuleState::kApplied, kDropped = RuleState::kDropped;
}  // namespace

const std::array<NeedRuleInfo, kNeedRules>& need_rules() {
  static constexpr std::array<NeedRuleInfo, kNeedRules> kRules = {{
      {NeedRule::kBlending, "blending", "", "", kApplied, "", "", ""},
      {NeedRule::kMaskBits, "mask bits", "", "", kDropped, "", "", ""},
      {NeedRule::kAlpha, "alpha", "", "", kDropped, "", "", ""},
      {NeedRule::kDepth, "depth", "", "", kDropped, "", "", ""},
      {NeedRule::kDepthBits, "depth bits", "", "", kApplied, "", "", ""},
      {NeedRule::kHdr, "HDR", "", "", kApplied, "", "", ""},
      {NeedRule::kGray, "gray", "", "", kDropped, "", "", ""},
      {NeedRule::kSolidColor, "solid colour", "", "", kApplied, "", "", ""},
      {NeedRule::kCrop, "crop", "", "", kApplied, "", "", ""},
      {NeedRule::kAttributes, "attributes", "", "", kApplied, "", "", ""},
      {NeedRule::kMaps, "neutral maps", "", "", kApplied, "", "", ""},
      {NeedRule::kEmission, "emission", "", "", kApplied, "", "", ""},
      {NeedRule::kExtensions, "material extensions", "", "", kDropped, "", "", ""},
      {NeedRule::kLighting, "lighting", "", "", kApplied, "", "", ""},
      {NeedRule::kLights, "lights", "", "", kApplied, "", "", ""},
      {NeedRule::kViewDependence, "view-dependent shading", "", "", kDropped, "", "", ""},
      {NeedRule::kSymmetry, "symmetry", "", "", kDropped, "", "", ""},
      {NeedRule::kShadows, "shadows", "", "", kApplied, "", "", ""},
      {NeedRule::kAnimation, "animation", "", "", kApplied, "", "", ""},
      {NeedRule::kStillness, "stillness", "", "", kApplied, "", "", ""},
      {NeedRule::kBackFaces, "back faces", "", "", kDropped, "", "", ""},
      {NeedRule::kInstances, "instances", "", "", kApplied, "", "", ""},
      {NeedRule::kInvisible, "invisible", "", "", kApplied, "", "", ""},
      {NeedRule::kPrediction, "prediction", "", "", kApplied, "", "", ""},
      {NeedRule::kCrossFade, "cross-fade", "", "", kDropped, "", "", ""},
      {NeedRule::kCodec, "codec", "", "", kDropped, "", "", ""},
      {NeedRule::kMips, "mips", "", "", kApplied, "", "", ""},
      {NeedRule::kAntiAliasing, "anti-aliasing", "", "", kDropped, "", "", ""},
  }};
  return kRules;
}

const NeedRuleInfo& need_rule(NeedRule rule) {
  return need_rules()[static_cast<std::size_t>(rule) - 1];
}

}  // namespace mirage
