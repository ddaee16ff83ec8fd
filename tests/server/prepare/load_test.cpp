// Loading gives the same result with any number of threads, and from wherever levels come.
#include <gtest/gtest.h>
#include <xxhash.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <numeric>

#include "protocol/base/byte_stream.h"
#include "server/base/cache_directory.h"
#include "server/prepare/prepared_scene.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/large_scene.h"

namespace mirage::test {
namespace {
namespace fs = std::filesystem;

TEST(Workers, DoEachThingOnceHoweverDeepTheCallsNest) {
  for (const std::size_t threads : {1, 2, 5}) {
    const Workers workers(threads);
    std::vector<std::atomic<int>> done(60 * 7);
    workers.each(60, [&](std::size_t i) {
      workers.each(7, [&](std::size_t k) {
        workers.both([&] { ++done[7 * i + k]; }, [&] { ++done[7 * i + k]; });
      });
    });
    for (const std::atomic<int>& count : done) ASSERT_EQ(count, 2);
  }
  int alone = 0;
  Workers().each(5, [&](std::size_t i) { alone += static_cast<int>(i); });
  EXPECT_EQ(alone, 10);
}

/// Returns a hash of all that tiles are drawn from and clients are sent, without the loader's
/// times.
std::uint64_t content_of(const PreparedScene& scene) {
  ByteWriter w;
  const auto put_mesh = [&](const Mesh& mesh) {
    w.put_bytes(mesh.vertices.data(), mesh.vertices.size() * sizeof(Vertex));
    w.put_bytes(mesh.indices.data(), mesh.indices.size() * 4);
    for (const Primitive& p : mesh.primitives) {
      for (const std::uint32_t part :
           {std::uint32_t(p.kind), p.first_index, p.index_count, p.material}) {
        w.put(part);
      }
    }
  };
  for (std::size_t i = 0; i < scene.geometry.size(); ++i) {
    const ObjectDescription& object = scene.objects[i];
    put_mesh(scene.scene.objects[i].mesh);
    for (const Mesh& mesh : scene.geometry[i].tile_lods) put_mesh(mesh);
    for (const EncodedLod& lod : scene.geometry[i].encoded) {
      w.put(lod.raw_bytes);
      w.put_bytes(lod.payload.data(), lod.payload.size());
    }
    w.put_bytes(object.lods.data(), object.lods.size() * sizeof(LodInfo));
    w.put_bytes(object.hull.vertices.data(), object.hull.vertices.size() * sizeof(glm::vec3));
    w.put_bytes(object.hull.parallax.data(), object.hull.parallax.size() * 4);
    w.put(object.radius);
    w.put(object.mean_color);
  }
  for (const Image& image : scene.scene.images) w.put_bytes(image.rgba.data(), image.rgba.size());
  for (const std::vector<Image>& mips : scene.mips) {
    for (const Image& mip : mips) w.put_bytes(mip.rgba.data(), mip.rgba.size());
  }
  w.put(scene.revision);
  return XXH3_64bits(w.bytes.data(), w.bytes.size());
}

struct Loaded {
  std::uint64_t revision = 0, content = 0;
  bool operator==(const Loaded&) const = default;
};
Loaded load(const std::string& spec, const SceneLoadOptions& options) {
  const auto scene = load_scene(spec, options);
  if (!scene) return {};
  return {(*scene)->revision, content_of(**scene)};
}
std::ostream& operator<<(std::ostream& out, const Loaded& loaded) {
  return out << std::hex << loaded.revision << " " << loaded.content;
}

/// Meshes large enough to be shared among threads, images, and (forest) foliage with mips.
std::vector<std::string> scenes(const TempFolder& folder) {
  const std::string large = (folder.path() / "large.glb").string();
  LargeScene shape;
  shape.triangles = 90'000;
  shape.meshes = 3;
  shape.textures = 3;
  shape.texture_edge = 64;
  EXPECT_TRUE(write_large_glb(large, shape));
  return {large, "builtin:forest?trees=6&clutter=1"};
}

TEST(Load, GivesTheSameHoweverManyThreadsWork) {
  const TempFolder folder;
  for (const std::string& spec : scenes(folder)) {
    const Loaded alone = load(spec, {.threads = 1});
    EXPECT_NE(alone.revision, 0u);
    for (const std::size_t threads : {2, 3, 8}) {
      EXPECT_EQ(load(spec, {.threads = threads}), alone) << spec << ", " << threads << " threads";
    }
  }
}

TEST(Load, GivesTheSameFromTheCache) {
  const TempFolder folder;
  for (const std::string& spec : scenes(folder)) {
    const Loaded without = load(spec, {});
    CacheDirectory cache((folder.path() / "cache").string(), 1u << 30);
    EXPECT_EQ(load(spec, {.cache = &cache}), without) << "made";
    const std::uint64_t bytes = cache.bytes();
    EXPECT_GT(bytes, 0u);
    EXPECT_EQ(load(spec, {.cache = &cache}), without) << "found";
    EXPECT_EQ(cache.bytes(), bytes) << "nothing was made again";
  }
}

TEST(Load, DamagedLevelsOfDetailAreMadeAgain) {
  const TempFolder folder;
  const std::string spec = "builtin:knot?tubular=100&radial=16";
  const Loaded without = load(spec, {});
  const fs::path place = folder.path() / "cache";
  for (int kind = 0; kind < 3; ++kind) {
    CacheDirectory cache(place.string(), 1u << 30);
    EXPECT_EQ(load(spec, {.cache = &cache}), without);
    for (const auto& entry : fs::recursive_directory_iterator(place)) {
      if (!entry.is_regular_file()) continue;
      const auto size = fs::file_size(entry.path());
      if (kind == 0) fs::resize_file(entry.path(), size / 2);
      if (kind == 1) fs::resize_file(entry.path(), 0);
      if (kind == 2) {
        std::fstream file(entry.path(), std::ios::binary | std::ios::in | std::ios::out);
        file.seekp(static_cast<std::streamoff>(size / 2));
        file << "damage";
      }
    }
    EXPECT_EQ(load(spec, {.cache = &cache}), without) << kind;
    EXPECT_EQ(load(spec, {.cache = &cache}), without) << kind << ", made again";
  }
}

}  // namespace
}  // namespace mirage::test
