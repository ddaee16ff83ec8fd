#include "server/bake/bake_eye.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "protocol/base/stable_math.h"
#include "server/bake/encode.h"

namespace mirage {
namespace {

// A ray is followed through a frame's heights in steps of a texel, so that it meets what is thin,
// and the step that meets a surface is halved so often.
constexpr int kFewestSteps = 8, kMostSteps = 192, kHalvings = 6;
// Where a texel covers less, a ray passes through. Of .1 to .5, .35 serves rods and glass best
// (chair
// +.3 dB, glass table +1.5) and costs the monkey .3.
constexpr float kCovers = 0.35f;
// Heights of neighbouring texels that differ by more, in radii, belong to two surfaces, between
// which there is none. Interpolated, a wall would join them: fan -2.3 dB, car -1.6, chair -1.3.
constexpr float kSheer = 0.07f;
// A ray that meets a surface farther below its height than kCliff, in radii, has passed an edge.
// What lies behind the edge was hidden from this frame. Up to kThick below, the edge stands in for
// it; farther below, the frame takes it for empty, or foliage would fill up. Of .02 to 9, .15
// serves knot and tree best and costs the monkey .3 dB.
constexpr float kCliff = 0.03f, kThick = 0.15f;
// Trust in what a frame says of a ray, if the edge stands in, and if it meets nothing: the frame
// may see a single-sided surface from behind, and so not at all. Otherwise it is 1. Of .1 to 1, .3
// gives an open box 2 dB more, chair, helmet and car .1, and costs the knot .2.
constexpr float kHidden = 0.02f, kEmpty = 0.3f;
// Share of its trust that a frame keeps where it meets something behind another frame's surface
// that it cannot see. At 1, the monkey loses 1.1 dB, fan and chair .8.
constexpr float kUnseen = 0.03f;
constexpr float kNowhere = std::numeric_limits<float>::infinity();

float to_linear(float v) {
  return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
}
float byte_of(float v) { return std::round(std::clamp(v, 0.0f, 1.0f) * 255) / 255; }

/// Colour, normal and height that a frame shows at one place.
struct Texel {
  glm::vec4 color{0};
  glm::vec3 normal{0};
  float height = 0;
};

/// One frame of a bake as a plane of heights, colours and normals over [-1, 1] each way.
class Frame {
 public:
  Frame(const BakeMaster& master, const glm::ivec2& at)
      : master_(master), first_(master.first(at.x, at.y)), basis_(master.basis(at.x, at.y)) {}

  glm::vec3 local(const glm::dvec3& v) const {
    return {float(glm::dot(v, basis_.right)), float(glm::dot(v, basis_.up)),
            float(glm::dot(v, basis_.toward))};
  }

  /// Texels along an edge.
  float texels() const { return float(master_.tile); }

  /// Height and coverage at a place, interpolated; heights of covered texels alone, and of those
  /// that belong to the nearest one's surface.
  void look(float x, float y, float& height, float& cover) const {
    Corners c;
    height = cover = 0;
    if (!corners(x, y, c)) return;
    float most = 0, nearest = 0;
    for (int i = 0; i < 4; ++i) {
      const float a = master_.color[c.texel[i]].a;
      cover += c.weight[i] * a;
      if (a <= 0 || c.weight[i] <= most) continue;
      most = c.weight[i];
      nearest = master_.depth[c.texel[i]];
    }
    float share = 0;
    for (int i = 0; i < 4; ++i) {
      const float h = master_.depth[c.texel[i]];
      if (master_.color[c.texel[i]].a <= 0 || std::abs(h - nearest) > kSheer) continue;
      share += c.weight[i];
      height += c.weight[i] * h;
    }
    if (share > 0) height /= share;
  }

  Texel texel(float x, float y) const {
    Corners c;
    Texel out;
    if (!corners(x, y, c)) return out;
    for (int i = 0; i < 4; ++i) {
      const glm::vec4& color = master_.color[c.texel[i]];
      out.color += c.weight[i] * color;
      out.normal += c.weight[i] * color.a * master_.normal[c.texel[i]];
    }
    const float l = glm::length(out.normal);
    out.normal = l > 1e-4f ? out.normal / l : glm::vec3(0);
    return out;
  }

