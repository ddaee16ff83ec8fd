#pragma once
// The rules of leaving out (numerics.md section 5) as one table: the condition detected, the
// content then left out, its proof, and the state of the rule. The `--explain` output, proofs, the
// report and the documents read it.

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
  kCovered,
};

enum class RuleState : std::uint8_t { kApplied, kDropped };

struct NeedRuleInfo {
  NeedRule rule;
  std::string_view name;
  std::string_view detection;  ///< condition that must be found
  std::string_view left_out;   ///< content then left out
  RuleState state;
  std::string_view where;   ///< file that applies it; empty for a dropped rule
  std::string_view proof;   ///< the test; for a dropped rule, the source of its figure
  std::string_view saving;  ///< measured, with conditions; for a dropped rule, the reason
};

inline constexpr std::size_t kNeedRules = 29;
/// Returns all rules in the order of their numbers.
const std::array<NeedRuleInfo, kNeedRules>& need_rules();
const NeedRuleInfo& need_rule(NeedRule rule);

}  // namespace mirage
