#include "protocol/codec/animation_codec.h"

#include <cmath>
#include <cstring>
#include <string>
#include <type_traits>

#include "protocol/base/limits.h"

namespace mirage {
namespace {

class Writer {
 public:
  template <typename T>
  void put(const T& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto* p = reinterpret_cast<const std::uint8_t*>(&v);
    bytes.insert(bytes.end(), p, p + sizeof(T));
  }
  template <typename T>
  void put_list(const std::vector<T>& v) {
    put(static_cast<std::uint32_t>(v.size()));
    put_values(v);
  }
  /// Writes the count of `v`, then each element with `put_one`.
  template <typename T, typename Put>
  void put_each(const std::vector<T>& v, const Put& put_one) {
    put(static_cast<std::uint32_t>(v.size()));
    for (const T& one : v) put_one(one);
  }
  template <typename T>
  void put_values(const std::vector<T>& v) {
    const auto* p = reinterpret_cast<const std::uint8_t*>(v.data());
    bytes.insert(bytes.end(), p, p + v.size() * sizeof(T));
  }
  Bytes bytes;
};

/// Reads values up to the first error, then only zeros.
class Reader {
 public:
  Reader(const std::uint8_t* bytes, std::size_t size) : at_(bytes), left_(size) {}

  template <typename T>
  T get() {
    T v{};
    if (failed_ || left_ < sizeof(T)) {
      failed_ = true;
      return v;
    }
    std::memcpy(&v, at_, sizeof(T));
    at_ += sizeof(T);
    left_ -= sizeof(T);
    return v;
  }
  template <typename T>
  void get_values(std::vector<T>& out, std::size_t n) {
    if (failed_ || n > left_ / sizeof(T)) {
      failed_ = true;
      return;
    }
    out.resize(n);
    if (n > 0) std::memcpy(out.data(), at_, n * sizeof(T));
    at_ += n * sizeof(T);
    left_ -= n * sizeof(T);
  }
  /// Reads a count of things of at least `each` bytes. Fails and returns 0 if fewer bytes are left.
  std::size_t count(std::size_t limit, std::size_t each) {
    const auto n = get<std::uint32_t>();
    if (!failed_ && n <= limit && n <= left_ / each) return n;
    failed_ = true;
    return 0;
  }
  bool failed() const { return failed_; }
  bool at_end() const { return !failed_ && left_ == 0; }