 private:
  struct Corners {
    std::size_t texel[4];
    float weight[4];
  };
  bool corners(float x, float y, Corners& c) const {
    if (!(std::abs(x) < 1 && std::abs(y) < 1)) return false;
    const float last = float(master_.tile - 1);
    const float u = std::clamp((x + 1) / 2 * float(master_.tile) - 0.5f, 0.0f, last);
    const float v = std::clamp((1 - y) / 2 * float(master_.tile) - 0.5f, 0.0f, last);
    const int i = std::min(int(u), master_.tile - 2), j = std::min(int(v), master_.tile - 2);
    const float fu = u - float(i), fv = v - float(j);
    const std::size_t at = first_ + std::size_t(j) * master_.tile + i;
    c = {{at, at + 1, at + master_.tile, at + master_.tile + 1},
         {(1 - fu) * (1 - fv), fu * (1 - fv), (1 - fu) * fv, fu * fv}};
    return true;
  }

  const BakeMaster& master_;
  std::size_t first_;
  FrameBasis basis_;
};

/// A ray from the eye, in radii about the centre.
struct Ray {
  glm::dvec3 from, along;
};

/// A frame's answer to a ray.
struct Answer {
  Texel texel;
  float trust = 1;
  float at = kNowhere;  ///< where along the ray the surface is; kNowhere: the frame sees none there
};

Answer on_plane(const Frame& frame, const Ray& ray) {
  const glm::vec3 o = frame.local(ray.from), d = frame.local(ray.along);
  if (!(std::abs(d.z) > 1e-4f)) return {};
  const float t = -o.z / d.z;
  if (t < 0) return {};
  return {frame.texel(o.x + t * d.x, o.y + t * d.y), 1, t};
}

// Follows a ray through a frame's heights.
class Trace {
 public:
  Trace(const Frame& frame, const Ray& ray)
      : frame_(frame), o_(frame.local(ray.from)), d_(frame.local(ray.along)) {}

  Answer answer() {
    const double od = glm::dot(glm::dvec3(o_), glm::dvec3(d_)), l = glm::dot(o_, o_);
    const double room = od * od - (l - 1);
    if (room <= 0) return {Texel{}, kEmpty, kNowhere};
    const float half = float(std::sqrt(room)), begin = float(-od) - half;
    const float across = glm::length(glm::vec2(d_)) * half * frame_.texels();
    const int steps = std::clamp(int(std::ceil(across)), kFewestSteps, kMostSteps);
    const float step = 2 * half / float(steps);
    bool inside = false;
    std::optional<float> cliff;
    for (int i = 1; i <= steps; ++i) {
      const float t = begin + step * float(i);
      const bool now = below(t);
      if (now && !inside) {
        const float met = narrowed(t - step, t);
        const float depth = depth_below(met);
        if (depth <= kCliff) return {texel(met), 1, met};
        if (!cliff && depth <= kThick) cliff = met;
      }
      inside = now;
    }
    if (cliff) return {texel(*cliff), kHidden, kNowhere};
    return {Texel{}, kEmpty, kNowhere};
  }

  /// True if the frame cannot see that place of the ray, because something is above it.
  bool hides(float t) { return depth_below(t) > kCliff && cover_ >= kCovers; }

 private:
  float depth_below(float t) {
    float height = 0;
    frame_.look(o_.x + t * d_.x, o_.y + t * d_.y, height, cover_);
    return height - (o_.z + t * d_.z);
  }
  bool below(float t) {
    const float depth = depth_below(t);
    return depth >= 0 && cover_ >= kCovers;
  }
  float narrowed(float outside, float inside) {
    for (int i = 0; i < kHalvings; ++i) {
      const float middle = (outside + inside) / 2;
      (below(middle) ? inside : outside) = middle;
    }
    return inside;
  }
  Texel texel(float t) const { return frame_.texel(o_.x + t * d_.x, o_.y + t * d_.y); }

