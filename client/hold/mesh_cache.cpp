#include "client/hold/mesh_cache.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "client/scene/scene_view.h"
#include "protocol/base/order.h"
#include "protocol/codec/image_codec.h"
#include "protocol/codec/model_codec.h"
#include "protocol/impostor/camera.h"
#include "protocol/impostor/instance_group.h"
#include "protocol/model/need_mask.h"

namespace mirage {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::int64_t kMeshKeptUs = 10'000'000;   // time since it was last needed
constexpr std::int64_t kImageKeptUs = 30'000'000;  // longer: images are smaller, and shared
constexpr std::int64_t kPinnedUs = 500'000;        // needed this recently: still in use
// The first level of an object may have an error of this many times tau. Thinned foliage, which
// would show slabs for leaves, may have less.
constexpr double kCoarseExcess = 16, kCoarseThinnedExcess = 4;
// Share of the needed level's bytes; a larger coarse level is not worth it.
constexpr double kCoarseShare = 0.5;
constexpr double kTexelsPerPixel = 1.5;  // down to this many texels a pixel a level is sharp enough
constexpr double kNearest = 0.01;        // share of the radius; distances count as at least this
// FLIP of a surface that shows its mean colour instead of its images: about that of a view tile.
constexpr double kNoImageFlip = 0.1;
constexpr std::size_t kReplyBytes = 64;  // of a reply, beside its payload

constexpr NeedMask kMapNeeds[] = {kNeedBaseColorMap, kNeedMetalRoughMap, kNeedNormalMap,
                                  kNeedOcclusionMap, kNeedEmissiveMap};
constexpr double kLargestGuess = 1024;  // texels along an edge

// Returns the coarsest level with a texel for each pixel, if the whole image lies over 1 /
// uv_per_unit object units.
int needed_level(const ImageDescription& image, const ImageUse& use, double px_per_unit) {
  const double edge = std::max(image.width, image.height);
  const double needed_edge =
      use.uv_per_unit > 0 ? kTexelsPerPixel * px_per_unit / use.uv_per_unit : edge;
  int level = 0;
  while (level + 1 < image_levels(image)) {
    const glm::uvec2 size = image_level_size(image, static_cast<std::uint8_t>(level));
    if (std::max(size.x, size.y) >= needed_edge) break;
    ++level;
  }
  return level;
}

// Returns places of the vertices at which the surface is drawn, object units, a list for each of a
// few poses. Bind space may have another unit than object space.
std::vector<std::vector<glm::vec3>> drawn_positions(const ObjectModel& model) {
  std::vector<std::vector<glm::vec3>> out;
  if (model.animation) {
    for (const double part : {0.0, 0.5}) {
      pose_positions(model.mesh.vertices, *model.animation, part * double{model.animation->clip_s},
                     out.emplace_back());
    }
    return out;
  }
  out.emplace_back().reserve(model.mesh.vertices.size());
  for (const Vertex& v : model.mesh.vertices) out.back().push_back(v.position);
  return out;
}

// Returns 0 without a surface.
double median_uv_per_unit(const Mesh& mesh, const std::vector<glm::vec3>& positions,
                          const Primitive& p, const TextureRef& map) {
  std::vector<double> ratios;
  const std::uint32_t step = 3 * std::max(1u, p.index_count / 3 / 512);
  for (std::uint32_t i = 0; i + 2 < p.index_count; i += step) {
    const std::uint32_t* corner = &mesh.indices[p.first_index + i];
    const auto uv = [&](int k) {
      const Vertex& v = mesh.vertices[corner[k]];
      return (map.uv_set == 1 ? v.uv1 : v.uv0) * map.scale;
    };
    const auto side = [&](int k) { return positions[corner[k]] - positions[corner[0]]; };
    const glm::vec2 a = uv(1) - uv(0), b = uv(2) - uv(0);
    const double uv_area = std::abs(double{a.x} * b.y - double{a.y} * b.x);
    const double area = double{glm::length(glm::cross(side(1), side(2)))};
    if (area > 0) ratios.push_back(std::sqrt(uv_area / area));
  }
  if (ratios.empty()) return 0;
  std::nth_element(ratios.begin(), ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2),
                   ratios.end());
  return ratios[ratios.size() / 2];
}

}  // namespace

