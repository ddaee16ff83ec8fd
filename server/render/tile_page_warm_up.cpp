// Work that a driver would do with the first tile of a kind, done before any client waits.
#include <algorithm>
#include <set>

#include "protocol/impostor/sun_frame.h"
#include "protocol/impostor/tile_key.h"
#include "server/prepare/prepared_scene.h"
#include "server/render/gpu_scene.h"
#include "server/render/scene_shadow.h"
#include "server/render/tile_page.h"
#include "server/render/touching_depth.h"

namespace mirage {
namespace {

constexpr int kUsualTile = 128;  // texels; its targets are made in advance

// Returns everything about a mesh that decides its shaders and their state.
std::vector<NeedMask> look_of(const gl::GpuMesh& mesh, const std::vector<Material>& materials) {
  std::vector<NeedMask> out = {mesh.vertex_color()};
  for (const Primitive& p : mesh.primitives()) {
    const Material& m = materials[p.material];
    out.push_back(material_needs(m, mesh.vertex_color()));
    out.push_back(static_cast<NeedMask>(p.kind) << 8 | m.double_sided);
  }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace

Result<void> TilePageRenderer::warm_up_levels() {
  for (std::uint32_t i = 0; i < scene_->tile_lods.size(); ++i) {
    for (Path* path : {&lit_, &relit_}) {
      if (path == &relit_ && !can_relight(scene_->prepared->objects[i].needs)) continue;
      for (const gl::GpuMesh& lod : scene_->tile_lods[i]) {
        Result<void> compiled = path->meshes->warm_up(lod, scene_->materials(), false);
        if (!compiled) return compiled;
      }
    }
  }
  return {};
}

Result<void> TilePageRenderer::warm_up(int page_edge) {
  const Lighting& light = scene_->prepared->scene.lighting;
  if (const gl::ShadowMap* map = shadow_map_ ? shadow_map_->map_for(light) : nullptr) {
    shadow_.meshes->set_shadow(map, {});
    for (const gl::GpuMesh& mesh : scene_->meshes) {
      Result<void> compiled = shadow_.meshes->warm_up(mesh, scene_->materials(), false);
      if (!compiled) return compiled;
    }
  }
  for (std::uint32_t i = 0; i < scene_->meshes.size(); ++i) {
    for (Path* path : {&lit_, &relit_}) {
      if (path == &relit_ && !can_relight(scene_->prepared->objects[i].needs)) continue;
      Result<void> compiled = path->meshes->warm_up(scene_->meshes[i], scene_->materials(), false);
      if (!compiled) return compiled;
      if (path->ranges && (scene_->prepared->objects[i].needs & kNeedBlend)) {
        compiled = path->ranges->warm_up(scene_->meshes[i], scene_->materials(), false);
        if (!compiled) return compiled;
      }
    }
  }
  if (Result<void> compiled = warm_up_levels(); !compiled) return compiled;
  if (touching_) {
    if (Result<void> compiled = touching_->warm_up(); !compiled) return compiled;
  }
  const std::vector<Instance>& instances = scene_->prepared->scene.instances;
  std::vector<std::optional<std::uint32_t>> shown(
      scene_->meshes.size());  // one instance of each object
  for (std::uint32_t i = 0; i < instances.size(); ++i) {
    if (!shown[instances[i].object]) shown[instances[i].object] = i;
  }
  for (Path* path : {&lit_, &relit_}) {
    if (!prepare_targets(*path, page_edge, kUsualTile * fine_samples())) {
      return make_error(ErrorId::kGraphicsGl, "no framebuffer for tiles can be made",
                        "--gpu-mb takes more");
    }
  }
  // Tiles are drawn as well, because a driver finishes a shader with its first draw, from all bound
  // state. Layered tiles compile their shaders with the first of them: few clients ask for any.
  for (const std::uint8_t channels : {kLitTile, kRelitTile, kShadowTile, kCasterTile}) {
    std::set<std::vector<NeedMask>> drawn;
    for (std::uint32_t i = 0; i < scene_->meshes.size(); ++i) {
      if (!shown[i] || scene_->prepared->objects[i].radius <= 0) continue;
      const std::optional<TileJob> job = first_job(*shown[i], channels);
      if (!job || !drawn.insert(look_of(scene_->meshes[i], scene_->materials())).second) continue;
      PagePacker packer(page_edge);
      packer.add(tile_edge(job->key.size_class));
      if (!render({*job}, packer)) {
        return make_error(ErrorId::kGraphicsGl, "no framebuffer for tiles can be made",
                          "--gpu-mb takes more");
      }
    }
  }
  glFinish();
  return {};
}

std::optional<TileJob> TilePageRenderer::first_job(std::uint32_t index,
                                                   std::uint8_t channels) const {
  const Instance& instance = scene_->prepared->scene.instances[index];
  const ObjectDescription& object = scene_->prepared->objects[instance.object];
  const Lighting& light = scene_->prepared->scene.lighting;
  const bool shadow = channels == kShadowTile, relit = channels == kRelitTile;
  const bool lit_by_sun = shadow_map_ && (object.needs & kNeedLighting) && sun_of(light);
  if ((relit && !can_relight(object.needs)) || (shadow && !lit_by_sun) ||
      (channels == kCasterTile && !(shadow_map_ && object.casts()))) {
    return std::nullopt;
  }
  TileJob job;
  job.key.object = instance.object;
  job.key.channels = channels;
  job.key.phase = object.motion.moving() ? 1 : kStaticPhase;
  job.key.distance = {0, 2};
  if (shadow) {
    job.key.instance = index + 1;
    job.world = light;
  } else {
    job.lighting = object_lighting(light, instance.world_from_object, object.center, object.radius);
  }
  return job;
}

}  // namespace mirage
