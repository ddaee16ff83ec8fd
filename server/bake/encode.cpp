#include "server/bake/encode.h"

#include <algorithm>
#include <cmath>

namespace mirage {
namespace {

float half(float v) { return v * .5f + .5f; }

// The normal in the consumer's axes.
float object_normal(const FrameTexel& texel, const TargetFacts& target, int axis) {
  return half(float((target.axes * glm::dvec3(texel.normal))[axis]));
}

// The background faces the camera.
glm::vec3 view_normal(const FrameTexel& texel, const FrameBasis& basis) {
  if (texel.normal == glm::vec3(0)) return {0, 0, 1};
  const glm::dvec3 n(texel.normal);
  return {dot(n, basis.right), dot(n, basis.up), dot(n, basis.toward)};
}

float color_or_field(MapChannel channel, const FrameTexel& texel) {
  switch (channel) {
    case MapChannel::kRed:
      return texel.color.r;
    case MapChannel::kGreen:
      return texel.color.g;
    case MapChannel::kBlue:
      return texel.color.b;
    case MapChannel::kCoverage:
      return texel.coverage;
    case MapChannel::kInnerField:
      return texel.inner;
    case MapChannel::kSignedField:
      return texel.signed_edge;
    case MapChannel::kOcclusion:
      return texel.orm.r;
    case MapChannel::kRoughness:
      return texel.orm.g;
    case MapChannel::kMetallic:
      return texel.orm.b;
    default:
      return .5f;
  }
}

float raw(MapChannel channel, const FrameTexel& texel, const TargetFacts& target,
          const FrameBasis& basis) {
  switch (channel) {
    case MapChannel::kNormalX:
      return object_normal(texel, target, 0);
    case MapChannel::kNormalY:
      return object_normal(texel, target, 1);
    case MapChannel::kNormalZ:
      return object_normal(texel, target, 2);
    case MapChannel::kViewRight:
      return half(view_normal(texel, basis).x);
    case MapChannel::kViewLeft:
      return half(-view_normal(texel, basis).x);
    case MapChannel::kViewUp:
      return half(view_normal(texel, basis).y);
    case MapChannel::kViewToward:
      return half(view_normal(texel, basis).z);
    case MapChannel::kDepthNear:
      return half(texel.depth);
    case MapChannel::kDepthFar:
      return half(-texel.depth);
    default:
      return color_or_field(channel, texel);
  }
}

struct Formula {
  MapChannel channel;
  std::string_view text;
};

constexpr Formula kFormulas[] = {
    {MapChannel::kRed, "red"},
    {MapChannel::kGreen, "green"},
    {MapChannel::kBlue, "blue"},
    {MapChannel::kCoverage, "coverage"},
    {MapChannel::kInnerField, "min(distance to the outline / reach, 1), 0 outside"},
    {MapChannel::kSignedField, "(signed distance to the outline / reach + 1) / 2"},
    {MapChannel::kNormalX, "n.x * .5 + .5"},
    {MapChannel::kNormalY, "n.y * .5 + .5"},
    {MapChannel::kNormalZ, "n.z * .5 + .5"},
    {MapChannel::kViewRight, "dot(n, right) * .5 + .5"},
    {MapChannel::kViewLeft, ".5 - dot(n, right) * .5"},
    {MapChannel::kViewUp, "dot(n, up) * .5 + .5"},
    {MapChannel::kViewToward, "dot(n, toward) * .5 + .5"},
    {MapChannel::kDepthNear, ".5 + s / (2 * radius)"},
    {MapChannel::kDepthFar, ".5 - s / (2 * radius)"},
    {MapChannel::kOcclusion, "occlusion"},
    {MapChannel::kRoughness, "roughness"},
    {MapChannel::kMetallic, "metallic"},
    {MapChannel::kHalf, ".5"},
};

}  // namespace

float encode(MapChannel channel, const FrameTexel& texel, const TargetFacts& target,
             const FrameBasis& basis) {
  return std::clamp(raw(channel, texel, target, basis), 0.0f, 1.0f);
}

float srgb_of(float linear) {
  return linear <= .0031308f ? linear * 12.92f : 1.055f * std::pow(linear, 1 / 2.4f) - .055f;
}

std::string_view formula_of(MapChannel channel) {
  for (const auto& formula : kFormulas) {
    if (formula.channel == channel) return formula.text;
  }
  return "";
}

bool is_color(MapChannel channel) {
  return channel == MapChannel::kRed || channel == MapChannel::kGreen ||
         channel == MapChannel::kBlue;
}

}  // namespace mirage
