#include "protocol/model/animation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "protocol/base/stable_math.h"

namespace mirage {
namespace {

struct KeySpan {
  std::size_t key = 0;  ///< at or before t
  double share = 0;     ///< fraction of the way to the next key, 0..1
  double length_s = 0;  ///< time between the two keys; 0 outside the keys
};

KeySpan find_span(const std::vector<float>& times, double t) {
  if (!(t > times.front())) return {0, 0, 0};
  if (t >= times.back()) return {times.size() - 1, 0, 0};
  const auto after = std::upper_bound(times.begin(), times.end(), t,
                                      [](double value, float time) { return value < time; });
  const auto key = static_cast<std::size_t>(after - times.begin()) - 1;
  const double length = double{times[key + 1]} - times[key];
  return {key, (t - times[key]) / length, length};
}

glm::dquat unit_or_identity(const double* xyzw) {
  const glm::dquat q(xyzw[3], xyzw[0], xyzw[1], xyzw[2]);
  const double length = glm::length(q);
  if (!(length > 0) || !std::isfinite(length)) return {1, 0, 0, 0};
  return q / length;
}

glm::dquat quat_at(const float* xyzw) {
  const double wide[4] = {xyzw[0], xyzw[1], xyzw[2], xyzw[3]};
  return unit_or_identity(wide);
}

void put(const glm::dquat& q, double* out) {
  out[0] = q.x;
  out[1] = q.y;
  out[2] = q.z;
  out[3] = q.w;
}

// glTF 2.0 appendix C, "Cubic spline interpolation".
void sample_cubic(const Channel& c, const KeySpan& span, std::size_t width, double* out) {
  const float* from = &c.values[span.key * 3 * width];
  if (span.length_s <= 0) {
    for (std::size_t i = 0; i < width; ++i) out[i] = from[width + i];
    return;
  }
  const float* to = from + 3 * width;
  const double s = span.share, s2 = s * s, s3 = s2 * s;
  for (std::size_t i = 0; i < width; ++i) {
    out[i] = (2 * s3 - 3 * s2 + 1) * from[width + i] +
             span.length_s * (s3 - 2 * s2 + s) * from[2 * width + i] +
             (3 * s2 - 2 * s3) * to[width + i] + span.length_s * (s3 - s2) * to[i];
  }
}

glm::dmat4 local_matrix(const glm::dvec3& t, const glm::dquat& r, const glm::dvec3& s) {
  glm::dmat4 m = glm::mat4_cast(r);
  for (int c = 0; c < 3; ++c) m[c] *= s[c];
  m[3] = glm::dvec4(t, 1);
  return m;
}

struct Transform {
  glm::dvec3 translation;
  glm::dquat rotation;
  glm::dvec3 scale;
};

glm::mat3 cofactors(const glm::mat3& m) {
  return {glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1])};
}

glm::vec3 unit_or(const glm::vec3& v, const glm::vec3& fallback) {
  // Scaling comes first: squares of tiny and of huge vectors leave the range of float.
  const float most = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (!(most > 0) || !std::isfinite(most)) return fallback;
  return glm::normalize(v / most);
}

glm::mat4 blended_matrix(const VertexBinding& v, const std::vector<glm::mat4>& matrices) {
  if (v.weight.x == 1.0f) return matrices[v.binding.x];
  glm::mat4 m = matrices[v.binding.x] * v.weight.x;
  for (int i = 1; i < 4; ++i) {
    if (v.weight[i] != 0.0f) m += matrices[v.binding[i]] * v.weight[i];
  }
  return m;
}

template <typename Add>
void for_each_delta(const Animation& animation, const AnimationState& state, Add add) {
  for (std::size_t set = 0; set < animation.morphs.size(); ++set) {
    const std::vector<MorphTarget>& targets = animation.morphs[set].targets;
    for (std::size_t i = 0; i < targets.size(); ++i) {
      const float weight = state.weights[set][i];
      if (weight == 0.0f) continue;
      for (std::size_t k = 0; k < targets[i].vertex.size(); ++k) add(targets[i], k, weight);
    }
  }
}

}  // namespace

glm::dquat slerp_shortest(const glm::dquat& a, const glm::dquat& b_in, double s) {
  const glm::dquat b = glm::dot(a, b_in) < 0 ? -b_in : b_in;
  // Half-angle form: acos of a dot product near 1 loses half its digits.
  const double angle = 2 * std::atan2(glm::length(b - a), glm::length(b + a));
  const double sine = std::sin(angle);
  glm::dquat q;
  if (sine < 1e-6) {
    q = a * (1 - s) + b * s;
  } else {
    q = a * (std::sin((1 - s) * angle) / sine) + b * (std::sin(s * angle) / sine);
  }
  return glm::normalize(q);
}

void sample_channel(const Channel& c, double t, std::size_t width, double* out) {
  const KeySpan span = find_span(c.times, t);
  const bool rotation = c.path == ChannelPath::kRotation;
  if (c.interpolation == Interpolation::kCubicSpline) {
    sample_cubic(c, span, width, out);
    if (rotation) put(unit_or_identity(out), out);
    return;
  }
  const float* from = &c.values[span.key * width];
  const bool between = c.interpolation == Interpolation::kLinear && span.length_s > 0;
  if (rotation) {
    const glm::dquat a = quat_at(from);
    put(between ? slerp_shortest(a, quat_at(from + width), span.share) : a, out);
    return;
  }
  for (std::size_t i = 0; i < width; ++i) {
    out[i] = from[i];
    if (between) out[i] += span.share * (double{from[width + i]} - from[i]);
  }
}

