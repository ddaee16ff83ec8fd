// Nodes, instances, baked transforms, lights and the home view.
#include <cmath>

#include "protocol/impostor/camera.h"
#include "tests/support/gltf_fixture.h"

namespace mirage::test {
namespace {

constexpr double kPi = 3.14159265358979323846;

glm::dvec3 to_world(const Scene& scene, std::size_t instance, const glm::vec3& point) {
  const Similarity& world = scene.instances[instance].world_from_object;
  return world.position + glm::dquat(world.rotation) * (double(world.scale) * glm::dvec3(point));
}

/// Returns the third corner of the triangle, as instance `i` places it.
glm::dvec3 third_corner(const Scene& scene, std::size_t i) {
  const Mesh& mesh = scene.objects[scene.instances[i].object].mesh;
  for (const Vertex& vertex : mesh.vertices) {
    if (std::abs(vertex.uv0.x - 3) < 1e-6) return to_world(scene, i, vertex.position);
  }
  ADD_FAILURE() << "corner is gone";
  return {};
}

/// A triangle whose corners are marked by uv0.x = 1, 2, 3, with normals along +z.
Builder marked_triangle() {
  Builder builder = triangle();
  json& attributes = builder.primitive()["attributes"];
  attributes["TEXCOORD_0"] = builder.vec2({1, 0, 2, 0, 3, 0});
  attributes["NORMAL"] = builder.vec3({0, 0, 1, 0, 0, 1, 0, 0, 1});
  return builder;
}

TEST(GltfNodes, CyclesAreNamed) {
  Builder self = triangle();
  self.doc["nodes"][0]["children"] = {0};
  EXPECT_REFUSED(self.load_strict(), kSceneCycle, "nodes[0] is its own child");

  Builder loop = triangle();
  loop.doc["nodes"] = {{{"children", {1}}}, {{"children", {2}}}, {{"children", {0}}}};
  EXPECT_REFUSED(loop.load_strict(), kSceneCycle, "nodes[0] > nodes[1] > nodes[2] > nodes[0]");

  Builder parents = triangle();
  parents.doc["nodes"] = {{{"children", {2}}}, {{"children", {2}}}, {{"mesh", 0}}};
  EXPECT_REFUSED(parents.load_strict(), kSceneCycle, "nodes[2] has two parents");

  Builder twice = triangle();
  twice.doc["nodes"] = {{{"children", {1, 1}}}, {{"mesh", 0}}};
  EXPECT_REFUSED(twice.load_strict(), kSceneCycle, "twice");
}

TEST(GltfNodes, DeepChainsLoad) {
  constexpr int kDepth = 20'000;
  Builder builder = triangle();
  json nodes = json::array();
  for (int i = 0; i < kDepth; ++i)
    nodes.push_back({{"children", {i + 1}}, {"translation", {1, 0, 0}}});
  nodes.push_back({{"mesh", 0}});
  builder.doc["nodes"] = nodes;
  builder.doc["scenes"] = {{{"nodes", {0}}}};
  auto scene = builder.load();
  ASSERT_TRUE(scene) << failure(scene);
  ASSERT_EQ(scene->instances.size(), 1u);
  EXPECT_EQ(scene->instances[0].world_from_object.position, glm::dvec3(kDepth, 0, 0));
}

TEST(GltfNodes, ActiveScene) {
  Builder builder = triangle();
  builder.doc["nodes"].push_back({{"mesh", 0}, {"translation", {5, 0, 0}}});
  auto all = builder.load();
  ASSERT_TRUE(all);
  EXPECT_EQ(all->instances.size(), 2u);  // without scenes: every root

  builder.doc["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1}}}};
  auto first = builder.load();
  ASSERT_TRUE(first);
  ASSERT_EQ(first->instances.size(), 1u);
  EXPECT_EQ(first->instances[0].world_from_object.position.x, 0);
  builder.doc["scene"] = 1;
  auto second = builder.load();
  ASSERT_TRUE(second);
  EXPECT_EQ(second->instances[0].world_from_object.position.x, 5);

  builder.doc["nodes"].push_back({{"children", {1}}});
  EXPECT_REFUSED(builder.load_strict(), kSceneReference, "scenes[1] lists nodes[1]");
}

TEST(GltfNodes, AListedChildIsDrawnOnceWhereItsParentsPutIt) {
  Builder builder = triangle();
  builder.doc["nodes"] = {{{"children", {1}}, {"translation", {1, 0, 0}}},
                          {{"children", {2}}, {"translation", {0, 2, 0}}},
                          {{"mesh", 0}, {"translation", {0, 0, 3}}}};
  // The parent is listed as well, before or after, or not at all.
  for (const json& roots : {json{0, 2}, json{2, 0}, json{2}, json{2, 1}, json{0, 1, 2, 2}}) {
    builder.doc["scenes"] = {{{"nodes", roots}}};
    auto scene = builder.load();
    ASSERT_TRUE(scene) << failure(scene);
    ASSERT_EQ(scene->instances.size(), 1u) << roots;
    EXPECT_EQ(scene->instances[0].world_from_object.position, glm::dvec3(1, 2, 3)) << roots;
    EXPECT_TRUE(has_warning(*scene, "children of other nodes drawn once")) << roots;
    EXPECT_REFUSED(builder.load_strict(), kSceneReference, "which is a child of");
  }
  builder.doc["scenes"] = {{{"nodes", {0, 0}}}};
  auto twice = builder.load();
  ASSERT_TRUE(twice) << failure(twice);
  EXPECT_EQ(twice->instances.size(), 1u);
  EXPECT_TRUE(has_warning(*twice, "1 nodes that a scene lists twice"));
  EXPECT_REFUSED(builder.load_strict(), kSceneReference, "lists nodes[0] twice");
}

TEST(GltfNodes, AHiddenNodeHidesAllBelowIt) {
  Builder builder = triangle();
  const json hidden = {{"KHR_node_visibility", {{"visible", false}}}};
  builder.doc["nodes"] = {
      {{"mesh", 0}},
      {{"mesh", 0}, {"children", {2}}, {"extensions", hidden}},
      {{"mesh", 0}},
      {{"mesh", 0}, {"extensions", {{"KHR_node_visibility", {{"visible", true}}}}}}};
  builder.doc["extensionsUsed"] = builder.doc["extensionsRequired"] = {"KHR_node_visibility"};
  auto scene = builder.load_strict();
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_EQ(scene->instances.size(), 2u);
  EXPECT_TRUE(scene->warnings.empty());
}

TEST(GltfNodes, NothingToDrawIsAValidScene) {
  Builder builder;
  builder.doc["nodes"] = {json::object()};
  auto scene = builder.load();
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_TRUE(scene->objects.empty());
  EXPECT_TRUE(has_warning(*scene, "nothing to draw"));
}

TEST(GltfInstances, SimilaritiesShareOneObject) {
  Builder builder = marked_triangle();
  builder.doc["nodes"] = {{{"mesh", 0}, {"translation", {1e9, 0, 0.25}}},
                          {{"mesh", 0}, {"scale", {3, 3, 3}}, {"rotation", {0, 0, 0.6, 0.8}}},
                          {{"mesh", 0}, {"scale", {1e-20, 1e-20, 1e-20}}}};
  auto scene = builder.load();
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_EQ(scene->objects.size(), 1u);
  ASSERT_EQ(scene->instances.size(), 3u);
  EXPECT_EQ(scene->instances[0].world_from_object.position, glm::dvec3(1e9, 0, 0.25));
  EXPECT_FLOAT_EQ(scene->instances[1].world_from_object.scale, 3);
  EXPECT_FLOAT_EQ(scene->instances[2].world_from_object.scale, 1e-20f);
  // (0,1,0) turned by 2·atan(0.6/0.8) about z, three times as long
  const glm::dvec3 corner = third_corner(*scene, 1);
  EXPECT_NEAR(corner.x, -3 * 0.96, 1e-5);
  EXPECT_NEAR(corner.y, 3 * 0.28, 1e-5);
}

TEST(GltfInstances, MirrorsAreBakedAndKeepTheirFront) {
  Builder builder = marked_triangle();
  builder.doc["nodes"] = {{{"mesh", 0}, {"scale", {-1, 1, 1}}},
                          {{"mesh", 0}, {"scale", {1, -2, 1}}, {"translation", {0, 0, 4}}},
                          {{"mesh", 0}, {"scale", {1, -1, 1}}}};
  auto scene = builder.load();
  ASSERT_TRUE(scene) << failure(scene);
  ASSERT_EQ(scene->objects.size(), 2u);  // both plain mirrors share one object
  EXPECT_EQ(scene->instances[0].object, scene->instances[2].object);
  EXPECT_NEAR(third_corner(*scene, 0).y, 1, 1e-6);
  EXPECT_NEAR(third_corner(*scene, 1).y, -2, 1e-6);
  EXPECT_NEAR(third_corner(*scene, 2).y, -1, 1e-6);
  for (std::size_t i = 0; i < 3; ++i) {
    const Mesh& mesh = scene->objects[scene->instances[i].object].mesh;
    glm::vec3 corner[3];
    for (std::size_t c = 0; c < 3; ++c) {
      corner[c] = glm::vec3(to_world(*scene, i, mesh.vertices[mesh.indices[c]].position));
    }
    const glm::vec3 face = glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
    const glm::vec3 normal =
        scene->instances[i].world_from_object.rotation * mesh.vertices[mesh.indices[0]].normal;
    EXPECT_GT(face.z, 0) << i;  // glTF: a negative determinant turns the winding
    EXPECT_NEAR(normal.z, 1, 1e-5) << i;
  }
}

TEST(GltfInstances, NormalsUnderNonUniformScale) {
  Builder builder = marked_triangle();
  const float s = std::sqrt(0.5f);
  builder.primitive()["attributes"]["NORMAL"] = builder.vec3({s, s, 0, s, s, 0, 0, 0, 1});
  builder.doc["nodes"] = {{{"mesh", 0}, {"scale", {1, 0.5, 1}}},
                          {{"mesh", 0}, {"scale", {1, 1e-6, 1}}}};
  auto scene = builder.load();
  ASSERT_TRUE(scene) << failure(scene);
  ASSERT_EQ(scene->objects.size(), 2u);
  const Vertex& half = scene->objects[0].mesh.vertices[0];
  EXPECT_NEAR(half.normal.x, 1 / std::sqrt(5.0), 1e-5);
  EXPECT_NEAR(half.normal.y, 2 / std::sqrt(5.0), 1e-5);
  for (const SceneObject& object : scene->objects) {
    for (const Vertex& vertex : object.mesh.vertices) {
      EXPECT_NEAR(glm::length(vertex.normal), 1, 1e-5);
      EXPECT_NEAR(glm::dot(vertex.normal, glm::vec3(vertex.tangent)), 0, 1e-5);
    }
  }
}

TEST(GltfInstances, ShearIsReproduced) {
  Builder builder = marked_triangle();
  // A turn below a non-uniform scale makes a shear.
  builder.doc["nodes"] = {{{"scale", {1, 4, 1}}, {"children", {1}}},
                          {{"mesh", 0}, {"rotation", {0, 0, 0.6, 0.8}}}};
  auto scene = builder.load();
  ASSERT_TRUE(scene) << failure(scene);
  const glm::dvec3 corner = third_corner(*scene, 0);
  EXPECT_NEAR(corner.x, -0.96, 1e-5);
  EXPECT_NEAR(corner.y, 4 * 0.28, 1e-5);
}

TEST(GltfInstances, FlatAndVanishingScales) {
  Builder builder = marked_triangle();
  builder.doc["nodes"] = {{{"mesh", 0}, {"scale", {1, 0, 1}}}, {{"mesh", 0}, {"scale", {0, 0, 0}}}};
  auto scene = builder.load();
  ASSERT_TRUE(scene) << failure(scene);
  ASSERT_EQ(scene->instances.size(), 1u);
  EXPECT_EQ(scene->instances[0].world_from_object.scale, 1);
  for (const Vertex& vertex : scene->objects[0].mesh.vertices) {
    EXPECT_EQ(vertex.position.y, 0);
    EXPECT_NEAR(glm::length(vertex.normal), 1, 1e-5);
  }
  EXPECT_TRUE(has_warning(*scene, "1 instances without size"));
}

TEST(GltfInstances, GpuInstancing) {
  Builder builder = marked_triangle();
  const int translation = builder.vec3({1, 0, 0, 2, 0, 0, 3, 0, 0});
  const int rotation = builder.accessor<std::int8_t>({0, 0, 0, 127, 0, 0, 127, 0, 0, 0, 0, 127},
                                                     "VEC4", 5120, 4, true);
  builder.doc["nodes"][0]["translation"] = {0, 10, 0};
  json& extension = builder.doc["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"];
  extension["attributes"] = {{"TRANSLATION", translation}, {"ROTATION", rotation}};
  auto scene = builder.load();
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_EQ(scene->objects.size(), 1u);
  ASSERT_EQ(scene->instances.size(), 3u);
  EXPECT_EQ(scene->instances[2].world_from_object.position, glm::dvec3(3, 10, 0));
  EXPECT_NEAR(third_corner(*scene, 1).y, 9, 1e-6);

  extension["attributes"]["SCALE"] = builder.vec3({1, 1, 1});
  EXPECT_REFUSED(builder.load_strict(), kSceneRange, "SCALE");
  auto unscaled = builder.load();
  ASSERT_TRUE(unscaled) << failure(unscaled);
  EXPECT_EQ(unscaled->instances.size(), 3u);
  EXPECT_TRUE(has_warning(*unscaled, "1 attributes of instanced copies"));
}

Builder lit(const json& lights) {
  Builder builder = triangle();
  builder.doc["extensions"]["KHR_lights_punctual"]["lights"] = lights;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    builder.doc["nodes"].push_back(
        {{"translation", {0, 0, 2}}, {"extensions", {{"KHR_lights_punctual", {{"light", i}}}}}});
  }
  return builder;
}

TEST(GltfLights, DefaultsWithoutLights) {
  auto scene = triangle().load();
  ASSERT_TRUE(scene);
  ASSERT_EQ(scene->lighting.lights.size(), 1u);
  EXPECT_EQ(scene->lighting.ambient, glm::vec3(0.6f));
  EXPECT_EQ(scene->lighting.lights[0].color, glm::vec3(0.8f));
  EXPECT_LT(scene->lighting.lights[0].direction.y, 0);
}

TEST(GltfLights, PhysicalUnits) {
  auto scene = lit({{{"type", "directional"}, {"intensity", kPi}, {"color", {1, 0.5, 0}}},
                    {{"type", "spot"},
                     {"intensity", 1},
                     {"range", 9},
                     {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.2}}}}})
                   .load();
  ASSERT_TRUE(scene) << failure(scene);
  ASSERT_EQ(scene->lighting.lights.size(), 2u);
  EXPECT_EQ(scene->lighting.ambient, glm::vec3(0.1f));
  const Light& sun = scene->lighting.lights[0];
  EXPECT_NEAR(sun.color.r, 1, 1e-6);
  EXPECT_NEAR(sun.color.g, 0.5, 1e-6);
  EXPECT_EQ(sun.direction, glm::vec3(0, 0, -1));
  const Light& spot = scene->lighting.lights[1];
  EXPECT_EQ(spot.kind, LightKind::kSpot);
  EXPECT_EQ(spot.position, glm::dvec3(0, 0, 2));
  EXPECT_EQ(spot.range, 9);
  EXPECT_NEAR(spot.cos_outer, std::cos(0.2), 1e-6);
}