 private:
  const std::uint8_t* at_;
  std::size_t left_;
  bool failed_ = false;
};

constexpr std::size_t kJointBytes = 4 + 4 + 16 * 4 + 10 * 4;
constexpr std::size_t kBindingBytes = 4 + 16 * 4;
constexpr std::size_t kChannelBytes = 4 + 4 + 4;
constexpr std::size_t kDeltaBytes = 4 + 3 * 12;

template <typename T>
bool all_finite(const std::vector<T>& values) {
  const auto* f = reinterpret_cast<const float*>(values.data());
  for (std::size_t i = 0; i < values.size() * (sizeof(T) / sizeof(float)); ++i) {
    if (!std::isfinite(f[i])) return false;
  }
  return true;
}

bool finite(const glm::mat4& m) { return all_finite(std::vector<glm::mat4>{m}); }

Error track_error(const char* what) {
  return make_error(ErrorId::kWireValue, std::string("animation has a bad ") + what);
}

Result<void> read_joints(Reader& r, Animation& a) {
  a.joints.resize(r.count(limits::kMaxJoints, kJointBytes));
  for (std::size_t i = 0; i < a.joints.size(); ++i) {
    Joint& j = a.joints[i];
    j.parent = r.get<std::int32_t>();
    const auto moves = r.get<std::uint32_t>();
    j.moves = moves != 0;
    j.matrix = r.get<glm::mat4>();
    j.translation = r.get<glm::vec3>();
    j.rotation = r.get<glm::quat>();
    j.scale = r.get<glm::vec3>();
    const float sum = j.translation.x + j.translation.y + j.translation.z + j.rotation.w +
                      j.rotation.x + j.rotation.y + j.rotation.z + j.scale.x + j.scale.y +
                      j.scale.z;
    const bool parent = j.parent >= -1 && j.parent < static_cast<std::int64_t>(i);
    if (moves > 1 || !parent || !finite(j.matrix) || !std::isfinite(sum)) {
      return track_error("joint");
    }
  }
  a.bindings.resize(r.count(limits::kMaxBindings, kBindingBytes));
  for (JointBinding& b : a.bindings) {
    const auto joint = r.get<std::uint32_t>();
    b.joint_from_bind = r.get<glm::mat4>();
    if (joint >= a.joints.size() || !finite(b.joint_from_bind)) return track_error("binding");
    b.joint = static_cast<std::uint16_t>(joint);
  }
  return {};
}

Result<void> read_vertices(Reader& r, Animation& a, std::size_t mesh_vertices) {
  const std::size_t n = r.count(limits::kMaxMeshVertices, 8 + 16);
  if (n != mesh_vertices) return track_error("count of vertices");
  std::vector<glm::u16vec4> bindings;
  std::vector<glm::vec4> weights;
  r.get_values(bindings, n);
  r.get_values(weights, n);
  if (r.failed() || !all_finite(weights)) return track_error("vertex");
  a.vertices.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    for (int k = 0; k < 4; ++k) {
      if (bindings[i][k] >= a.bindings.size()) return track_error("vertex");
    }
    a.vertices[i] = {bindings[i], weights[i]};
  }
  return {};
}

Result<void> read_target(Reader& r, MorphTarget& t, std::size_t vertices, std::size_t& deltas) {
  const std::size_t n = r.count(limits::kMaxMorphDeltas - deltas, kDeltaBytes);
  deltas += n;
  r.get_values(t.vertex, n);
  r.get_values(t.position, n);
  r.get_values(t.normal, n);
  r.get_values(t.tangent, n);
  if (r.failed() || !all_finite(t.position) || !all_finite(t.normal) || !all_finite(t.tangent)) {
    return track_error("morph target");
  }
  for (const std::uint32_t v : t.vertex) {
    if (v >= vertices) return track_error("morph target");
  }
  return {};
}

Result<void> read_morphs(Reader& r, Animation& a) {
  a.morphs.resize(r.count(limits::kMaxMorphSets, 4));
  std::size_t deltas = 0;
  for (MorphSet& set : a.morphs) {
    const std::size_t targets = r.count(limits::kMaxMorphTargets, 8);
    r.get_values(set.rest_weights, targets);
    if (!all_finite(set.rest_weights)) return track_error("morph weight");
    set.targets.resize(targets);
    for (MorphTarget& t : set.targets) {
      if (auto ok = read_target(r, t, a.vertices.size(), deltas); !ok) return ok;
    }
  }
  return {};
}

bool rising(const std::vector<float>& times) {
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!std::isfinite(times[i]) || times[i] < 0) return false;
    if (i > 0 && !(times[i] > times[i - 1])) return false;
  }
  return !times.empty();
}

Result<void> read_channel(Reader& r, const Animation& a, Channel& c) {
  const auto target = r.get<std::uint16_t>();
  const auto path = r.get<std::uint8_t>(), interpolation = r.get<std::uint8_t>();
  const bool kinds = path <= static_cast<std::uint8_t>(ChannelPath::kWeights) &&
                     interpolation <= static_cast<std::uint8_t>(Interpolation::kCubicSpline);
  c.target = target;
  c.path = static_cast<ChannelPath>(path);
  c.interpolation = static_cast<Interpolation>(interpolation);
  const bool weights = kinds && c.path == ChannelPath::kWeights;
  const bool there = weights ? target < a.morphs.size() : target < a.joints.size();
  if (!kinds || !there) return track_error("channel");
  std::size_t width = c.path == ChannelPath::kRotation ? 4 : 3;
  if (weights) width = a.morphs[target].targets.size();
  if (c.interpolation == Interpolation::kCubicSpline) width *= 3;
  r.get_values(c.times, r.count(limits::kMaxAnimationFloats, sizeof(float)));
  // Products of two checked counts stay far below 2^64.
  r.get_values(c.values, r.failed() ? 0 : c.times.size() * width);
  if (r.failed() || width == 0 || !rising(c.times) || !all_finite(c.values)) {
    return track_error("channel");
  }
  return {};
}

}  // namespace

