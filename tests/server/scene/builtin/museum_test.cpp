// builtin:museum: heavy sculptures that share nothing.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "server/base/cache_directory.h"
#include "server/scene/builtin/builtin_scene.h"

namespace mirage {
namespace {

constexpr double kMean = 6000;  // triangles
constexpr std::size_t kCount = 24;

Scene built(const LoadTools& tools = {Workers()},
            const std::string& options = "objects=24&triangles=6000&seed=3") {
  auto scene = build_builtin_scene("museum?" + options, tools);
  EXPECT_TRUE(scene.ok());
  return scene.ok() ? scene.take() : Scene();
}

/// Returns the numbered objects, which are the sculptures: "bust 1", "torus knot 2".
std::vector<std::size_t> sculptures_of(const Scene& scene) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const std::string& name = scene.objects[i].name;
    if (name.back() >= '0' && name.back() <= '9') out.push_back(i);
  }
  return out;
}

std::vector<std::int32_t> images_of(const Scene& scene, std::size_t object) {
  std::vector<std::int32_t> out;
  for (const Primitive& p : scene.objects[object].mesh.primitives) {
    scene.materials[p.material].each_map([&](const TextureRef& map) {
      if (map.present()) out.push_back(map.image);
    });
  }
  return out;
}

TEST(BuiltinMuseum, SculpturesShareNoMeshMaterialOrImage) {
  const Scene scene = built();
  const std::vector<std::size_t> sculptures = sculptures_of(scene);
  ASSERT_EQ(sculptures.size(), kCount);
  std::map<std::size_t, int> shown;
  for (const Instance& i : scene.instances) ++shown[i.object];
  std::set<std::uint32_t> materials;
  std::set<std::string> pixels;
  std::set<std::vector<float>> shapes;
  std::size_t images = 0;
  for (const std::size_t i : sculptures) {
    const Mesh& mesh = scene.objects[i].mesh;
    EXPECT_EQ(shown[i], 1) << scene.objects[i].name;
    ASSERT_EQ(mesh.primitives.size(), 1u);
    EXPECT_TRUE(materials.insert(mesh.primitives[0].material).second);
    const std::vector<std::int32_t> own = images_of(scene, i);
    EXPECT_GE(own.size(), 1u) << scene.objects[i].name;
    for (const std::int32_t image : own) {
      ++images;
      const std::vector<std::uint8_t>& rgba = scene.images[static_cast<std::size_t>(image)].rgba;
      EXPECT_TRUE(pixels.emplace(rgba.begin(), rgba.end()).second)
          << scene.objects[i].name << image;
    }
    std::vector<float> shape;
    for (std::size_t k = 0; k < 300; ++k) {  // spread over all of them, however many there are
      shape.push_back(mesh.vertices[k * mesh.vertices.size() / 300].position.y);
    }
    EXPECT_TRUE(shapes.insert(shape).second) << scene.objects[i].name;
  }
  EXPECT_GT(images, kCount * 3 / 2);  // normal and metal-rough maps as well
}

TEST(BuiltinMuseum, TrianglesSpreadFromThreeHundredThousandToAMillionForTheDefaultMean) {
  const Scene scene = built();
  std::size_t least = SIZE_MAX, most = 0;
  for (const std::size_t i : sculptures_of(scene)) {
    const std::size_t triangles = scene.objects[i].mesh.indices.size() / 3;
    EXPECT_GE(static_cast<double>(triangles), kMean * 300 / 650) << scene.objects[i].name;
    EXPECT_LE(static_cast<double>(triangles), kMean * 1000 / 650) << scene.objects[i].name;
    least = std::min(least, triangles);
    most = std::max(most, triangles);
  }
  EXPECT_LT(static_cast<double>(least), 0.7 * kMean);
  EXPECT_GT(static_cast<double>(most), 1.3 * kMean);
}

void expect_same(const Scene& one, const Scene& other) {
  ASSERT_EQ(one.objects.size(), other.objects.size());
  for (std::size_t i = 0; i < one.objects.size(); ++i) {
    const Mesh &a = one.objects[i].mesh, &b = other.objects[i].mesh;
    EXPECT_EQ(one.objects[i].name, other.objects[i].name);
    EXPECT_TRUE(a.indices == b.indices) << one.objects[i].name;
    ASSERT_EQ(a.vertices.size(), b.vertices.size());
    EXPECT_TRUE(std::equal(a.vertices.begin(), a.vertices.end(), b.vertices.begin(),
                           [](const Vertex& x, const Vertex& y) {
                             return x.position == y.position && x.normal == y.normal &&
                                    x.tangent == y.tangent && x.uv0 == y.uv0 && x.color == y.color;
                           }))
        << one.objects[i].name;
  }
  ASSERT_EQ(one.images.size(), other.images.size());
  for (std::size_t i = 0; i < one.images.size(); ++i) {
    EXPECT_EQ(one.images[i].srgb, other.images[i].srgb) << i;
    EXPECT_TRUE(one.images[i].rgba == other.images[i].rgba) << i;
  }
  ASSERT_EQ(one.materials.size(), other.materials.size());
  for (std::size_t i = 0; i < one.materials.size(); ++i) {
    EXPECT_EQ(one.materials[i].roughness, other.materials[i].roughness) << i;
    EXPECT_EQ(one.materials[i].metallic, other.materials[i].metallic) << i;
  }
  for (std::size_t i = 0; i < one.instances.size(); ++i) {
    EXPECT_EQ(one.instances[i].world_from_object.position,
              other.instances[i].world_from_object.position);
  }
}

