#include "server/scene/prepared_scene.h"

#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "protocol/lighting_state.h"
#include "protocol/limits.h"
#include "server/scene/builtin/builtin_scene.h"
#include "server/scene/convex_hull.h"
#include "server/scene/gltf/gltf_import.h"

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

// Lighting and environment are not part of it: light is in the key, the sky in no tile.
std::uint64_t content_hash(const Scene& scene) {
  ContentHash hash;
  for (const SceneObject& object : scene.objects) {
    hash.add_array(object.mesh.vertices);
    hash.add_array(object.mesh.indices);
    ObjectModel shell;  // the codec's fixed layout leaves no padding in the hash
    shell.mesh.primitives = object.mesh.primitives;
    hash.add_array(encode_model(shell));
  }
  ObjectModel materials;
  materials.materials = scene.materials;
  hash.add_array(encode_model(materials));
  for (const Image& image : scene.images) {
    const std::uint32_t size[3] = {image.width, image.height, image.srgb};
    hash.add(size, sizeof(size));
    hash.add_array(image.rgba);
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
  return {};
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

ObjectModel object_model(const Scene& scene, std::size_t object) {
  ObjectModel model;
  model.mesh = scene.objects[object].mesh;
  std::map<std::uint32_t, std::uint32_t> material_index;
  std::map<std::int32_t, std::int32_t> image_index;
  const auto use_image = [&](TextureRef& t) {
    if (!t.present()) return;
    const auto [at, is_new] =
        image_index.emplace(t.image, static_cast<std::int32_t>(model.images.size()));
    if (is_new) model.images.push_back(scene.images[static_cast<std::size_t>(t.image)]);
    t.image = at->second;
  };
  for (Primitive& p : model.mesh.primitives) {
    const auto [at, is_new] =
        material_index.emplace(p.material, static_cast<std::uint32_t>(model.materials.size()));
    if (is_new) {
      Material material = scene.materials[p.material];
      for (TextureRef* t :
           {&material.base_color_map, &material.metal_rough_map, &material.normal_map,
            &material.occlusion_map, &material.emissive_map}) {
        use_image(*t);
      }
      model.materials.push_back(material);
    }
    p.material = at->second;
  }
  return model;
}

Result<std::shared_ptr<const PreparedScene>> load_scene(const std::string& spec) {
  constexpr const char* kBuiltin = "builtin:";
  const bool builtin = spec.rfind(kBuiltin, 0) == 0;
  Result<Scene> loaded =
      builtin ? build_builtin_scene(spec.substr(std::string(kBuiltin).size())) : import_gltf(spec);
  if (!loaded) return loaded.error();
  auto prepared = std::make_shared<PreparedScene>();
  prepared->scene = loaded.take();
  if (Result<void> checked = check_limits(prepared->scene); !checked) return checked.error();
  cap_lights(prepared->scene);
  Result<Lighting> lighting = checked_lighting(prepared->scene.lighting);
  if (!lighting) return make_error(ErrorId::kSceneRange, spec + ": " + lighting.error().text);
  prepared->scene.lighting = lighting.take();
  for (std::size_t i = 0; i < prepared->scene.objects.size(); ++i) {
    ObjectDescription description = describe_object(prepared->scene.objects[i], prepared->scene);
    description.mesh_bytes = static_cast<std::uint32_t>(
        std::min<std::size_t>(encoded_model_bytes(object_model(prepared->scene, i)), 0xffffffffu));
    prepared->objects.push_back(std::move(description));
  }
  // A scene without extent still needs a loop to walk.
  if (!(prepared->scene.home.walk_radius_m > 0)) prepared->scene.home.walk_radius_m = 1;
  prepared->revision = content_hash(prepared->scene);
  bound_world(*prepared);
  return std::shared_ptr<const PreparedScene>(std::move(prepared));
}

}  // namespace mirage
