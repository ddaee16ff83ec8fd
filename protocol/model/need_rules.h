#pragma once
// The rules of leaving out (numerics.md section 5) as one table: what is detected, what is then
// left out, how that is proven, and what became of the rule. Explain, proof, report and documents
// read it.

#include <array>
#include <cstdint>
#include <string_view>

namespace mirage {

enum class NeedRule : std::uint8_t {
  kBlending = 1,
  kMaskBits,
  kAlpha,
  kDepth,
  kDepthBits,
  kHdr,
  kGray,
  kSolidColor,
  kCrop,
  kAttributes,
  kMaps,
  kEmission,
  kExtensions,
  kLighting,
  kLights,
  kViewDependence,
  kSymmetry,
  kShadows,
  kAnimation,
  kStillness,
  kBackFaces,
  kInstances,
  kInvisible,
  kPrediction,
  kCrossFade,
  kCodec,
  kMips,
  kAntiAliasing,
};

enum class RuleState : std::uint8_t { kApplied, kDropped };

struct NeedRuleInfo {
  NeedRule rule;
  std::string_view name;
  std::string_view detection;  ///< what must be found
  std::string_view left_out;   ///< and what then is not there
  RuleState state;
  std::string_view where;   ///< the file that applies it; of a dropped rule empty
  std::string_view proof;   ///< the test; of a dropped rule where its figure is from
  std::string_view saving;  ///< measured, with its conditions; of a dropped rule why it is not kept
};

inline constexpr std::size_t kNeedRules = 28;
/// In the order of their numbers.
const std::array<NeedRuleInfo, kNeedRules>& need_rules();
const NeedRuleInfo& need_rule(NeedRule rule);

}  // namespace mirage
