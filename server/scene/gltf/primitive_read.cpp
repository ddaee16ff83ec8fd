#include "server/scene/gltf/primitive_read.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "server/scene/gltf/accessor_reader.h"
#include "server/scene/gltf/gltf_limits.h"

namespace mirage::gltf {
namespace {

using Attributes = std::map<std::string, int>;

constexpr std::string_view kUnskinned = "primitives with broken joints or weights left unskinned";

int find(const Attributes& attributes, const char* semantic) {
  const auto found = attributes.find(semantic);
  return found == attributes.end() ? -1 : found->second;
}

/// Reads an optional attribute into `out`, converting each element with `make(const float*)`.
template <typename T, typename Make>
Result<void> read_into(const Document& document, int accessor, std::size_t components, Make make,
                       std::vector<T>& out) {
  if (accessor < 0) return {};
  auto values = read_floats(document, accessor, components);
  if (!values) return values.error();
  const std::size_t count = values->size() / components;
  out.resize(count);
  for (std::size_t i = 0; i < count; ++i) out[i] = make(&(*values)[i * components]);
  return {};
}

glm::vec3 make_vec3(const float* v) { return {v[0], v[1], v[2]}; }
glm::vec4 make_vec4(const float* v) { return {v[0], v[1], v[2], v[3]}; }

std::uint16_t unorm16(float value) {
  // NaN compares as false and becomes 0.
  const float clamped = value > 0 ? std::min(value, 1.0f) : 0.0f;
  return static_cast<std::uint16_t>(clamped * 65535.0f + 0.5f);
}

Result<void> read_color(const Document& document, int accessor, std::vector<glm::u16vec4>& out) {
  if (accessor < 0) return {};
  if (document.model.accessors[accessor].type == TINYGLTF_TYPE_VEC3) {
    auto make = [](const float* v) {
      return glm::u16vec4(unorm16(v[0]), unorm16(v[1]), unorm16(v[2]), 65535);
    };
    return read_into(document, accessor, 3, make, out);
  }
  auto make = [](const float* v) {
    return glm::u16vec4(unorm16(v[0]), unorm16(v[1]), unorm16(v[2]), unorm16(v[3]));
  };
  return read_into(document, accessor, 4, make, out);
}

Result<void> read_uv(const Document& document, int accessor, Tally& tally,
                     std::vector<glm::vec2>& out) {
  std::uint64_t bad = 0;
  auto component = [&bad](float value) {
    if (std::abs(value) <= kMaxTextureCoordinate) return value;  // false for NaN
    ++bad;
    return 0.0f;
  };
  auto make = [&](const float* v) { return glm::vec2(component(v[0]), component(v[1])); };
  auto ok = read_into(document, accessor, 2, make, out);
  tally.add("texture coordinates that are not finite set to 0", bad);
  return ok;
}

/// Leaves out an attribute that could not be read, or has not one element for each vertex.
template <typename T>
Result<void> keep_usable(const Result<void>& read, const char* semantic, const RawPrimitive& raw,
                         Tally& tally, std::vector<T>& values) {
  if (read && (values.empty() || values.size() == raw.position.size())) return {};
  const Error why =
      read ? make_error(ErrorId::kSceneRange,
                        std::string("has ") + semantic + " of " + std::to_string(values.size()) +
                            " elements beside " + std::to_string(raw.position.size()))
           : make_error(read.error().id, std::string(semantic) + ": " + read.error().text);
  values.clear();
  return tally.lose("vertex attributes that cannot be used left out", why);
}

Result<void> read_attributes(const Document& document, const Attributes& attributes, Tally& tally,
                             RawPrimitive& raw) {
  auto ok = read_into(document, find(attributes, "POSITION"), 3, make_vec3, raw.position);
  if (!ok) return ok;
  const auto keep = [&](const Result<void>& read, const char* semantic, auto& values) {
    return keep_usable(read, semantic, raw, tally, values);
  };
  const auto place = [&](const char* semantic) { return find(attributes, semantic); };
  ok = keep(read_into(document, place("NORMAL"), 3, make_vec3, raw.normal), "NORMAL", raw.normal);
  if (!ok) return ok;
  ok = keep(read_into(document, place("TANGENT"), 4, make_vec4, raw.tangent), "TANGENT",
            raw.tangent);
  if (!ok) return ok;
  ok = keep(read_uv(document, place("TEXCOORD_0"), tally, raw.uv0), "TEXCOORD_0", raw.uv0);
  if (!ok) return ok;
  ok = keep(read_uv(document, place("TEXCOORD_1"), tally, raw.uv1), "TEXCOORD_1", raw.uv1);
  if (!ok) return ok;
  return keep(read_color(document, place("COLOR_0"), raw.color), "COLOR_0", raw.color);
}

/// Adds weight * delta of one morph target to positions, normals and tangents.
Result<void> apply_target(const Document& document, const Attributes& target, double weight,
                          RawPrimitive& raw) {
  std::vector<glm::vec3> delta;
  const auto scale = static_cast<float>(weight);
  auto add = [&](const char* semantic, auto& base) -> Result<void> {
    delta.clear();
    auto ok = read_into(document, find(target, semantic), 3, make_vec3, delta);
    if (!ok) return ok;
    if (!delta.empty() && delta.size() != raw.position.size()) {
      return make_error(ErrorId::kSceneRange,
                        std::string("has ") + semantic + " of " + std::to_string(delta.size()) +
                            " elements beside " + std::to_string(raw.position.size()));
    }
    for (std::size_t i = 0; i < std::min(delta.size(), base.size()); ++i) {
      for (int c = 0; c < 3; ++c) base[i][c] += scale * delta[i][c];
    }
    return {};
  };
  if (auto ok = add("POSITION", raw.position); !ok) return ok;
  if (auto ok = add("NORMAL", raw.normal); !ok) return ok;
  return add("TANGENT", raw.tangent);
}

/// The summed skin matrix of each vertex, from all JOINTS_n / WEIGHTS_n pairs; `broken` if a joint
/// does not exist or a weight is impossible.
struct Skinning {
  std::vector<glm::dmat4> matrix;
  std::vector<double> weight;
  bool broken = false;
};

Result<void> add_influences(const Document& document, int joints_accessor, int weights_accessor,
                            const Pose& pose, Skinning& skinning) {
  auto joints = read_unsigned(document, joints_accessor, 4);
  if (!joints) return joints.error();
  auto weights = read_floats(document, weights_accessor, 4);
  if (!weights) return weights.error();
  const std::size_t needed = 4 * skinning.matrix.size();
  if (joints->size() != needed || weights->size() != needed) {
    return make_error(ErrorId::kSceneRange, "has joints or weights of other counts than POSITION");
  }
  for (std::size_t i = 0; i < std::min(joints->size(), weights->size()); ++i) {
    const double weight = (*weights)[i];
    if (weight == 0) continue;
    const std::uint32_t joint = (*joints)[i];
    if (joint >= pose.joint_matrices.size() || !(weight > 0) || !std::isfinite(weight)) {
      skinning.broken = true;
      return {};
    }
    skinning.matrix[i / 4] += weight * pose.joint_matrices[joint];
    skinning.weight[i / 4] += weight;
  }
  return {};
}

Result<void> apply_skin(const Document& document, const Attributes& attributes, const Pose& pose,
                        Tally& tally, RawPrimitive& raw) {
  Skinning skinning;
  skinning.matrix.assign(raw.position.size(), glm::dmat4(0));
  skinning.weight.assign(raw.position.size(), 0.0);
  for (const char* set : {"_0", "_1"}) {
    const int joints = find(attributes, (std::string("JOINTS") + set).c_str());
    const int weights = find(attributes, (std::string("WEIGHTS") + set).c_str());
    if (joints < 0 || weights < 0) continue;
    const auto added = add_influences(document, joints, weights, pose, skinning);
    if (added) continue;
    if (auto ok = tally.forgive(kUnskinned, added.error()); !ok) return ok;
    return {};
  }
  if (skinning.broken) {
    tally.add(kUnskinned);
    return {};
  }
  for (std::size_t i = 0; i < raw.position.size(); ++i) {
    if (skinning.weight[i] <= 0) continue;
    const glm::dmat4 matrix = skinning.matrix[i] / skinning.weight[i];
    const glm::dmat3 linear(matrix);
    raw.position[i] = glm::vec3(glm::dvec3(matrix * glm::dvec4(raw.position[i], 1.0)));
    // Joints are nearly rigid in practice, so their linear part also serves for normals, which are
    // normalised later.
    if (!raw.normal.empty()) raw.normal[i] = glm::vec3(linear * glm::dvec3(raw.normal[i]));
    if (!raw.tangent.empty()) {
      const glm::dvec3 turned = linear * glm::dvec3(raw.tangent[i]);
      raw.tangent[i] = glm::vec4(glm::vec3(turned), raw.tangent[i].w);
    }
  }
  return {};
}

PrimitiveKind kind_of(int mode) {
  if (mode == TINYGLTF_MODE_POINTS) return PrimitiveKind::kPoints;
  if (mode == TINYGLTF_MODE_LINE || mode == TINYGLTF_MODE_LINE_LOOP ||
      mode == TINYGLTF_MODE_LINE_STRIP) {
    return PrimitiveKind::kLines;
  }
  return PrimitiveKind::kTriangles;
}

Result<void> read_indices(const Document& document, const tinygltf::Primitive& source, int mode,
                          RawPrimitive& raw) {
  std::vector<std::uint32_t> indices;
  if (source.indices >= 0) {
    auto list = read_unsigned(document, source.indices, 1);
    if (!list) return list.error();
    indices = list.take();
  } else {
    indices.resize(raw.position.size());
    std::iota(indices.begin(), indices.end(), 0u);
  }
  if (const std::uint64_t most = document.limits.indices / 3; indices.size() > most) {
    return document.limits.exceeded(indices.size(), most, "indices in one primitive");
  }
  raw.indices = expand_indices(std::move(indices), mode);
  return {};
}

}  // namespace

std::vector<std::uint32_t> expand_indices(std::vector<std::uint32_t> indices, int mode) {
  const std::size_t count = indices.size();
  std::vector<std::uint32_t> out;
  switch (mode) {
    case TINYGLTF_MODE_LINE:
      indices.resize(count / 2 * 2);
      return indices;
    case TINYGLTF_MODE_TRIANGLES:
      indices.resize(count / 3 * 3);
      return indices;
    case TINYGLTF_MODE_LINE_STRIP:
    case TINYGLTF_MODE_LINE_LOOP:
      for (std::size_t i = 0; i + 1 < count; ++i) {
        out.insert(out.end(), {indices[i], indices[i + 1]});
      }
      if (mode == TINYGLTF_MODE_LINE_LOOP && count > 1) {
        out.insert(out.end(), {indices[count - 1], indices[0]});
      }
      return out;
    case TINYGLTF_MODE_TRIANGLE_STRIP:
      for (std::size_t i = 0; i + 2 < count; ++i) {
        // Every other triangle of a strip runs backwards, so two of its corners swap.
        const std::size_t odd = i % 2;
        out.insert(out.end(), {indices[i], indices[i + 1 + odd], indices[i + 2 - odd]});
      }
      return out;
    case TINYGLTF_MODE_TRIANGLE_FAN:
      for (std::size_t i = 1; i + 1 < count; ++i) {
        out.insert(out.end(), {indices[i], indices[i + 1], indices[0]});
      }
      return out;
    default:
      return indices;
  }
}

Result<RawPrimitive> read_primitive(const Document& document, const tinygltf::Primitive& source,
                                    const Pose& pose, Tally& tally) {
  RawPrimitive raw;
  const int mode = source.mode < 0 ? TINYGLTF_MODE_TRIANGLES : source.mode;
  if (mode > TINYGLTF_MODE_TRIANGLE_FAN) {
    return make_error(ErrorId::kSceneFormat, "mode = " + std::to_string(mode));
  }
  raw.kind = kind_of(mode);
  const int position = find(source.attributes, "POSITION");
  if (position < 0) {
    tally.add("primitives without POSITION left out");
    return raw;
  }
  const std::size_t vertices = document.model.accessors[position].count;
  if (vertices > document.limits.vertices) {
    return document.limits.exceeded(vertices, document.limits.vertices, "vertices");
  }
  if (auto ok = read_attributes(document, source.attributes, tally, raw); !ok) return ok.error();
  for (std::size_t i = 0; i < std::min(pose.weights.size(), source.targets.size()); ++i) {
    if (pose.weights[i] == 0) continue;
    const auto applied = apply_target(document, source.targets[i], pose.weights[i], raw);
    if (applied) continue;
    auto ok = tally.forgive("morph targets that cannot be used left out", applied.error());
    if (!ok) return ok.error();
  }
  if (!pose.joint_matrices.empty()) {
    if (auto ok = apply_skin(document, source.attributes, pose, tally, raw); !ok) return ok.error();
  }
  if (auto ok = read_indices(document, source, mode, raw); !ok) return ok.error();
  return raw;
}

Result<std::vector<glm::vec2>> read_uv_set(const Document& document,
                                           const tinygltf::Primitive& source, int set,
                                           const RawPrimitive& raw, Tally& tally) {
  std::vector<glm::vec2> out;
  const std::string semantic = "TEXCOORD_" + std::to_string(set);
  const auto read = read_uv(document, find(source.attributes, semantic.c_str()), tally, out);
  auto ok = keep_usable(read, semantic.c_str(), raw, tally, out);
  if (!ok) return ok.error();
  return out;
}

}  // namespace mirage::gltf