  const Frame& frame_;
  const glm::vec3 o_, d_;
  float cover_ = 0;
};

Texel weighted(const std::vector<Answer>& answers, const std::array<double, 3>& weights) {
  Texel out;
  float all = 0;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const float w = float(weights[i]) * answers[i].trust;
    all += w;
    out.color += w * answers[i].texel.color;
    out.normal += w * answers[i].texel.color.a * answers[i].texel.normal;
  }
  if (all > 0) out.color /= all;
  const float l = glm::length(out.normal);
  out.normal = l > 1e-6f ? out.normal / l : glm::vec3(0);
  return out;
}

std::vector<Answer> traced(const std::vector<Frame>& frames, const Ray& ray) {
  std::vector<Trace> traces;
  std::vector<Answer> answers;
  float nearest = kNowhere;
  for (const Frame& frame : frames) {
    traces.emplace_back(frame, ray);
    answers.push_back(traces.back().answer());
    nearest = std::min(nearest, answers.back().at);
  }
  if (nearest == kNowhere) return answers;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    if (answers[i].at > nearest + kCliff && traces[i].hides(nearest)) answers[i].trust *= kUnseen;
  }
  return answers;
}

Texel seen(const std::vector<Frame>& frames, const FrameBlend& blend, const Ray& ray,
           BakeMethod method) {
  std::vector<Answer> answers;
  answers.reserve(3);
  if (method == BakeMethod::kDepth) {
    answers = traced(frames, ray);
  } else {
    for (const Frame& frame : frames) answers.push_back(on_plane(frame, ray));
  }
  return weighted(answers, blend.weight);
}

}  // namespace

std::string_view name_of(BakeMethod method) {
  return method == BakeMethod::kNearest ? "nearest"
         : method == BakeMethod::kBlend ? "blend"
                                        : "depth";
}

FrameBasis BakeCamera::basis() const { return frame_basis(RollRule{}, direction); }
double BakeCamera::half_tangent() const { return 1.05 / tangent_length(radii, 1); }

BakeMaster as_bytes(BakeMaster master) {
  for (glm::vec4& c : master.color) {
    for (int i = 0; i < 3; ++i) c[i] = to_linear(byte_of(srgb_of(std::clamp(c[i], 0.0f, 1.0f))));
    c.a = byte_of(c.a);
  }
  for (glm::vec3& n : master.normal) {
    if (n == glm::vec3(0)) continue;
    for (int i = 0; i < 3; ++i) n[i] = 2 * byte_of(n[i] / 2 + 0.5f) - 1;
  }
  for (float& d : master.depth) d = 2 * byte_of(d / 2 + 0.5f) - 1;
  return master;
}

BakePicture draw_bake(const BakeMaster& master, const BakeCamera& camera, BakeMethod method,
                      int edge, int samples, const Workers& workers) {
  FrameBlend blend = frame_blend(master.layout, master.grid, camera.direction);
  std::vector<Frame> frames;
  if (method == BakeMethod::kNearest) {
    const auto most = std::max_element(blend.weight.begin(), blend.weight.end());
    frames.emplace_back(master, blend.frame[std::size_t(most - blend.weight.begin())]);
    blend.weight = {1, 0, 0};
  } else {
    for (const glm::ivec2& at : blend.frame) frames.emplace_back(master, at);
  }
  BakePicture out;
  out.edge = edge;
  out.color.assign(std::size_t(edge) * edge, glm::vec4(0));
  out.normal.assign(std::size_t(edge) * edge, glm::vec3(0));
  const FrameBasis axes = camera.basis();
  const glm::dvec3 eye = camera.direction * camera.radii;
  const double half = camera.half_tangent();
  workers.each(std::size_t(edge), [&](std::size_t row) {
    for (int x = 0; x < edge; ++x) {
      glm::vec4 color(0);
      glm::vec3 normal(0);
      for (int s = 0; s < samples * samples; ++s) {
        const int across = s % samples, down = s / samples;
        const double px = x + (across + 0.5) / samples;
        const double py = double(row) + (down + 0.5) / samples;
        const double right = half * (2 * px / edge - 1), up = half * (1 - 2 * py / edge);
        const Ray ray{eye, glm::normalize(axes.right * right + axes.up * up - axes.toward)};
        const Texel texel = seen(frames, blend, ray, method);
        color += texel.color;
        normal += texel.color.a * texel.normal;
      }
      const float l = glm::length(normal);
      const std::size_t at = row * std::size_t(edge) + x;
      out.color[at] = color / float(samples * samples);
      out.normal[at] = l > 1e-6f ? normal / l : glm::vec3(0);
    }
  });
  return out;
}

}  // namespace mirage
