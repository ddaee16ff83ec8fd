#include "server/prepare/prepared_scene.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <numeric>

#include "protocol/base/limits.h"
#include "protocol/impostor/lighting_state.h"
#include "server/lod/lod_family.h"
#include "server/prepare/derived_cache.h"
#include "server/prepare/find_track.h"
#include "server/prepare/instance_parts.h"
#include "server/prepare/motion_measure.h"
#include "server/prepare/scene_revision.h"
#include "server/prepare/touching.h"
#include "server/prepare/walk_eye.h"
#include "server/scene/builtin/builtin_scene.h"
#include "server/scene/environment/environment.h"
#include "server/scene/gltf/gltf_import.h"

namespace mirage {
namespace {

void describe(PreparedScene& prepared, const std::map<std::size_t, MeasuredMotion>& moving,
              const Workers& workers) {
  const Scene& scene = prepared.scene;
  prepared.objects.resize(scene.objects.size());
  workers.each(scene.objects.size(), [&](std::size_t i) {
    prepared.objects[i] = describe_object(scene.objects[i], scene, workers);
    prepared.objects[i].track = scene.objects[i].track;
    if (const auto at = moving.find(i); at != moving.end()) {
      use_motion(at->second, prepared.objects[i]);
    }
  });
  prepared.images.resize(scene.images.size());
  workers.each(scene.images.size(),
               [&](std::size_t i) { prepared.images[i] = describe_image(scene, i); });
}

/// Calls `visit` with the bounding sphere of each instance, at each place of its way.
void each_sphere(const PreparedScene& prepared,
                 const std::function<void(const glm::dvec3& center, double radius)>& visit) {
  for (const Instance& instance : prepared.scene.instances) {
    const ObjectDescription& object = prepared.objects[instance.object];
    const std::size_t places = std::max<std::size_t>(1, object.track.places.size());
    for (std::size_t i = 0; i < places; ++i) {
      const double time = places > 1 ? object.track.clip_s * static_cast<double>(i) /
                                           static_cast<double>(places - 1)
                                     : 0;
      const Similarity m = on_track(instance.world_from_object, object.track, time);
      visit(m.position + glm::dquat(m.rotation) * (glm::dvec3(object.center) * double{m.scale}),
            double{object.radius} * m.scale);
    }
  }
}

void bound_world(PreparedScene& prepared) {
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high = -low;
  each_sphere(prepared, [&](const glm::dvec3& center, double radius) {
    low = glm::min(low, center - radius);
    high = glm::max(high, center + radius);
  });
  if (!(low.x <= high.x)) return;
  prepared.bounds_center = 0.5 * (low + high);
  prepared.bounds_radius = 0;
  each_sphere(prepared, [&](const glm::dvec3& center, double radius) {
    prepared.bounds_radius =
        std::max(prepared.bounds_radius, glm::length(center - prepared.bounds_center) + radius);
  });
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

// Rule 19 of numerics.md section 5: an animated object that does not move becomes a static one,
// with its costs.
std::map<std::size_t, MeasuredMotion> settle_motion(Scene& scene, const Workers& workers) {
  std::vector<std::size_t> animated;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    if (scene.objects[i].animation) animated.push_back(i);
  }
  std::vector<MeasuredMotion> measured(animated.size());
  workers.each(animated.size(), [&](std::size_t k) {
    SceneObject& object = scene.objects[animated[k]];
    const double way = take_track(object);
    measured[k] = measure_motion(object.mesh, *object.animation, way);
    if (measured[k].motion.moving()) return;
    std::vector<Vertex> posed;
    pose_vertices(object.mesh.vertices, *object.animation, 0, posed);
    object.mesh.vertices = std::move(posed);
    object.animation.reset();
  });
  std::map<std::size_t, MeasuredMotion> moving;
  for (std::size_t k = 0; k < animated.size(); ++k) {
    if (measured[k].motion.moving()) moving.emplace(animated[k], std::move(measured[k]));
  }
  return moving;
}

// A scene with more lights than a shader takes keeps the strongest.
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
  const InstanceGroup* const group = group_of_instance(index);
  if (group && group->part != kNoGroup) return group->first_leaf;
  const std::uint32_t of = group ? group->parent : grouping.group_of[index];
  return of == kNoGroup ? kNoGroup : static_cast<std::uint32_t>(own + of);
}

const Cut* PreparedScene::cut(std::size_t index) const {
  const std::vector<Cut>& cuts = grouping.cuts;
  const auto at = std::lower_bound(cuts.begin(), cuts.end(), index,
                                   [](const Cut& c, std::size_t i) { return c.instance < i; });
  return at != cuts.end() && at->instance == index ? &*at : nullptr;
}

std::vector<std::uint32_t> PreparedScene::members(std::size_t index) const {
  std::vector<std::uint32_t> out;
  if (const InstanceGroup* group = group_of_instance(index)) {
    const auto first = grouping.members.begin() + group->first_member;
    out.assign(first, first + group->members);
  } else if (const Cut* found = cut(index)) {
    out.resize(found->groups);
    std::iota(out.begin(), out.end(),
              static_cast<std::uint32_t>(scene.instances.size() + found->first_group));
  }
  return out;
}

std::shared_ptr<const ObjectDescription> PreparedScene::description(std::size_t object) const {
  if (const InstanceGroup* of = group(object)) {
    return std::make_shared<const ObjectDescription>(group_description(of->bounds));
  }
  return {std::shared_ptr<const void>{}, &objects[object]};  // owned by the scene
}

bool PreparedScene::animated() const {
  return std::any_of(objects.begin(), objects.end(),
                     [](const ObjectDescription& o) { return o.moves(); });
}

bool PreparedScene::blends() const {
  return std::any_of(objects.begin(), objects.end(),
                     [](const ObjectDescription& o) { return (o.needs & kNeedBlend) != 0; });
}

bool PreparedScene::has_casters() const {
  return std::any_of(scene.instances.begin(), scene.instances.end(),
                     [&](const Instance& instance) { return objects[instance.object].casts(); });
}

namespace {

using PreparedPtr = std::shared_ptr<PreparedScene>;

Result<PreparedPtr> prepare(Scene scene, const SceneLoadOptions& options, const Workers& workers,
                            StageTimes times) {
  auto prepared = std::make_shared<PreparedScene>();
  prepared->scene = std::move(scene);
  if (Result<void> checked = check_limits(prepared->scene); !checked) return checked.error();
  cap_lights(prepared->scene);
  Result<Lighting> lighting = checked_lighting(prepared->scene.lighting);
  if (!lighting) return make_error(ErrorId::kSceneRange, lighting.error().text);
  prepared->scene.lighting = lighting.take();
  if (options.keep_imported) {
    prepared->imported = std::make_shared<const PreparedScene::Imported>(
        PreparedScene::Imported{prepared->scene.materials, prepared->scene.images});
  }
  prepared->left_out = leave_out_unneeded(prepared->scene);
  const std::map<std::size_t, MeasuredMotion> moving = settle_motion(prepared->scene, workers);
  times.done("needs");
  describe(*prepared, moving, workers);
  prepared->geometry.resize(prepared->objects.size());
  times.done("descriptions");
  prepared->mips = make_mips(prepared->scene, options.cache, workers);
  times.done("mips");
  // A scene without extent still needs a walk loop.
  if (!(prepared->scene.home.walk_radius_m > 0)) prepared->scene.home.walk_radius_m = 1;
  bound_world(*prepared);
  find_surroundings(prepared->scene, prepared->bounds_radius, prepared->objects);
  prepared->grouping = group_instances(prepared->scene, prepared->objects);
  prepared->parts = cut_instances(prepared->scene, prepared->bounds_radius, prepared->objects,
                                  prepared->grouping, workers);
  prepared->touching = find_touching(prepared->scene, prepared->objects, prepared->grouping);
  prepared->scene.home.walk_eye_m = walk_eye(prepared->scene, prepared->objects,
                                             {prepared->bounds_center, prepared->bounds_radius});
  prepared->revision = scene_revision(prepared->scene);
  times.done("revision and groups");
  prepared->load_times = std::move(times);
  return prepared;
}

// Adds the levels of detail, and their time.
Result<std::shared_ptr<const PreparedScene>> with_levels(Result<PreparedPtr> prepared,
                                                         const SceneLoadOptions& options) {
  if (!prepared) return prepared.error();
  make_levels(**prepared, options);
  (*prepared)->load_times.done("levels of detail");
  return std::shared_ptr<const PreparedScene>(prepared.take());
}

Result<Scene> import_timed(const std::string& spec, const SceneLoadOptions& options,
                           const Workers& workers, StageTimes& times) {
  constexpr const char* kBuiltin = "builtin:";
  const bool builtin = spec.rfind(kBuiltin, 0) == 0;
  Result<Scene> loaded = builtin ? build_builtin_scene(spec.substr(std::string(kBuiltin).size()),
                                                       {workers, options.cache, options.progress})
                                 : import_gltf_spec(spec, workers,
                                                    {.strict = options.strict,
                                                     .choice = options.choice,
                                                     .megabytes = options.megabytes});
  if (!loaded) return loaded;
  times.done("scene");
  Result<void> lit = set_environment(options.environment, *loaded, workers);
  if (!lit) return lit.error();
  set_look(options.studio, options.environment, *loaded);
  if (options.home) {
    HomeView& home = loaded->home;
    home.eye = options.home->eye;
    home.target = options.home->target;
    home.fit.clear();
  }
  times.done("environment");
  return loaded;
}

}  // namespace

Result<Scene> import_scene(const std::string& spec, const SceneLoadOptions& options) {
  StageTimes times;
  return import_timed(spec, options, Workers(options.threads), times);
}

void make_levels(PreparedScene& prepared, const SceneLoadOptions& options,
                 const std::atomic<bool>* stopped) {
  const Workers workers(options.threads);
  const std::vector<SceneObject>& objects = prepared.scene.objects;
  const std::vector<std::uint64_t> images =
      options.cache ? hash_images(prepared.scene, workers) : std::vector<std::uint64_t>{};
  const LodFamilies families(prepared.scene);
  StageProgress progress(options.progress, "levels of detail", objects.size());
  workers.each(objects.size(), [&](std::size_t i) {
    if (stopped && *stopped) return;
    prepared.geometry[i] = find_or_make_geometry(prepared.scene, objects[i], prepared.objects[i],
                                                 options.cache, images, families, workers);
    progress.one_done();
  });
}

Result<PreparedPtr> load_without_levels(const std::string& spec, const SceneLoadOptions& options) {
  const Workers workers(options.threads);
  StageTimes times;
  Result<Scene> scene = import_timed(spec, options, workers, times);
  if (!scene) return scene.error();
  Result<PreparedPtr> prepared = prepare(scene.take(), options, workers, std::move(times));
  const bool range = !prepared && prepared.error().id == ErrorId::kSceneRange;
  if (range) return make_error(ErrorId::kSceneRange, spec + ": " + prepared.error().text);
  return prepared;
}

Result<std::shared_ptr<const PreparedScene>> load_scene(const std::string& spec,
                                                        const SceneLoadOptions& options) {
  return with_levels(load_without_levels(spec, options), options);
}

Result<std::shared_ptr<const PreparedScene>> prepare_scene(Scene scene,
                                                           const SceneLoadOptions& options) {
  return with_levels(prepare(std::move(scene), options, Workers(options.threads), {}), options);
}

}  // namespace mirage
