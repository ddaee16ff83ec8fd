#include "server/scene/prepared_scene.h"

#include <xxhash.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <map>
#include <thread>

#include "protocol/animation_codec.h"
#include "protocol/lighting_state.h"
#include "protocol/limits.h"
#include "protocol/tile_codec.h"
#include "server/scene/builtin/builtin_scene.h"
#include "server/scene/convex_hull.h"
#include "server/scene/gltf/gltf_import.h"
#include "server/scene/lod.h"
#include "server/scene/motion_measure.h"

namespace mirage {
namespace {

class ContentHash {
 public:
  ContentHash() : state_(XXH3_createState()) { XXH3_64bits_reset(state_); }
  ContentHash(const ContentHash&) = delete;
  ContentHash& operator=(const ContentHash&) = delete;
  ~ContentHash() { XXH3_freeState(state_); }
  void add(const void* bytes, std::size_t n) {
    if (n > 0) XXH3_64bits_update(state_, bytes, n);
  }
  template <typename T>
  void add_array(const std::vector<T>& v) {
    add(v.data(), v.size() * sizeof(T));
  }
  std::uint64_t value() const { return XXH3_64bits_digest(state_); }

 private:
  XXH3_state_t* state_;
};

// Stored tiles outlive a build: raise it when equal content gives other ones, by build_lods(), the
// shaders or the codec.
constexpr std::uint32_t kTileVersion = 3;

// Lighting and environment are not part of it: light is in the key, the sky in no tile.
std::uint64_t content_hash(const Scene& scene) {
  ContentHash hash;
  hash.add(&kTileVersion, sizeof(kTileVersion));
  for (const SceneObject& object : scene.objects) {
    hash.add_array(object.mesh.vertices);
    hash.add_array(object.mesh.indices);
    hash.add_array(encode_animation(object.animation.get()));
    for (const Primitive& p : object.mesh.primitives) {
      const std::uint32_t words[4] = {static_cast<std::uint32_t>(p.kind), p.first_index,
                                      p.index_count, p.material};
      hash.add(words, sizeof(words));
    }
  }
  hash.add_array(encode_materials(scene.materials));
  for (const Image& image : scene.images) {
    const std::uint32_t size[3] = {image.width, image.height, image.srgb};
    hash.add(size, sizeof(size));
    hash.add_array(image.rgba);
  }
  // Groups show where their members are, and neighbours throw shadows.
  for (const Instance& instance : scene.instances) {
    const Similarity& m = instance.world_from_object;
    const double place[] = {m.position.x, m.position.y, m.position.z, m.rotation.w,
                            m.rotation.x, m.rotation.y, m.rotation.z, m.scale};
    hash.add(&instance.object, sizeof(instance.object));
    hash.add(place, sizeof(place));
  }
  return hash.value();
}

glm::vec3 mean_image_color(const Image& image) {
  glm::dvec3 sum(0);
  double weight = 0;
  const std::size_t pixels = image.rgba.size() / 4;
  const std::size_t step = std::max<std::size_t>(1, pixels / 4096);
  for (std::size_t i = 0; i < pixels; i += step) {
    const std::uint8_t* p = &image.rgba[i * 4];
    const double a = p[3] / 255.0;
    for (int c = 0; c < 3; ++c) sum[c] += a * std::pow(p[c] / 255.0, image.srgb ? 2.2 : 1.0);
    weight += a;
  }
  return weight > 0 ? glm::vec3(sum / weight) : glm::vec3(0.5f);
}

// Area-weighted mean of base colour x vertex colour x texture mean, plus emission.
glm::vec3 mean_color(const SceneObject& object, const Scene& scene) {
  glm::dvec3 sum(0);
  double area_sum = 0;
  for (const Primitive& p : object.mesh.primitives) {
    if (p.kind != PrimitiveKind::kTriangles) continue;
    const Material& m = scene.materials[p.material];
    glm::vec3 base = glm::vec3(m.base_color) + m.emissive;
    if (m.base_color_map.present()) {
      base *= mean_image_color(scene.images[static_cast<std::size_t>(m.base_color_map.image)]);
    }
    const std::uint32_t step = 3 * std::max(1u, p.index_count / 3 / 2000);
    for (std::uint32_t i = 0; i + 2 < p.index_count; i += step) {
      const std::uint32_t* at = &object.mesh.indices[p.first_index + i];
      const Vertex& a = object.mesh.vertices[at[0]];
      const Vertex& b = object.mesh.vertices[at[1]];
      const Vertex& c = object.mesh.vertices[at[2]];
      const double area =
          step * double{glm::length(glm::cross(b.position - a.position, c.position - a.position))};
      sum += glm::dvec3(base * glm::vec3(a.color) / 65535.0f) * area;
      area_sum += area;
    }
  }
  if (!(area_sum > 0) || !std::isfinite(area_sum)) return glm::vec3(0.5f);
  return glm::clamp(glm::vec3(sum / area_sum), 0.0f, 1.0f);
}

ImageDescription describe_image(const Scene& scene, std::size_t index) {
  const Image& image = scene.images[index];
  ImageDescription out{image.width, image.height, image.srgb, {}, 0};
  glm::dvec3 sum(0);
  double alpha = 0;
  const std::size_t pixels = image.rgba.size() / 4;
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::uint8_t* p = &image.rgba[i * 4];
    for (int c = 0; c < 3; ++c) sum[c] += static_cast<double>(p[3]) * p[c];
    alpha += p[3];
  }
  for (std::size_t c = 0; c < 3; ++c) {
    out.mean[c] = static_cast<std::uint8_t>(alpha > 0 ? sum[static_cast<int>(c)] / alpha : 128.0);
  }
  out.mean[3] = static_cast<std::uint8_t>(alpha / static_cast<double>(pixels));
  out.alpha_cutoff = alpha_test_cutoff(static_cast<std::int32_t>(index), scene.materials);
  return out;
}

EncodedLod encode_lod(const ObjectModel& model) {
  EncodedLod out;
  out.payload = encode_model(model);
  out.raw_bytes = static_cast<std::uint32_t>(out.payload.size());
  Bytes packed = compress_block(out.payload.data(), out.payload.size());
  if (!packed.empty() && packed.size() < out.payload.size()) out.payload = std::move(packed);
  return out;
}

void make_all_geometry(PreparedScene& prepared) {
  const std::vector<SceneObject>& objects = prepared.scene.objects;
  prepared.geometry.resize(objects.size());
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < objects.size(); i = next++) {
      prepared.geometry[i] = make_geometry(prepared.scene, objects[i], prepared.objects[i]);
    }
  };
  const std::size_t threads =
      std::min<std::size_t>(std::max(1u, std::thread::hardware_concurrency()), objects.size());
  std::vector<std::thread> helpers;
  for (std::size_t i = 1; i < threads; ++i) helpers.emplace_back(work);
  work();
  for (std::thread& helper : helpers) helper.join();
}

