#include "server/scene/gltf/influences.h"

#include <algorithm>
#include <cmath>

#include "server/scene/gltf/accessor_reader.h"
#include "server/scene/gltf/gltf_limits.h"

namespace mirage::gltf {
namespace {

using Attributes = std::map<std::string, int>;

int find(const Attributes& attributes, const std::string& semantic) {
  const auto found = attributes.find(semantic);
  return found == attributes.end() ? -1 : found->second;
}

void keep_heaviest(VertexBinding& v, std::uint16_t joint, float weight) {
  int lightest = 0;
  for (int i = 1; i < 4; ++i) {
    if (v.weight[i] < v.weight[lightest]) lightest = i;
  }
  if (weight <= v.weight[lightest]) return;
  v.weight[lightest] = weight;
  v.binding[lightest] = joint;
}

void normalise(VertexBinding& v) {
  const float sum = v.weight.x + v.weight.y + v.weight.z + v.weight.w;
  if (!(sum > 0)) return;
  v.weight /= sum;
  int heaviest = 0;
  for (int i = 1; i < 4; ++i) {
    if (v.weight[i] > v.weight[heaviest]) heaviest = i;
  }
  std::swap(v.weight[0], v.weight[heaviest]);
  std::swap(v.binding[0], v.binding[heaviest]);
}

/// Returns finite displacements of one attribute of a primitive's target; empty if it has none.
Result<std::vector<float>> deltas(const Document& document, const Attributes& target,
                                  const char* semantic, Tally& tally) {
  const int accessor = find(target, semantic);
  if (accessor < 0) return std::vector<float>{};
  auto values = read_floats(document, accessor, 3);
  if (!values) {
    auto ok = tally.forgive("morph targets that cannot be used left out", values.error());
    if (!ok) return ok.error();
    return std::vector<float>{};
  }
  for (float& v : *values) {
    if (!(std::abs(v) <= kMaxCoordinate)) v = 0;  // also for NaN
  }
  return values;
}

glm::vec3 at(const std::vector<float>& values, std::uint32_t vertex) {
  const std::size_t i = std::size_t{vertex} * 3;
  return i + 3 <= values.size() ? glm::vec3(values[i], values[i + 1], values[i + 2]) : glm::vec3(0);
}

}  // namespace

Result<std::vector<VertexBinding>> read_influences(const Document& document,
                                                   const Attributes& attributes,
                                                   std::uint32_t joints, Tally& tally) {
  std::vector<VertexBinding> out;
  for (const char* set : {"_0", "_1"}) {
    const int joint_accessor = find(attributes, std::string("JOINTS") + set);
    const int weight_accessor = find(attributes, std::string("WEIGHTS") + set);
    if (joint_accessor < 0 || weight_accessor < 0) continue;
    auto index = read_unsigned(document, joint_accessor, 4);
    auto weight = read_floats(document, weight_accessor, 4);
    if (!index || !weight) {
      auto ok = tally.forgive("primitives with broken joints or weights left unskinned",
                              index ? weight.error() : index.error());
      if (!ok) return ok.error();
      return std::vector<VertexBinding>{};
    }
    const std::size_t count = std::min(index->size(), weight->size());
    VertexBinding none;
    none.weight = glm::vec4(0);
    out.resize(std::max(out.size(), count / 4), none);
    for (std::size_t i = 0; i < count; ++i) {
      const float w = (*weight)[i];
      if (w == 0) continue;
      if ((*index)[i] >= joints || !(w > 0) || !std::isfinite(w)) {
        tally.add("primitives with broken joints or weights left unskinned");
        return std::vector<VertexBinding>{};
      }
      keep_heaviest(out[i / 4], static_cast<std::uint16_t>((*index)[i]), w);
    }
  }
  for (VertexBinding& v : out) normalise(v);
  return out;
}

Result<MorphTarget> read_target(const Document& document, const tinygltf::Mesh& mesh,
                                std::size_t target, const std::vector<VertexOrigin>& origins,
                                std::size_t first_vertex, Tally& tally) {
  struct Deltas {
    std::vector<float> position, normal, tangent;
  };
  std::vector<Deltas> per_primitive(mesh.primitives.size());
  for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
    if (target >= mesh.primitives[p].targets.size()) continue;
    const Attributes& attributes = mesh.primitives[p].targets[target];
    std::vector<float>* lists[3] = {&per_primitive[p].position, &per_primitive[p].normal,
                                    &per_primitive[p].tangent};
    const char* names[3] = {"POSITION", "NORMAL", "TANGENT"};
    for (int i = 0; i < 3; ++i) {
      auto values = deltas(document, attributes, names[i], tally);
      if (!values) return values.error();
      *lists[i] = values.take();
    }
  }
  MorphTarget out;
  for (std::size_t i = 0; i < origins.size(); ++i) {
    const Deltas& d = per_primitive[origins[i].primitive];
    const glm::vec3 position = at(d.position, origins[i].vertex);
    const glm::vec3 normal = at(d.normal, origins[i].vertex);
    const glm::vec3 tangent = at(d.tangent, origins[i].vertex);
    const glm::vec3 none(0);
    if (position == none && normal == none && tangent == none) continue;
    out.vertex.push_back(static_cast<std::uint32_t>(first_vertex + i));
    out.position.push_back(position);
    out.normal.push_back(normal);
    out.tangent.push_back(tangent);
  }
  return out;
}

}  // namespace mirage::gltf