TEST(GltfLights, OneExposureForAll) {
  auto scene = lit({{{"type", "directional"}, {"intensity", 30000}},
                    {{"type", "directional"}, {"intensity", 10000}}})
                   .load();
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_NEAR(scene->lighting.lights[0].color.r, 1.5 * 0.75, 1e-4);
  EXPECT_NEAR(scene->lighting.lights[1].color.r, 1.5 * 0.25, 1e-4);
  EXPECT_TRUE(has_warning(*scene, "exposure"));
}

TEST(GltfLights, ImpossibleAndTooMany) {
  auto bad = lit({{{"type", "directional"}, {"intensity", -1}},
                  {{"type", "point"}, {"color", {-1, 0, 0}}},
                  {{"type", "laser"}},
                  {{"type", "point"}, {"intensity", 1}}})
                 .load();
  ASSERT_TRUE(bad) << failure(bad);
  EXPECT_EQ(bad->lighting.lights.size(), 1u);
  EXPECT_TRUE(has_warning(*bad, "3 lights with impossible values"));

  json lights = json::array();
  for (int i = 0; i < 260; ++i) lights.push_back({{"type", "point"}});
  auto many = lit(lights).load();
  ASSERT_TRUE(many) << failure(many);
  EXPECT_EQ(many->lighting.lights.size(), 256u);
  EXPECT_TRUE(has_warning(*many, "4 lights beyond"));
  EXPECT_REFUSED(
      [] {
        Builder builder = lit({{{"type", "point"}}});
        builder.doc["nodes"][1]["extensions"]["KHR_lights_punctual"]["light"] = 9;
        return builder.load_strict();
      }(),
      kSceneReference, "light = 9");
}

