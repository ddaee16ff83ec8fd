#include "server/scene/gltf/mesh_import.h"

#include <map>
#include <numeric>

#include "server/scene/gltf/mesh_assemble.h"

namespace mirage::gltf {
namespace {

bool uses_missing_uv(const Material& material, const RawPrimitive& raw) {
  bool missing = false;
  material.each_map([&](const TextureRef& ref) {
    missing = missing || (ref.present() && (ref.uv_set == 0 ? raw.uv0.empty() : raw.uv1.empty()));
  });
  return missing;
}

// Gives the primitive the two sets of texture coordinates that its material reads.
Result<UvPlan> settle_uv_sets(const Document& document, const tinygltf::Primitive& source,
                              const Material& material, Tally& tally, RawPrimitive& raw) {
  std::map<int, std::vector<glm::vec2>> sets;
  for (const int set : uv_sets_read(material)) {
    if (set <= 1) continue;
    auto read = read_uv_set(document, source, set, raw, tally);
    if (!read) return read.error();
    sets.emplace(set, read.take());
  }
  if (sets.empty()) return UvPlan{};
  sets.emplace(0, raw.uv0);
  sets.emplace(1, raw.uv1);
  UvPlan plan = plan_uv_sets(material, [&](int set) { return sets.at(set); });
  raw.uv0 = sets.at(plan.kept[0]);
  raw.uv1 = sets.at(plan.kept[1]);
  return plan;
}

}  // namespace

Result<void> Budget::take(std::uint64_t vertices, std::uint64_t indices) {
  vertices_ += vertices;
  indices_ += indices;
  if (vertices_ > limits_.vertices) {
    return limits_.exceeded_at_least(vertices_, limits_.vertices, "vertices");
  }
  if (indices_ > limits_.indices) {
    return limits_.exceeded_at_least(indices_, limits_.indices, "indices");
  }
  return {};
}

Result<void> Budget::take_primitives(std::uint64_t count) {
  primitives_ += count;
  if (primitives_ <= limits_.primitives) return {};
  return limits_.exceeded_at_least(primitives_, limits_.primitives, "primitives", "join IN OUT");
}

void Budget::give_back(std::uint64_t vertices, std::uint64_t indices) {
  vertices_ -= vertices;
  indices_ -= indices;
}

Result<Mesh> import_mesh(const Document& document, int mesh, const Pose& pose,
                         MaterialImporter& materials, Budget& budget, Tally& tally,
                         std::vector<VertexOrigin>* origins) {
  Mesh out;
  std::uint32_t number = 0;
  for (const tinygltf::Primitive& source : document.model.meshes[mesh].primitives) {
    const std::uint32_t primitive = number++;
    auto raw = read_primitive(document, source, pose, tally);
    if (!raw) {
      const Error named = make_error(raw.error().id,
                                     "meshes[" + std::to_string(mesh) + "].primitives[" +
                                         std::to_string(primitive) + "]: " + raw.error().text,
                                     raw.error().hint);
      if (named.id == ErrorId::kSceneLimit) return named;
      auto ok = tally.lose("primitives that cannot be used left out", named);
      if (!ok) return ok.error();
      continue;
    }
    if (raw->indices.empty()) continue;
    const std::uint64_t vertices = vertices_needed(*raw);
    const std::uint64_t indices = raw->indices.size();
    if (auto ok = budget.take(vertices, indices); !ok) return ok.error();
    if (auto ok = budget.take_primitives(1); !ok) return ok.error();

    Without without;
    without.lighting = raw->kind != PrimitiveKind::kTriangles && raw->normal.empty();
    without.anisotropy = !has_tangents(*raw);
    const auto plan =
        settle_uv_sets(document, source, materials.as_in_file(source.material), tally, *raw);
    if (!plan) return plan.error();
    const std::uint32_t material = materials.index_of(source.material, without, *plan);
    const Material& used = materials.materials()[material];
    if (uses_missing_uv(used, *raw)) {
      tally.add("primitives lack the texture coordinates of their material");
    }
    const std::size_t vertices_before = out.vertices.size();
    const std::size_t indices_before = out.indices.size();
    if (origins != nullptr) {
      raw->source.resize(raw->position.size());
      std::iota(raw->source.begin(), raw->source.end(), 0u);
    }
    append_primitive(*raw, material, used.reads_tangents(), tally, out);
    if (origins != nullptr && out.vertices.size() > vertices_before) {
      for (const std::uint32_t vertex : raw->source) origins->push_back({primitive, vertex});
    }
    budget.give_back(vertices - (out.vertices.size() - vertices_before),
                     indices - (out.indices.size() - indices_before));
  }
  return out;
}

}  // namespace mirage::gltf
