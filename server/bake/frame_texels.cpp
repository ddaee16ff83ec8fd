#include "server/bake/frame_texels.h"

#include <algorithm>

namespace mirage {
namespace {

bool holds(const TargetFacts& target, MapChannel channel) {
  for (const auto& map : target.maps) {
    if (std::find(map.channels.begin(), map.channels.end(), channel) != map.channels.end()) {
      return true;
    }
  }
  return false;
}

bool in_border(int texel, int size, int border) {
  const int x = texel % size, y = texel / size;
  return std::min({x, y, size - 1 - x, size - 1 - y}) < border;
}

}  // namespace

FrameTexel empty_texel() { return {}; }

FrameTexels::FrameTexels(const BakeMaster& master, const TargetFacts& target, std::size_t first)
    : master_(master), target_(target), first_(first) {
  const int size = master.tile, count = size * size;
  TexelMask shaped(count), inside(count);
  covered_.resize(count);
  for (int t = 0; t < count; ++t) {
    const float coverage = master.color[first + t].a;
    const bool border = in_border(t, size, target.cleared_border);
    covered_[t] = coverage > 0;
    shaped[t] = coverage > 0 && master.normal[first + t] != glm::vec3(0);
    inside[t] = coverage >= .5f && !border;
  }
  if (target.color_fill > 0) colored_ = nearest_texels(covered_, size);
  if (target.geometry_fill > 0) shaped_ = nearest_texels(shaped, size);
  if (holds(target, MapChannel::kInnerField))
    inner_ = inner_field(inside, size, target.field_reach);
  if (holds(target, MapChannel::kSignedField)) {
    signed_ = signed_field(inside, size, target.field_reach);
  }
}

// Returns the texel whose values a texel shows: itself, the nearest within reach, or -1.
int FrameTexels::source(const NearestTexels& nearest, int texel, int fill) const {
  if (fill == 0) return covered_[texel] ? texel : -1;
  return nearest.distance[texel] <= float(fill) ? nearest.texel[texel] : -1;
}

FrameTexel FrameTexels::at(int texel) const {
  FrameTexel out = empty_texel();
  const bool border = in_border(texel, master_.tile, target_.cleared_border);
  out.coverage = border ? 0 : std::clamp(master_.color[first_ + texel].a, 0.0f, 1.0f);
  if (!inner_.empty()) out.inner = inner_[texel];
  if (!signed_.empty()) out.signed_edge = signed_[texel];
  if (const int from = source(colored_, texel, target_.color_fill); from >= 0) {
    const glm::vec4 c = master_.color[first_ + from];
    out.color = target_.premultiplied ? glm::vec3(c) : glm::vec3(c) / c.a;
  }
  if (const int from = source(shaped_, texel, target_.geometry_fill); from >= 0) {
    const glm::vec3 n = master_.normal[first_ + from];
    out.normal = n == glm::vec3(0) ? n : glm::normalize(n);
    out.depth = master_.depth[first_ + from];
    out.orm = master_.orm[first_ + from];
  }
  return out;
}

}  // namespace mirage