TEST(GltfHome, SeesTheScene) {
  auto scene = triangle().load();
  ASSERT_TRUE(scene);
  const double radius = std::sqrt(2.0) / 2;
  EXPECT_LT(glm::length(scene->home.target - glm::dvec3(0.5, 0.5, 0)), 0.3);
  EXPECT_EQ(scene->home.fit.size(), 3u);
  const glm::dvec3 fitting = home_pose(scene->home, Camera()).eye;
  EXPECT_NEAR(glm::length(scene->home.eye - fitting), 0, 1e-3) << "fits a usual picture";
  EXPECT_GT(scene->environment.floor.half, 0);
  EXPECT_GT(scene->home.eye.y, scene->home.target.y);
  EXPECT_NEAR(scene->home.walk_radius_m, 1.5 * radius, 1e-9);
  EXPECT_NEAR(scene->home.walk_speed_mps, 0.28 * radius, 1e-9);
}

TEST(GltfHome, NearerInFlatScenesOfManyInstances) {
  Builder builder = triangle();
  builder.doc["nodes"] = json::array();
  for (int i = 0; i < 30; ++i) {
    builder.doc["nodes"].push_back({{"mesh", 0}, {"translation", {i * 10, 0, 0}}});
  }
  auto scene = builder.load();
  ASSERT_TRUE(scene);
  const double radius = 0.5 * std::sqrt(291.0 * 291 + 1);
  EXPECT_NEAR(glm::length(scene->home.eye - scene->home.target), 0.8 * radius, 1e-6);
  EXPECT_EQ(scene->home.walk_speed_mps, 1.4);
  EXPECT_TRUE(scene->home.fit.empty()) << "a place";
  EXPECT_EQ(scene->environment.floor.half, 0);
}