bool moves_rigidly(const Animation& animation) {
  return animation.morphs.empty() &&
         std::all_of(animation.vertices.begin(), animation.vertices.end(),
                     [](const VertexBinding& vertex) { return vertex.weight.x == 1.0f; });
}

AnimationState evaluate(const Animation& animation, double t) {
  std::vector<Transform> local;
  local.reserve(animation.joints.size());
  for (const Joint& j : animation.joints) {
    local.push_back({glm::dvec3(j.translation), glm::dquat(j.rotation), glm::dvec3(j.scale)});
  }
  AnimationState state;
  for (const MorphSet& set : animation.morphs) state.weights.push_back(set.rest_weights);
  std::vector<double> values(4);
  for (const Channel& c : animation.channels) {
    if (c.path == ChannelPath::kWeights) {
      std::vector<float>& weights = state.weights[c.target];
      values.resize(std::max<std::size_t>(values.size(), weights.size()));
      sample_channel(c, t, weights.size(), values.data());
      for (std::size_t i = 0; i < weights.size(); ++i) weights[i] = static_cast<float>(values[i]);
      continue;
    }
    sample_channel(c, t, c.path == ChannelPath::kRotation ? 4 : 3, values.data());
    Transform& joint = local[c.target];
    const glm::dvec3 v(values[0], values[1], values[2]);
    if (c.path == ChannelPath::kTranslation) joint.translation = v;
    if (c.path == ChannelPath::kScale) joint.scale = v;
    if (c.path == ChannelPath::kRotation) joint.rotation = {values[3], v.x, v.y, v.z};
  }
  std::vector<glm::dmat4> object_from_joint;
  object_from_joint.reserve(local.size());
  for (std::size_t i = 0; i < local.size(); ++i) {
    const Joint& j = animation.joints[i];
    const glm::dmat4 m = j.moves
                             ? local_matrix(local[i].translation, local[i].rotation, local[i].scale)
                             : glm::dmat4(j.matrix);
    object_from_joint.push_back(
        j.parent < 0 ? m : object_from_joint[static_cast<std::size_t>(j.parent)] * m);
  }
  for (const JointBinding& b : animation.bindings) {
    state.object_from_bind.emplace_back(object_from_joint[b.joint] * glm::dmat4(b.joint_from_bind));
  }
  return state;
}

namespace {

// Large finite matrices may overflow when multiplied. Such a vertex stays at its bind position.
glm::vec3 placed_or(const glm::vec3& posed, const glm::vec3& bound) {
  const bool finite = std::isfinite(posed.x) && std::isfinite(posed.y) && std::isfinite(posed.z);
  return finite ? posed : bound;
}

/// The transform of a vertex.
struct Turn {
  int binding = -1;  ///< the only one; -1: several
  glm::mat4 matrix{1};
  glm::mat3 linear{1};
  glm::mat3 cofactor{1};
  float side = 1;  ///< -1: mirrored
};

Turn turn_of(const VertexBinding& vertex, const std::vector<glm::mat4>& matrices) {
  Turn turn;
  if (vertex.weight.x == 1.0f) turn.binding = vertex.binding.x;
  turn.matrix = blended_matrix(vertex, matrices);
  turn.linear = glm::mat3(turn.matrix);
  turn.cofactor = cofactors(turn.linear);
  turn.side = glm::determinant(turn.linear) < 0 ? -1.0f : 1.0f;
  return turn;
}

}  // namespace

void pose_vertices(const std::vector<Vertex>& bind, const Animation& animation, double clip_time_s,
                   std::vector<Vertex>& out) {
  const AnimationState state = evaluate(animation, clip_time_s);
  out = bind;
  for_each_delta(animation, state, [&](const MorphTarget& target, std::size_t k, float weight) {
    Vertex& v = out[target.vertex[k]];
    v.position += weight * target.position[k];
    v.normal += weight * target.normal[k];
    v.tangent += glm::vec4(weight * target.tangent[k], 0);
  });
  std::optional<Turn> turn;
  for (std::size_t i = 0; i < out.size(); ++i) {
    Vertex& v = out[i];
    const VertexBinding& bound = animation.vertices[i];
    // Neighbours of rigid parts share their joint, and all that is made of its matrix.
    const bool same = turn && bound.weight.x == 1.0f && turn->binding == bound.binding.x;
    if (!same) turn = turn_of(bound, state.object_from_bind);
    const auto& [binding, m, linear, cofactor, side] = *turn;
    v.position = placed_or(glm::vec3(m * glm::vec4(v.position, 1)), bind[i].position);
    v.normal = unit_or(side * (cofactor * v.normal), bind[i].normal);
    const glm::vec3 along = linear * glm::vec3(v.tangent);
    const glm::vec3 flat = along - v.normal * glm::dot(v.normal, along);
    v.tangent = glm::vec4(unit_or(flat, glm::vec3(bind[i].tangent)), side * v.tangent.w);
  }
}

void pose_positions(const std::vector<Vertex>& bind, const Animation& animation, double clip_time_s,
                    std::vector<glm::vec3>& out) {
  const AnimationState state = evaluate(animation, clip_time_s);
  out.resize(bind.size());
  for (std::size_t i = 0; i < bind.size(); ++i) out[i] = bind[i].position;
  for_each_delta(animation, state, [&](const MorphTarget& target, std::size_t k, float weight) {
    out[target.vertex[k]] += weight * target.position[k];
  });
  for (std::size_t i = 0; i < out.size(); ++i) {
    const glm::mat4 m = blended_matrix(animation.vertices[i], state.object_from_bind);
    out[i] = placed_or(glm::vec3(m * glm::vec4(out[i], 1)), bind[i].position);
  }
}

}  // namespace mirage