void bound_world(PreparedScene& prepared) {
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high = -low;
  const auto sphere = [&](const Instance& instance, double& radius) {
    const ObjectDescription& object = prepared.objects[instance.object];
    const Similarity& m = instance.world_from_object;
    radius = double{object.radius} * m.scale;
    return m.position + glm::dquat(m.rotation) * (glm::dvec3(object.center) * double{m.scale});
  };
  double radius = 0;
  for (const Instance& instance : prepared.scene.instances) {
    const glm::dvec3 center = sphere(instance, radius);
    low = glm::min(low, center - radius);
    high = glm::max(high, center + radius);
  }
  if (!(low.x <= high.x)) return;
  prepared.bounds_center = 0.5 * (low + high);
  prepared.bounds_radius = 0;
  for (const Instance& instance : prepared.scene.instances) {
    const glm::dvec3 center = sphere(instance, radius);
    prepared.bounds_radius =
        std::max(prepared.bounds_radius, glm::length(center - prepared.bounds_center) + radius);
  }
}

Result<void> check_limits(const Scene& scene) {
  if (scene.objects.size() > limits::kMaxObjects) {
    return make_error(ErrorId::kSceneLimit,
                      "scene has more than " + std::to_string(limits::kMaxObjects) + " objects");
  }
  if (scene.instances.size() > limits::kMaxInstances) {
    return make_error(
        ErrorId::kSceneLimit,
        "scene has more than " + std::to_string(limits::kMaxInstances) + " instances");
  }
  if (scene.images.size() > limits::kMaxImages) {
    return make_error(ErrorId::kSceneLimit,
                      "scene has more than " + std::to_string(limits::kMaxImages) + " images");
  }
  return {};
}

// Rule 19 of NUMERICS section 5: what does not move is a static object, and costs what one does.
std::map<std::size_t, MeasuredMotion> settle_motion(Scene& scene) {
  std::map<std::size_t, MeasuredMotion> moving;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    SceneObject& object = scene.objects[i];
    if (!object.animation) continue;
    MeasuredMotion measured = measure_motion(object.mesh, *object.animation);
    if (measured.motion.moving()) {
      moving.emplace(i, std::move(measured));
      continue;
    }
    std::vector<Vertex> posed;
    pose_vertices(object.mesh.vertices, *object.animation, 0, posed);
    object.mesh.vertices = std::move(posed);
    object.animation.reset();
  }
  return moving;
}