std::vector<ImageUse> image_uses(const ObjectModel& model) {
  std::map<std::uint32_t, ImageUse> uses;
  const std::vector<std::vector<glm::vec3>> poses = drawn_positions(model);
  for (const Primitive& p : model.mesh.primitives) {
    const Material& m = model.materials[p.material];
    m.each_map([&](const TextureRef& map) {
      if (!map.present()) return;
      const auto image = static_cast<std::uint32_t>(map.image);
      ImageUse& use = uses[image];
      use.image = image;
      // The use that spreads the image over the largest surface needs the most texels.
      for (const std::vector<glm::vec3>& positions : poses) {
        const double density = median_uv_per_unit(model.mesh, positions, p, map);
        if (!(density > 0)) continue;
        use.uv_per_unit = use.uv_per_unit > 0 ? std::min(use.uv_per_unit, density) : density;
      }
      use.masks = use.masks || (&map == &m.base_color_map && m.alpha_mode == AlphaMode::kMask);
    });
  }
  std::vector<ImageUse> out;
  out.reserve(uses.size());
  for (const auto& [image, use] : uses) out.push_back(use);
  return out;
}

std::size_t expected_gpu_bytes(const LodInfo& lod) {
  // A triangle takes three indices and about 0.7 vertices.
  return lod.triangles * (3 * sizeof(std::uint32_t) + 7 * sizeof(Vertex) / 10);
}

std::size_t mesh_gpu_bytes(const Mesh& mesh) {
  return mesh.vertices.size() * sizeof(Vertex) + mesh.indices.size() * sizeof(std::uint32_t);
}

std::size_t image_gpu_bytes(const glm::uvec2& size) {
  return std::size_t{size.x} * size.y * 4 * 4 / 3;
}

double px_per_unit(const SceneView& scene, const Camera& camera, std::uint32_t instance) {
  const InstanceView& view = scene.instances[instance];
  const ObjectDescription& object = scene.objects[view.object];
  const double scale = view.world_from_object.scale;
  const glm::dvec3 to_eye = camera.pose.eye - view.center;
  const glm::dvec3 eye =
      glm::dvec3(object.center) +
      glm::conjugate(glm::dquat(view.world_from_object.rotation)) * to_eye / scale;
  // The box lies closer around flat things (a terrain) than the sphere does.
  const glm::dvec3 outside = glm::max(
      glm::max(glm::dvec3(object.box_min) - eye, eye - glm::dvec3(object.box_max)), glm::dvec3(0));
  const double to_sphere = glm::length(to_eye) / scale - double{object.radius};
  const double nearest =
      std::max({glm::length(outside), to_sphere, kNearest * double{object.radius}});
  return camera.focal_px() / nearest / tolerance(view.importance);
}

void MeshCache::reset(const SceneView& scene, std::size_t budget_bytes,
                      std::size_t max_reply_bytes) {
  *this = MeshCache{};
  budget_ = budget_bytes;
  max_reply_bytes_ = max_reply_bytes;
  images_.resize(scene.images.size());
  grow(scene);
}

void MeshCache::grow(const SceneView& scene) {
  const std::size_t known = objects_.size();
  objects_.resize(scene.objects.size());
  for (std::size_t i = known; i < objects_.size(); ++i) {
    objects_[i].lods.resize(scene.objects[i].lods.size());
  }
  ready_.resize(scene.objects.size(), false);
}

bool MeshCache::resident(const AssetId& id) const {
  if (id.kind == AssetId::Kind::kMesh) {
    return id.index < objects_.size() && id.level < objects_[id.index].lods.size() &&
           objects_[id.index].lods[id.level].resident;
  }
  return id.index < images_.size() && images_[id.index].level == id.level;
}

void MeshCache::update_ready(std::uint32_t index) {
  const Object& object = objects_[index];
  const bool any = std::any_of(object.lods.begin(), object.lods.end(),
                               [](const Level& level) { return level.resident; });
  const bool masks = std::all_of(object.uses.begin(), object.uses.end(), [&](const ImageUse& use) {
    return !use.masks || images_[use.image].level >= 0;
  });
  ready_[index] = any && masks;
}

std::optional<std::size_t> MeshCache::level(const SceneView& scene, const Camera& camera,
                                            double tau_px, std::uint32_t instance) const {
  const std::uint32_t index = scene.instances[instance].object;
  const std::vector<Level>& lods = objects_[index].lods;
  const std::size_t fit =
      lod_for_view(scene.objects[index].lods, px_per_unit(scene, camera, instance), tau_px);
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < lods.size(); ++i) {
    if (!lods[i].resident) continue;
    // All levels at least as fine as needed look the same, so take the coarsest of them. If all are
    // coarser than needed, take the finest.
    if (i <= fit || !best) best = i;
  }
  return best;
}

void MeshCache::choose(const SceneView& scene, const Camera& camera, double tau_px,
                       std::uint64_t frame, std::int64_t now_us, std::vector<DrawnMesh>& meshes) {
  for (DrawnMesh& mesh : meshes) {
    const std::optional<std::size_t> best = level(scene, camera, tau_px, mesh.instance);
    mesh.lod = static_cast<std::uint8_t>(best.value_or(0));
  }
  mark_drawn(scene, frame, now_us, meshes);
}

