#include "server/prepare/object_geometry.h"

#include <map>

#include "protocol/codec/tile_codec.h"
#include "protocol/impostor/lod.h"
#include "protocol/impostor/object_proxy.h"
#include "server/lod/lod.h"
#include "server/lod/lod_family.h"
#include "server/scene/scene.h"

namespace mirage {
namespace {

/// The primitives of a mesh, with only the materials they use.
struct UsedMaterials {
  std::vector<Primitive> primitives;  ///< their `material` indexes `materials`
  std::vector<Material> materials;
};

UsedMaterials used_materials(const Scene& scene, const Mesh& mesh) {
  UsedMaterials out{mesh.primitives, {}};
  std::map<std::uint32_t, std::uint32_t> material_index;
  for (Primitive& p : out.primitives) {
    const auto [at, is_new] =
        material_index.emplace(p.material, static_cast<std::uint32_t>(out.materials.size()));
    if (is_new) out.materials.push_back(scene.materials[p.material]);
    p.material = at->second;
  }
  return out;
}

EncodedLod encode_lod(const ModelView& model) {
  EncodedLod out;
  out.payload = encode_model(model);
  out.raw_bytes = static_cast<std::uint32_t>(out.payload.size());
  Bytes packed = compress_block(out.payload.data(), out.payload.size());
  if (!packed.empty() && packed.size() < out.payload.size()) out.payload = std::move(packed);
  return out;
}

std::uint32_t triangles_of(const Mesh& mesh) {
  std::uint32_t count = 0;
  for (const Primitive& p : mesh.primitives) {
    if (p.kind == PrimitiveKind::kTriangles) count += p.index_count / 3;
  }
  return count;
}

}  // namespace

ObjectModel object_model(const Scene& scene, const Mesh& mesh) {
  ObjectModel model;
  model.mesh = mesh;
  UsedMaterials used = used_materials(scene, mesh);
  model.mesh.primitives = std::move(used.primitives);
  model.materials = std::move(used.materials);
  return model;
}

ObjectGeometry make_geometry(const Scene& scene, const SceneObject& object,
                             ObjectDescription& description, const LodFamilies* families,
                             const Workers& workers) {
  const auto encode = [&](const Mesh& mesh) {
    const UsedMaterials used = used_materials(scene, mesh);
    return encode_lod({mesh, used.primitives, used.materials, object.animation.get()});
  };
  EncodedLod whole;
  std::vector<MeshLod> lods;
  workers.both(
      [&] {
        if (object.animation) return;  // simplified poses have no error bound
        lods = families && families->first_of(object)
                   ? families->lods_of(object, workers)
                   : build_lods(object.mesh, scene.materials, scene.images, workers);
      },
      [&] { whole = encode(object.mesh); });
  ObjectGeometry out;
  out.tile_lods.resize(1 + lods.size());
  out.encoded.resize(1 + lods.size());
  out.encoded[0] = std::move(whole);
  workers.each(lods.size(), [&](std::size_t i) { out.encoded[1 + i] = encode(lods[i].mesh); });
  const auto step =
      static_cast<float>(quantisation_error(description.box_min, description.box_max));
  for (std::size_t i = 0; i <= lods.size(); ++i) {
    LodInfo info;
    info.triangles = triangles_of(i == 0 ? object.mesh : lods[i - 1].mesh);
    info.bytes = static_cast<std::uint32_t>(out.encoded[i].payload.size());
    info.error = (i == 0 ? 0.0f : lods[i - 1].error) + step;
    info.spread = i == 0 ? 0.0f : lods[i - 1].spread;
    info.shading = i == 0 ? 0.0f : lods[i - 1].shading;
    description.lods.push_back(info);
    if (i > 0) out.tile_lods[i] = std::move(lods[i - 1].mesh);
  }
  return out;
}

}  // namespace mirage