// Bounds of all poses in place of those of the bind pose.
void use_motion(const MeasuredMotion& measured, ObjectDescription& out) {
  out.motion = measured.motion;
  out.box_min = measured.box_min;
  out.box_max = measured.box_max;
  out.center = measured.center;
  out.radius = static_cast<float>(measured.radius * 1.00001);
  if (Result<ConvexHull> hull = enclosing_hull(measured.hull_points); hull.ok()) {
    out.hull = hull.take();
  }
}

// The strongest lights win where a scene has more than a shader takes.
void cap_lights(Scene& scene) {
  std::vector<Light>& lights = scene.lighting.lights;
  if (lights.size() <= limits::kMaxLights) return;
  const auto strength = [](const Light& l) { return l.color.r + l.color.g + l.color.b; };
  std::stable_sort(lights.begin(), lights.end(),
                   [&](const Light& a, const Light& b) { return strength(a) > strength(b); });
  scene.warnings.push_back(std::to_string(lights.size() - limits::kMaxLights) +
                           " of the weakest lights left out: at most " +
                           std::to_string(limits::kMaxLights) + " are supported");
  lights.resize(limits::kMaxLights);
}

}  // namespace

Instance PreparedScene::instance(std::size_t index) const {
  const std::size_t own = scene.instances.size();
  if (index < own) return scene.instances[index];
  Instance group;
  group.object = static_cast<std::uint32_t>(scene.objects.size() + (index - own));
  group.world_from_object.position = grouping.groups[index - own].bounds.center;
  group.importance = grouping.groups[index - own].importance;
  return group;
}

std::uint32_t PreparedScene::parent(std::size_t index) const {
  const std::size_t own = scene.instances.size();
  const std::uint32_t of =
      index < own ? grouping.group_of[index] : grouping.groups[index - own].parent;
  return of == kNoGroup ? kNoGroup : static_cast<std::uint32_t>(own + of);
}

std::shared_ptr<const ObjectDescription> PreparedScene::description(std::size_t object) const {
  if (const InstanceGroup* of = group(object)) {
    return std::make_shared<const ObjectDescription>(group_description(of->bounds));
  }
  return {std::shared_ptr<const void>{}, &objects[object]};  // owned by the scene
}

bool PreparedScene::blends() const {
  return std::any_of(objects.begin(), objects.end(),
                     [](const ObjectDescription& o) { return (o.needs & kNeedBlend) != 0; });
}

bool PreparedScene::has_casters() const {
  return std::any_of(scene.instances.begin(), scene.instances.end(),
                     [&](const Instance& instance) { return objects[instance.object].casts(); });
}

ObjectDescription describe_object(const SceneObject& object, const Scene& scene) {
  ObjectDescription out;
  std::vector<glm::vec3> points;
  points.reserve(object.mesh.indices.size() / 2);
  std::vector<bool> used(object.mesh.vertices.size(), false);
  for (const std::uint32_t i : object.mesh.indices) {
    if (!used[i]) points.push_back(object.mesh.vertices[i].position);
    used[i] = true;
  }
  for (const Primitive& p : object.mesh.primitives) {
    if (p.kind == PrimitiveKind::kTriangles) out.triangles += p.index_count / 3;
  }
  out.needs = object_needs(object.mesh, scene.materials);
  if (points.empty()) return out;
  out.box_min = out.box_max = points[0];
  for (const glm::vec3& p : points) {
    out.box_min = glm::min(out.box_min, p);
    out.box_max = glm::max(out.box_max, p);
  }
  out.center = 0.5f * (out.box_min + out.box_max);
  double radius = 0;
  for (const glm::vec3& p : points) {
    radius = std::max(radius, glm::length(glm::dvec3(p) - glm::dvec3(out.center)));
  }
  // Rounded up, so that every vertex is inside in float as well; a single point gets some extent.
  const double floor_radius = 1e-6 * std::max(1.0, glm::length(glm::dvec3(out.center)));
  out.radius = static_cast<float>(std::max(radius * 1.00001, std::min(floor_radius, 1e-3)));
  if (Result<ConvexHull> hull = enclosing_hull(points); hull.ok()) out.hull = hull.take();
  out.hull.parallax = parallax_factors(out.hull, points, out.center);
  out.mean_color = mean_color(object, scene);
  return out;
}