TEST(BuiltinMuseum, IsTheSameFromAnyNumberOfThreads) { expect_same(built(), built({Workers(3)})); }

TEST(BuiltinMuseum, IsTheSameFromTheCacheAndMakesNothingAgain) {
  const std::string folder = testing::TempDir() + "mirage_museum_cache";
  std::filesystem::remove_all(folder);
  CacheDirectory cache(folder, std::uint64_t{1} << 30);
  const Workers workers(2);
  const Scene made = built({workers, &cache});
  expect_same(built(), made);
  cache.settle();
  const std::uint64_t bytes = cache.bytes();
  EXPECT_GT(bytes, 0u);
  expect_same(built({workers, &cache}), made);
  cache.settle();
  EXPECT_EQ(cache.bytes(), bytes);
  std::filesystem::remove_all(folder);
}

using Place = std::array<float, 3>;

Place place_of(const Mesh& mesh, std::uint32_t vertex) {
  const glm::vec3 p = mesh.vertices[vertex].position;
  return {p.x, p.y, p.z};
}

/// Returns the edges that are not met by another one in the opposite direction. Vertices are
/// compared by position.
std::size_t open_edges(const Mesh& mesh) {
  std::map<std::pair<Place, Place>, int> balance;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Place a = place_of(mesh, mesh.indices[i + k]);
      const Place b = place_of(mesh, mesh.indices[i + (k + 1) % 3]);
      if (a < b) {
        ++balance[{a, b}];
      } else {
        --balance[{b, a}];
      }
    }
  }
  return static_cast<std::size_t>(std::count_if(balance.begin(), balance.end(),
                                                [](const auto& edge) { return edge.second != 0; }));
}

TEST(BuiltinMuseum, SculpturesAreClosedAndFaceOutward) {
  // A lattice needs more than a few thousand triangles to show its walls.
  const Scene scene = built({Workers(2)}, "objects=12&triangles=30000");
  for (const std::size_t i : sculptures_of(scene)) {
    const Mesh& mesh = scene.objects[i].mesh;
    // The thinnest triangles of a point are dropped.
    EXPECT_LT(open_edges(mesh), 20u) << scene.objects[i].name;
    double volume = 0;
    std::size_t against = 0;
    for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
      const Vertex& a = mesh.vertices[mesh.indices[t]];
      const Vertex& b = mesh.vertices[mesh.indices[t + 1]];
      const Vertex& c = mesh.vertices[mesh.indices[t + 2]];
      const glm::vec3 n = glm::cross(b.position - a.position, c.position - a.position);
      volume += double{glm::dot(a.position, glm::cross(b.position, c.position))};
      against += glm::dot(n, a.normal + b.normal + c.normal) < 0;
    }
    EXPECT_GT(volume, 0) << scene.objects[i].name;
    EXPECT_LT(against, mesh.indices.size() / 3 / 20) << scene.objects[i].name;
  }
}

TEST(BuiltinMuseum, SculpturesStandOnTheirPlinthsAtEyeLevel) {
  const Scene scene = built();
  for (const Instance& i : scene.instances) {
    const SceneObject& object = scene.objects[i.object];
    const std::vector<std::size_t> sculptures = sculptures_of(scene);
    if (!std::binary_search(sculptures.begin(), sculptures.end(), i.object)) continue;
    float low = 1e9f, high = -1e9f, wide = 0;
    for (const Vertex& v : object.mesh.vertices) {
      low = std::min(low, v.position.y);
      high = std::max(high, v.position.y);
      wide = std::max(wide, glm::length(glm::vec2(v.position.x, v.position.z)));
    }
    EXPECT_NEAR(low, 0, 0.01) << object.name;
    EXPECT_LT(wide, 0.73f) << object.name;
    const double top = i.world_from_object.position.y + double{high};
    EXPECT_GT(top, 1.2) << object.name;
    EXPECT_LT(top, 2.8) << object.name;
  }
}

}  // namespace
}  // namespace mirage