TEST(GltfHome, CameraOfTheFile) {
  Builder builder = triangle();
  builder.doc["cameras"] = {
      {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}}};
  builder.doc["nodes"].push_back({{"camera", 0}, {"translation", {0.5, 0.5, 3}}});
  auto scene = builder.load();
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_EQ(scene->home.eye, glm::dvec3(0.5, 0.5, 3));
  EXPECT_NEAR(glm::length(scene->home.target - glm::dvec3(0.5, 0.5, 0)), 0, 1e-9);
}

TEST(GltfScene, ImportanceIsTheNodesOrItsMeshsOrTheParents) {
  Builder b = triangle();
  const auto mark = [](json& element, const char* what) {
    element["extras"]["mirage"]["importance"] = what;
  };
  b.doc["nodes"] = json::array({{{"mesh", 0}},
                                {{"mesh", 0}},
                                {{"children", {3, 4}}},
                                {{"mesh", 1}},
                                {{"mesh", 1}},
                                {{"mesh", 1}}});
  b.doc["meshes"].push_back(b.doc["meshes"][0]);
  b.doc["scenes"][0]["nodes"] = {0, 1, 2, 5};
  mark(b.doc["meshes"][0], "scenery");
  mark(b.doc["nodes"][1], "important");
  mark(b.doc["nodes"][2], "important");
  mark(b.doc["nodes"][4], "scenery");
  const Result<Scene> scene = b.load();
  ASSERT_TRUE(scene) << failure(scene);
  std::vector<Importance> found;
  for (const Instance& instance : scene->instances) found.push_back(instance.importance);
  EXPECT_EQ(found, (std::vector<Importance>{Importance::kScenery, Importance::kImportant,
                                            Importance::kNormal, Importance::kImportant,
                                            Importance::kScenery}))
      << "nodes 0, 1, 5, 3, 4";
  EXPECT_TRUE(scene->warnings.empty());
}