ObjectModel object_model(const Scene& scene, const Mesh& mesh) {
  ObjectModel model;
  model.mesh = mesh;
  std::map<std::uint32_t, std::uint32_t> material_index;
  for (Primitive& p : model.mesh.primitives) {
    const auto [at, is_new] =
        material_index.emplace(p.material, static_cast<std::uint32_t>(model.materials.size()));
    if (is_new) model.materials.push_back(scene.materials[p.material]);
    p.material = at->second;
  }
  return model;
}

ObjectGeometry make_geometry(const Scene& scene, const SceneObject& object,
                             ObjectDescription& description) {
  ObjectGeometry out;
  const auto step =
      static_cast<float>(quantisation_error(description.box_min, description.box_max));
  const auto add = [&](const Mesh& mesh, float error, float spread) {
    ObjectModel model = object_model(scene, mesh);
    model.animation = object.animation;
    EncodedLod encoded = encode_lod(model);
    LodInfo info;
    for (const Primitive& p : mesh.primitives) {
      if (p.kind == PrimitiveKind::kTriangles) info.triangles += p.index_count / 3;
    }
    info.bytes = static_cast<std::uint32_t>(encoded.payload.size());
    info.error = error + step;
    info.spread = spread;
    description.lods.push_back(info);
    out.encoded.push_back(std::move(encoded));
  };
  add(object.mesh, 0, 0);
  out.tile_lods.emplace_back();
  if (object.animation) return out;  // simplified poses have no error bound
  for (MeshLod& lod : build_lods(object.mesh, scene.materials)) {
    add(lod.mesh, lod.error, lod.spread);
    out.tile_lods.push_back(lod.spread > 0 ? Mesh{} : std::move(lod.mesh));
  }
  return out;
}

Result<std::shared_ptr<const PreparedScene>> load_scene(const std::string& spec,
                                                        bool keep_imported) {
  constexpr const char* kBuiltin = "builtin:";
  const bool builtin = spec.rfind(kBuiltin, 0) == 0;
  Result<Scene> loaded =
      builtin ? build_builtin_scene(spec.substr(std::string(kBuiltin).size())) : import_gltf(spec);
  if (!loaded) return loaded.error();
  auto prepared = prepare_scene(loaded.take(), keep_imported);
  const bool range = !prepared && prepared.error().id == ErrorId::kSceneRange;
  if (range) return make_error(ErrorId::kSceneRange, spec + ": " + prepared.error().text);
  return prepared;
}

Result<std::shared_ptr<const PreparedScene>> prepare_scene(Scene scene, bool keep_imported) {
  auto prepared = std::make_shared<PreparedScene>();
  prepared->scene = std::move(scene);
  if (Result<void> checked = check_limits(prepared->scene); !checked) return checked.error();
  cap_lights(prepared->scene);
  Result<Lighting> lighting = checked_lighting(prepared->scene.lighting);
  if (!lighting) return make_error(ErrorId::kSceneRange, lighting.error().text);
  prepared->scene.lighting = lighting.take();
  if (keep_imported) {
    prepared->imported = std::make_shared<const PreparedScene::Imported>(
        PreparedScene::Imported{prepared->scene.materials, prepared->scene.images});
  }
  prepared->left_out = leave_out_unneeded(prepared->scene);
  const std::map<std::size_t, MeasuredMotion> moving = settle_motion(prepared->scene);
  for (std::size_t i = 0; i < prepared->scene.objects.size(); ++i) {
    ObjectDescription description = describe_object(prepared->scene.objects[i], prepared->scene);
    if (const auto at = moving.find(i); at != moving.end()) use_motion(at->second, description);
    prepared->objects.push_back(std::move(description));
  }
  for (std::size_t i = 0; i < prepared->scene.images.size(); ++i) {
    prepared->images.push_back(describe_image(prepared->scene, i));
  }
  make_all_geometry(*prepared);
  // A scene without extent still needs a loop to walk.
  if (!(prepared->scene.home.walk_radius_m > 0)) prepared->scene.home.walk_radius_m = 1;
  bound_world(*prepared);
  find_surroundings(prepared->scene, prepared->bounds_radius, prepared->objects);
  prepared->grouping = group_instances(prepared->scene, prepared->objects);
  prepared->revision = content_hash(prepared->scene);
  return std::shared_ptr<const PreparedScene>(std::move(prepared));
}

}  // namespace mirage