void MeshCache::mark_drawn(const SceneView& scene, std::uint64_t frame, std::int64_t now_us,
                           std::vector<DrawnMesh>& meshes) {
  for (DrawnMesh& mesh : meshes) {
    Object& object = objects_[scene.instances[mesh.instance].object];
    object.lods[mesh.lod].drawn_frame = frame;
    object.lods[mesh.lod].needed_us = now_us;
    for (const ImageUse& use : object.uses) {
      mesh.plain = mesh.plain || images_[use.image].level < 0;
      images_[use.image].held.drawn_frame = frame;
      images_[use.image].held.needed_us = now_us;
    }
  }
}

double MeshCache::price_bytes(const SceneView& scene, const Camera& camera, double tau_px,
                              std::uint32_t instance) const {
  const std::uint32_t index = scene.instances[instance].object;
  const ObjectDescription& description = scene.objects[index];
  const Object& object = objects_[index];
  const double density = px_per_unit(scene, camera, instance);
  const std::size_t lod = lod_for_view(description.lods, density, tau_px);
  double bytes = 0;
  const bool here = std::any_of(object.lods.begin(), object.lods.begin() + lod + 1,
                                [](const Level& level) { return level.resident; });
  if (!here) bytes += description.lods[lod].bytes;
  if (object.known_uses) {
    for (const ImageUse& use : object.uses) {
      const int level = needed_level(scene.images[use.image], use, density);
      if (level <= images_[use.image].level) continue;
      const glm::uvec2 size =
          image_level_size(scene.images[use.image], static_cast<std::uint8_t>(level));
      bytes += image_bytes_per_texel_ * size.x * size.y;
    }
    return bytes;
  }
  // The estimate: each map goes once around the object, about three times its diameter in pixels.
  const double edge = std::min(3 * 2 * density * description.radius, kLargestGuess);
  for (const NeedMask map : kMapNeeds) {
    if (description.needs & map) bytes += image_bytes_per_texel_ * edge * edge;
  }
  return bytes;
}

bool MeshCache::fits(std::size_t more_bytes, std::int64_t now_us) const {
  std::size_t pinned = more_bytes;
  const auto add = [&](const Level& level) {
    if (level.resident && now_us - level.needed_us < kPinnedUs) pinned += level.bytes;
  };
  for (const Object& object : objects_) {
    for (const Level& level : object.lods) add(level);
  }
  for (const ImageState& image : images_) add(image.held);
  return pinned <= budget_;
}

void MeshCache::need_mesh(const SceneView& scene, const MeshWant& want, double tau_px,
                          std::int64_t now_us, std::vector<AssetNeed>& out) {
  const std::vector<LodInfo>& lods = scene.objects[want.object].lods;
  Object& object = objects_[want.object];
  if (lods.empty()) return;
  std::size_t lod = lod_for_view(lods, want.px_per_unit, tau_px);
  const auto allowed = [&](std::size_t i) {
    return lods[i].bytes <= max_reply_bytes_ &&
           (object.lods[i].resident || fits(expected_gpu_bytes(lods[i]), now_us));
  };
  while (lod < lods.size() && !allowed(lod)) ++lod;
  if (lod == lods.size()) return;
  object.lods[lod].needed_us = now_us;
  if (object.lods[lod].resident) return;
  const auto here = std::find_if(object.lods.begin(), object.lods.end(),
                                 [](const Level& level) { return level.resident; });
  const bool none = here == object.lods.end();
  if (!none) here->needed_us = now_us;  // kept until the better one arrives
  if (!none && here - object.lods.begin() <= static_cast<std::ptrdiff_t>(lod)) return;
  std::size_t first = lod;
  if (none && want.unseen) {
    // A coarser level comes first because it comes quickly.
    for (std::size_t i = lods.size(); i-- > lod + 1;) {
      const double most = lods[i].spread > 0 ? kCoarseThinnedExcess : kCoarseExcess;
      const bool fit = lod_excess(lods[i], want.px_per_unit, tau_px) <= most;
      if (!fit || lods[i].bytes > kCoarseShare * lods[lod].bytes || !allowed(i)) continue;
      first = i;
      break;
    }
  }
  const double gain = want.surrounds && none ? kInfinity : want.gain;
  out.push_back({{AssetId::Kind::kMesh, want.object, static_cast<std::uint8_t>(first)},
                 gain,
                 static_cast<double>(lods[first].bytes + kReplyBytes),
                 none});
}