TEST(GltfScene, UnknownImportanceIsTold) {
  for (const json& bad : {json("huge"), json(2), json::array(), json::object(), json(nullptr)}) {
    Builder b = triangle();
    b.doc["nodes"][0]["extras"]["mirage"]["importance"] = bad;
    const Result<Scene> scene = b.load();
    ASSERT_TRUE(scene) << failure(scene);
    EXPECT_EQ(scene->instances[0].importance, Importance::kNormal);
    EXPECT_TRUE(has_warning(*scene, "extras.mirage.importance"));
    EXPECT_TRUE(has_warning(*scene, "nodes[0]"));
  }
  Builder b = triangle();
  b.doc["nodes"][0]["extras"] = "free text";
  EXPECT_TRUE(b.load()) << "extras of others are none of our business";
}

TEST(GltfScene, CesiumRtcMovesEverything) {
  Builder builder = triangle();
  builder.doc["nodes"][0]["translation"] = {1, 2, 3};
  builder.doc["nodes"].push_back({{"camera", 0}, {"translation", {1, 2, 9}}});
  builder.doc["cameras"] = {
      {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}}};
  auto before = builder.load();
  ASSERT_TRUE(before) << failure(before);
  builder.doc["extensions"]["CESIUM_RTC"]["center"] = {4e6, -5e6, 1.25};
  builder.doc["extensionsUsed"] = builder.doc["extensionsRequired"] = {"CESIUM_RTC"};
  auto scene = builder.load_strict();
  ASSERT_TRUE(scene) << failure(scene);
  const glm::dvec3 center(4e6, -5e6, 1.25);
  EXPECT_EQ(scene->instances[0].world_from_object.position,
            before->instances[0].world_from_object.position + center);
  EXPECT_LT(glm::distance(scene->home.eye, before->home.eye + center), 1e-6);
  EXPECT_LT(glm::distance(scene->home.target, before->home.target + center), 1e-3);
  builder.doc["extensions"]["CESIUM_RTC"]["center"] = {4e6, -5e6};
  EXPECT_REFUSED(builder.load_strict(), kSceneFormat, "extensions.CESIUM_RTC.center");
}

}  // namespace
}  // namespace mirage::test
