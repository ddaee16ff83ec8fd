// Tiles are the same however many threads loaded the scene, and wherever its levels come from.
#include <gtest/gtest.h>

#include "server/base/cache_directory.h"
#include "server/prepare/prepared_scene.h"
#include "server/render/gpu_scene.h"
#include "server/render/readback_ring.h"
#include "server/render/tile_page.h"
#include "server/tile/tile_encode.h"
#include "shaders/gl/egl_context.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/large_scene.h"

namespace mirage::test {
namespace {

/// Returns content hashes of tiles of all objects, near and far, lit and relit; empty: it failed.
std::vector<std::uint64_t> tile_hashes(const std::string& spec, const SceneLoadOptions& options) {
  const auto scene = load_scene(spec, options);
  if (!scene) return {};
  const GpuScene gpu(*scene);
  Result<TilePageRenderer> pages = TilePageRenderer::create(gpu, 2);
  if (!pages) return {};
  std::vector<std::uint64_t> out;
  for (const Instance& instance : (*scene)->scene.instances) {
    const ObjectDescription& object = (*scene)->objects[instance.object];
    for (const double radii : {3.0, 20.0}) {
      for (const std::uint8_t channels : {kLitTile, kRelitTile}) {
        TileJob job;
        job.key.object = instance.object;
        job.key.cell = *view_cell_from_direction({0.6, 0.4, 0.7}, 8);
        job.key.distance = *distance_bucket_from_radii(radii, 3);
        while (tile_edge(job.key.size_class) < (radii < 10 ? 128 : 32)) ++job.key.size_class;
        job.key.channels = channels;
        job.lighting = object_lighting((*scene)->scene.lighting, instance.world_from_object,
                                       object.center, object.radius);
        PagePacker packer(128);
        packer.add(tile_edge(job.key.size_class));
        const gl::RenderTarget* target = pages->render({job}, packer);
        if (!target) return {};
        ReadbackRing ring(1);
        PendingPage pending{{job}, {{0, 0}}, 0, packer.used().x, packer.used().y};
        pending.surface = pages->writes_surface({job});
        ring.start(*target, std::move(pending));
        const ReadbackRing::Collected page = *ring.collect(true);
        const StoredTilePtr tile =
            encode_tile({job, *page.pixels, 0, 0, 0, 0}, object, TileCodec::kZstd);
        out.push_back(tile->reply.content_hash);
      }
    }
  }
  return out;
}

/// Meshes so large that threads share them, images, and (forest) foliage with mips.
class LoadedTiles : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    Result<gl::EglContext> egl = gl::EglContext::create("auto");
    if (!egl) GTEST_SKIP() << "no GL context";
    egl_ = std::move(*egl);
    spec_ = GetParam();
    if (spec_.empty()) {
      spec_ = (folder_.path() / "large.glb").string();
      ASSERT_TRUE(write_large_glb(
          spec_, {.triangles = 90'000, .meshes = 3, .textures = 3, .texture_edge = 64}));
    }
    alone_ = tile_hashes(spec_, {.threads = 1});
    ASSERT_FALSE(alone_.empty());
  }

  gl::EglContext egl_;
  TempFolder folder_;
  std::string spec_;
  std::vector<std::uint64_t> alone_;  ///< loaded by one thread, without a cache
};

TEST_P(LoadedTiles, AreTheSameHoweverManyThreadsWork) {
  for (const std::size_t threads : {2, 8}) {
    EXPECT_EQ(tile_hashes(spec_, {.threads = threads}), alone_) << threads << " threads";
  }
}

TEST_P(LoadedTiles, AreTheSameFromTheCache) {
  CacheDirectory cache((folder_.path() / "cache").string(), 1u << 30);
  EXPECT_EQ(tile_hashes(spec_, {.threads = 3, .cache = &cache}), alone_) << "made";
  EXPECT_GT(cache.bytes(), 0u);
  EXPECT_EQ(tile_hashes(spec_, {.threads = 3, .cache = &cache}), alone_) << "found";
}

INSTANTIATE_TEST_SUITE_P(Scenes, LoadedTiles,
                         ::testing::Values("", "builtin:forest?trees=6&clutter=1"));

}  // namespace
}  // namespace mirage::test