void MeshCache::need_images(const SceneView& scene, const MeshWant& want, std::int64_t now_us,
                            std::vector<AssetNeed>& out) {
  for (const ImageUse& use : objects_[want.object].uses) {
    const ImageDescription& image = scene.images[use.image];
    ImageState& state = images_[use.image];
    state.held.needed_us = now_us;
    int level = needed_level(image, use, want.px_per_unit);
    const auto texels = [&](int l) {
      const glm::uvec2 size = image_level_size(image, static_cast<std::uint8_t>(l));
      return static_cast<double>(size.x) * size.y;
    };
    const auto too_large = [&](int l) {
      return image_bytes_per_texel_ * texels(l) > static_cast<double>(max_reply_bytes_) ||
             !fits(image_gpu_bytes(image_level_size(image, static_cast<std::uint8_t>(l))), now_us);
    };
    // The first image is a small one, so that it comes quickly.
    if (state.level < 0) level = std::min(level, 1);
    while (level > state.level && too_large(level)) --level;
    if (level <= state.level) continue;
    const double missing =
        state.level < 0 ? 1.0 : 1.0 - std::sqrt(texels(state.level) / texels(level));
    const double gain = want.surrounds && state.level < 0
                            ? kInfinity
                            : kNoImageFlip * missing * want.area_px * want.life_s;
    const AssetId id{AssetId::Kind::kImage, use.image, static_cast<std::uint8_t>(level)};
    const auto same = std::find_if(out.begin(), out.end(), [&](const AssetNeed& need) {
      return need.id.kind == id.kind && need.id.index == id.index;
    });
    const AssetNeed need{id, gain, kReplyBytes + image_bytes_per_texel_ * texels(level)};
    if (same == out.end()) {
      out.push_back(need);
    } else if (same->id.level < id.level) {
      *same = need;
    }
  }
}

std::vector<AssetNeed> MeshCache::needs(const SceneView& scene, double tau_px, std::int64_t now_us,
                                        const std::vector<MeshWant>& wants) {
  std::vector<AssetNeed> out;
  for (const MeshWant& want : wants) {
    need_mesh(scene, want, tau_px, now_us, out);
    need_images(scene, want, now_us, out);
  }
  return out;
}

void MeshCache::add_mesh(std::uint32_t index, std::uint8_t lod, const ObjectModel& model,
                         std::int64_t now_us) {
  Object& object = objects_[index];
  Level& level = object.lods[lod];
  bytes_ -= level.bytes;
  level.resident = true;
  level.bytes = mesh_gpu_bytes(model.mesh);
  level.needed_us = now_us;
  bytes_ += level.bytes;
  if (!object.known_uses) {
    object.uses = image_uses(model);
    object.known_uses = true;
  }
  update_ready(index);
}

void MeshCache::add_image(const SceneView& scene, std::uint32_t index, std::uint8_t level,
                          std::size_t reply_bytes, std::int64_t now_us) {
  ImageState& image = images_[index];
  const glm::uvec2 size = image_level_size(scene.images[index], level);
  bytes_ -= image.held.bytes;
  image.held.resident = true;
  image.held.bytes = image_gpu_bytes(size);
  image.held.needed_us = now_us;
  image.level = level;
  bytes_ += image.held.bytes;
  const double texels = static_cast<double>(size.x) * size.y;
  image_bytes_per_texel_ +=
      0.1 * (static_cast<double>(reply_bytes) / texels - image_bytes_per_texel_);
  for (std::uint32_t i = 0; i < objects_.size(); ++i) update_ready(i);
}

void MeshCache::forget(Level& level, const AssetId& id, std::vector<AssetId>& out) {
  bytes_ -= level.bytes;
  level = Level{};
  if (id.kind == AssetId::Kind::kImage) images_[id.index].level = -1;
  out.push_back(id);
}

std::vector<AssetId> MeshCache::drop(std::uint64_t frame, std::int64_t now_us) {
  std::vector<AssetId> out;
  struct Entry {
    Level* level;
    AssetId id;
  };
  std::vector<Entry> idle;
  const auto consider = [&](Level& level, const AssetId& id, std::int64_t kept_us) {
    if (!level.resident || level.drawn_frame == frame) return;
    if (now_us - level.needed_us > kept_us) {
      forget(level, id, out);
    } else {
      idle.push_back({&level, id});
    }
  };
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    for (std::size_t k = 0; k < objects_[i].lods.size(); ++k) {
      consider(objects_[i].lods[k], {AssetId::Kind::kMesh, i, static_cast<std::uint8_t>(k)},
               kMeshKeptUs);
    }
  }
  for (std::uint32_t i = 0; i < images_.size(); ++i) {
    consider(images_[i].held,
             {AssetId::Kind::kImage, i, static_cast<std::uint8_t>(std::max(images_[i].level, 0))},
             kImageKeptUs);
  }
  if (bytes_ > budget_) {
    sort_ascending(idle,
                   [](const Entry& entry) { return static_cast<double>(entry.level->needed_us); });
    for (const Entry& entry : idle) {
      if (bytes_ <= budget_) break;
      forget(*entry.level, entry.id, out);
    }
  }
  if (!out.empty()) {
    for (std::uint32_t i = 0; i < objects_.size(); ++i) update_ready(i);
  }
  return out;
}

}  // namespace mirage