std::size_t encoded_animation_bytes(const Animation* a) {
  if (!a) return 1;
  std::size_t bytes = 1 + 4 + 5 * 4 + a->joints.size() * kJointBytes +
                      a->bindings.size() * kBindingBytes + a->vertices.size() * 24;
  for (const MorphSet& set : a->morphs) {
    bytes += 4 + set.rest_weights.size() * 4;
    for (const MorphTarget& t : set.targets) bytes += 4 + t.vertex.size() * kDeltaBytes;
  }
  for (const Channel& c : a->channels) {
    bytes += 4 + 4 + (c.times.size() + c.values.size()) * sizeof(float);
  }
  return bytes;
}

Bytes encode_animation(const Animation* a) {
  Writer w;
  w.put(static_cast<std::uint8_t>(a != nullptr));
  if (!a) return std::move(w.bytes);
  w.bytes.reserve(encoded_animation_bytes(a));
  w.put(a->clip_s);
  w.put_each(a->joints, [&w](const Joint& j) {
    w.put(j.parent);
    w.put(static_cast<std::uint32_t>(j.moves));
    w.put(j.matrix);
    w.put(j.translation);
    w.put(j.rotation);
    w.put(j.scale);
  });
  w.put_each(a->bindings, [&w](const JointBinding& b) {
    w.put(static_cast<std::uint32_t>(b.joint));
    w.put(b.joint_from_bind);
  });
  w.put(static_cast<std::uint32_t>(a->vertices.size()));
  for (const VertexBinding& v : a->vertices) w.put(v.binding);
  for (const VertexBinding& v : a->vertices) w.put(v.weight);
  w.put_each(a->morphs, [&w](const MorphSet& set) {
    w.put_list(set.rest_weights);
    for (const MorphTarget& t : set.targets) {
      w.put_list(t.vertex);
      w.put_values(t.position);
      w.put_values(t.normal);
      w.put_values(t.tangent);
    }
  });
  w.put_each(a->channels, [&w](const Channel& c) {
    w.put(c.target);
    w.put(static_cast<std::uint8_t>(c.path));
    w.put(static_cast<std::uint8_t>(c.interpolation));
    w.put_list(c.times);
    w.put_values(c.values);
  });
  return std::move(w.bytes);
}

Result<std::shared_ptr<const Animation>> decode_animation(const std::uint8_t* bytes,
                                                          std::size_t size,
                                                          std::size_t mesh_vertices) {
  Reader r(bytes, size);
  const auto present = r.get<std::uint8_t>();
  if (present > 1) return track_error("mark");
  auto a = std::make_shared<Animation>();
  if (present == 1) {
    a->clip_s = r.get<float>();
    if (!(a->clip_s > 0) || a->clip_s > limits::kMaxClipSeconds) return track_error("duration");
    if (auto ok = read_joints(r, *a); !ok) return ok.error();
    if (auto ok = read_vertices(r, *a, mesh_vertices); !ok) return ok.error();
    if (auto ok = read_morphs(r, *a); !ok) return ok.error();
    a->channels.resize(r.count(limits::kMaxChannels, kChannelBytes));
    for (Channel& c : a->channels) {
      if (auto ok = read_channel(r, *a, c); !ok) return ok.error();
    }
  }
  if (!r.at_end()) return make_error(ErrorId::kWireMalformed, "animation bytes do not add up");
  return std::shared_ptr<const Animation>(present == 1 ? std::move(a) : nullptr);
}

}  // namespace mirage
