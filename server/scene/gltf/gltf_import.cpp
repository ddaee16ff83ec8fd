// Stages, in order, each refusing what the next could not stand:
//   file_guard      bytes: container lengths, JSON nesting, size
//   json_schema     types, required properties, references between lists
//   document        version, extensions, URIs, buffers; tinygltf makes the typed model
//   model_check     ranges of bufferViews and accessors
//   node_import     no cycles; world matrices
//   scene_assembler meshes (mesh_import), materials, instances (similarity_split)
//   light_import, home_view
#include "server/scene/gltf/gltf_import.h"

#include <exception>
#include <filesystem>
#include <new>

#include "server/scene/gltf/bounds.h"
#include "server/scene/gltf/clip_import.h"
#include "server/scene/gltf/document.h"
#include "server/scene/gltf/home_view.h"
#include "server/scene/gltf/light_import.h"
#include "server/scene/gltf/node_import.h"
#include "server/scene/gltf/scene_assembler.h"
#include "server/scene/gltf/tally.h"

namespace mirage {
namespace {

Result<Scene> import_stages(const std::string& path, const Workers& workers) {
  gltf::Tally tally;
  auto document = gltf::load_document(path, tally);
  if (!document) return document.error();
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
  scene.name = std::filesystem::path(path).stem().string();
  if (scene.instances.empty()) tally.note("nothing to draw");

  const gltf::Bounds bounds = gltf::scene_bounds(scene);
  scene.lighting = gltf::import_lighting(*document, *tree, bounds, tally, scene.own_lights);
  scene.home = gltf::import_home_view(*document, *tree, bounds, scene.instances.size());
  scene.warnings = tally.lines();
  return scene;
}

}  // namespace

Result<Scene> import_gltf(const std::string& path, const Workers& workers) {
  auto named = [&path](const Error& error) {
    return make_error(error.id, path + ": " + error.text, error.hint);
  };
  try {
    auto scene = import_stages(path, workers);
    if (!scene) return named(scene.error());
    return scene;
  } catch (const std::bad_alloc&) {
    return named(make_error(ErrorId::kSceneLimit, "not enough memory"));
  } catch (const std::exception& exception) {
    return named(make_error(ErrorId::kSceneFormat, exception.what()));
  }
}

}  // namespace mirage
