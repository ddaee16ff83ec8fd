// The stages of an import, in order. Each refuses input that the next could not handle:
//   file_guard      bytes: container lengths, JSON nesting, size
//   json_schema     types, required properties, references between lists
//   document        version, extensions, URIs, buffers; tinygltf makes the typed model
//   decompress      meshopt and Draco -> plain bufferViews and accessors, before tinygltf
//   model_check     ranges of bufferViews and accessors
//   node_import     no cycles; world matrices
//   scene_assembler meshes (mesh_import), materials, instances (similarity_split)
//   light_import, home_view
#include "server/scene/gltf/gltf_import.h"

#include <algorithm>
#include <exception>
#include <filesystem>
#include <new>

#include "protocol/base/limits.h"
#include "protocol/impostor/camera.h"
#include "server/scene/gltf/bounds.h"
#include "server/scene/gltf/clip_import.h"
#include "server/scene/gltf/detail_frame.h"
#include "server/scene/gltf/document.h"
#include "server/scene/gltf/home_view.h"
#include "server/scene/gltf/light_import.h"
#include "server/scene/gltf/node_import.h"
#include "server/scene/gltf/scene_assembler.h"
#include "server/scene/gltf/staging.h"
#include "server/scene/gltf/tally.h"

namespace mirage {
namespace {

/// CESIUM_RTC: geocentric positions are too large for floats. Meshes therefore stay relative to
/// `center`, and only instances move there, in doubles.
void move_origin(Scene& scene, gltf::NodeTree& tree, const glm::dvec3& center) {
  if (center == glm::dvec3(0)) return;
  for (Instance& instance : scene.instances) instance.world_from_object.position += center;
  for (glm::dmat4& world : tree.world_from_node) world[3] += glm::dvec4(center, 0);
}

/// Reads "variant=NAME&clip=NAME" in any order; false if it is something else. A name may have '&'.
bool read_query(std::string_view query, SceneChoice& choice) {
  constexpr std::string_view kVariant = "variant=", kClip = "clip=";
  while (!query.empty()) {
    const bool variant = query.starts_with(kVariant);
    if (!variant && !query.starts_with(kClip)) return false;
    query.remove_prefix((variant ? kVariant : kClip).size());
    const std::size_t end =
        std::min(query.find("&" + std::string(kVariant)), query.find("&" + std::string(kClip)));
    const std::string_view value = query.substr(0, end);
    if (value.empty()) return false;
    (variant ? choice.variant : choice.clip) = value;
    query.remove_prefix(end == std::string_view::npos ? query.size() : end + 1);
  }
  return choice != SceneChoice{};
}

/// Returns the names that a viewer can ask for, each once.
std::vector<std::string> offered(const std::vector<std::string>& names) {
  std::vector<std::string> out;
  for (const std::string& name : names) {
    const bool told = std::find(out.begin(), out.end(), name) != out.end();
    if (name.empty() || told || name.size() > limits::kMaxChoiceBytes) continue;
    if (out.size() < limits::kMaxChoices) out.push_back(name);
  }
  return out;
}

/// Moves eye and target so that a camera with the default shape sees the fitting view.
void fit_usual_picture(HomeView& home) {
  Camera camera;
  camera.pose = home_pose(home, camera);
  const glm::dvec3 before = home.target;
  home.eye = camera.pose.eye;
  home.target = home.eye + glm::dot(before - home.eye, camera.forward()) * camera.forward();
  for (glm::vec3& point : home.fit) point += glm::vec3(before - home.target);
}

Result<Scene> import_stages(const std::string& path, const Workers& workers,
                            const ImportOptions& options) {
  gltf::Tally tally(options.strict);
  auto document = gltf::load_document(path, options.choice.variant,
                                      gltf::limits_within(options.megabytes), workers, tally);
  if (!document) return document.error();
  SceneChoices choices{gltf::clip_names(*document), offered(document->variants), {}};
  choices.shown.variant = options.choice.variant;
  Result<std::string> clip = gltf::choose_clip(options.choice.clip, *document);
  if (!clip) return clip.error();
  choices.shown.clip = clip.take();
  const std::map<int, gltf::NodeClip> clips = gltf::import_clips(*document, tally);
  auto tree = gltf::flatten_nodes(document->model, tally);
  if (!tree) return tree.error();

  gltf::SceneAssembler assembler(*document, *tree, clips, tally);
  for (const int node : tree->drawn) {
    if (auto ok = assembler.add_node(node); !ok) return ok.error();
  }
  if (auto ok = assembler.finish(); !ok) return ok.error();
  Result<Scene> taken = assembler.take(workers);
  if (!taken) return taken;
  Scene scene = taken.take();
  move_origin(scene, *tree, document->center);
  scene.name = std::filesystem::path(path).stem().string();
  scene.choices = std::move(choices);
  if (scene.instances.empty()) {
    if (tally.first_loss()) return *tally.first_loss();  // nobody can draw what is left
    tally.note("nothing to draw");
  }

  const gltf::Bounds bounds = gltf::scene_bounds(scene);
  scene.lighting = gltf::import_lighting(*document, *tree, bounds, tally, scene.own_lights);
  const gltf::DetailFrame frame = gltf::frame_detail(scene, bounds);
  if (frame.leaves_out()) tally.note(frame.told());
  scene.home = gltf::import_home_view(*document, *tree, frame.bounds, scene.instances.size());
  if (gltf::is_seen_from_outside(*document, *tree, frame.bounds, scene.instances.size())) {
    scene.home.fit = gltf::outermost_points(scene, frame.bounds);
    fit_usual_picture(scene.home);
    if (frame.surrounding.empty()) scene.environment.floor = gltf::floor_under(scene, frame.bounds);
  }
  scene.warnings = tally.lines();
  return scene;
}

}  // namespace

Result<Scene> import_gltf_spec(const std::string& spec, const Workers& workers,
                               ImportOptions options) {
  const std::size_t mark = spec.rfind('?');
  std::error_code code;
  if (mark == std::string::npos || std::filesystem::exists(spec, code)) {
    return import_gltf(spec, workers, options);
  }
  SceneChoice named;
  if (!read_query(std::string_view(spec).substr(mark + 1), named)) {
    return make_error(ErrorId::kUsage, "'" + spec + "': a file takes ?variant=NAME and ?clip=NAME");
  }
  SceneChoice& choice = options.choice;
  if (choice.variant.empty()) choice.variant = named.variant;
  if (choice.clip.empty()) choice.clip = named.clip;
  return import_gltf(spec.substr(0, mark), workers, options);
}

Result<Scene> import_gltf(const std::string& path, const Workers& workers,
                          const ImportOptions& options) {
  auto named = [&path](const Error& error) {
    return make_error(error.id, path + ": " + error.text, error.hint);
  };
  try {
    auto scene = import_stages(path, workers, options);
    if (!scene) return named(scene.error());
    return scene;
  } catch (const std::bad_alloc&) {
    return named(make_error(ErrorId::kSceneLimit, "not enough memory"));
  } catch (const std::exception& exception) {
    return named(make_error(ErrorId::kSceneFormat, exception.what()));
  }
}

}  // namespace mirage
