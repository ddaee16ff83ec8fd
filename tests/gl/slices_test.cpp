// Slices: slow work is drawn in slices, with tiles between them. The cuts show nowhere.
#include <gtest/gtest.h>

#include "protocol/impostor/tile_key.h"
#include "server/prepare/prepared_scene.h"
#include "server/render/gpu_scene.h"
#include "server/render/page_packer.h"
#include "server/render/readback_ring.h"
#include "server/render/reference_renderer.h"
#include "server/render/scene_shadow.h"
#include "server/render/tile_page.h"
#include "shaders/gl/egl_context.h"

namespace mirage::test {
namespace {

constexpr double kSmallSlice = 20'000;

class Slices : public ::testing::Test {
 protected:
  Slices() : egl_(gl::EglContext::create("auto").take()) {}
  void open(const std::string& scene) {
    prepared_ = *load_scene(scene);
    gpu_ = std::make_unique<GpuScene>(prepared_);
    shadow_ = std::make_unique<SceneShadow>(SceneShadow::create(*gpu_).take());
    pages_ = std::make_unique<TilePageRenderer>(
        TilePageRenderer::create(*gpu_, 2, shadow_.get()).take());
    ASSERT_TRUE(pages_->warm_up(512));
    pictures_ =
        std::make_unique<ReferenceRenderer>(ReferenceRenderer::create(*gpu_, shadow_.get()).take());
  }

  SceneShot shot(std::uint32_t width, std::uint32_t height, double level_px) const {
    SceneShot out;
    const HomeView& home = prepared_->scene.home;
    out.camera.pose = look_at(home.eye, home.target);
    out.camera.width = width;
    out.camera.height = height;
    out.camera.fit_depth_range(prepared_->bounds_center, prepared_->bounds_radius);
    out.lighting = prepared_->scene.lighting;
    out.level_px = level_px;
    return out;
  }
  TileJob tile(std::uint32_t instance, std::uint8_t channels, std::uint32_t edge) const {
    TileJob out;
    const Instance& of = prepared_->scene.instances[instance];
    const ObjectDescription& object = prepared_->objects[of.object];
    out.key.object = of.object;
    out.key.distance = {0, 2};
    out.key.size_class = static_cast<std::uint8_t>(size_class_for(edge));
    out.key.channels = channels;
    out.lighting = object_lighting(prepared_->scene.lighting, of.world_from_object, object.center,
                                   object.radius);
    if (channels == kShadowTile) {
      out.key.instance = instance + 1;
      out.world = prepared_->scene.lighting;
    }
    return out;
  }
  /// Draws a job in the way in which the server draws small tiles.
  std::shared_ptr<const PagePixels> page_of(const TileJob& job) {
    PagePacker packer(512);
    packer.add(tile_edge(job.key.size_class));
    PendingPage page;
    page.jobs = {job};
    page.width = packer.used().x;
    page.height = packer.used().y;
    page.surface = pages_->writes_surface({job});
    ReadbackRing ring(1);
    ring.start(*pages_->render({job}, packer), page);
    return ring.collect(true)->pixels.take();
  }
  SceneFrame in_slices(const SceneShot& of, int* slices) {
    EXPECT_TRUE(pictures_->begin(of, kSmallSlice));
    for (*slices = 1;; ++*slices) {
      if (std::optional<SceneFrame> frame = pictures_->draw_slice()) return std::move(*frame);
      page_of(tile(0, kLitTile, 64));
    }
  }

  gl::EglContext egl_;
  std::shared_ptr<const PreparedScene> prepared_;
  std::unique_ptr<GpuScene> gpu_;
  std::unique_ptr<SceneShadow> shadow_;
  std::unique_ptr<TilePageRenderer> pages_;
  std::unique_ptr<ReferenceRenderer> pictures_;
};

TEST_F(Slices, APictureIsTheSameHoweverItIsCut) {
  struct Case {
    const char* scene;
    std::uint32_t width, height;
  };
  // Scenes are drawn in pieces, by their triangles. The last two are drawn in bands of rows, which
  // leave out what is not in them.
  for (const auto& [scene, width, height] : {Case{"builtin:clutter?objects=40", 321, 187},
                                             {"builtin:forest?trees=6&clutter=20", 321, 187},
                                             {"builtin:city?blocks=1", 321, 187},
                                             {"builtin:clutter?objects=6", 800, 327},
                                             {"builtin:field?instances=30", 800, 327}}) {
    open(scene);
    for (const double level_px : {0.0, 1.0}) {
      const SceneShot of = shot(width, height, level_px);
      const SceneFrame whole = pictures_->draw(of).take();
      int slices = 0;
      const SceneFrame cut = in_slices(of, &slices);
      EXPECT_GT(slices, 4) << scene;
      EXPECT_TRUE(whole.rgba == cut.rgba) << scene;
      EXPECT_TRUE(whole.depth == cut.depth) << scene;
      EXPECT_TRUE(whole.ids == cut.ids) << scene;
    }
  }
}

// A picture larger than its targets consists of parts. Where they meet, the same picture moved up
// has no border.
TEST_F(Slices, ALargePictureIsMadeOfPartsThatMeet) {
  open("builtin:knot?tubular=60&radial=12");
  constexpr std::size_t kWidth = 3000, kHeight = 1600, kMoved = 400;
  const SceneShot still = shot(kWidth, kHeight, 0);
  SceneShot up = still;
  up.camera.shift_px.y = kMoved;
  const SceneFrame a = pictures_->draw(still).take(), b = pictures_->draw(up).take();
  EXPECT_LT(pictures_->gpu_bytes(still), kWidth * kHeight * 24) << "it takes two";
  std::size_t most = 0;  // most differing pixels in a row
  for (std::size_t y = kMoved; y < kHeight; ++y) {
    std::size_t differing = 0;
    for (std::size_t x = 0; x < kWidth; ++x) {
      const std::size_t at = y * kWidth + x, moved = at - kMoved * kWidth;
      differing += a.ids[at] != b.ids[moved] || std::abs(a.depth[at] - b.depth[moved]) > 1e-4f;
    }
    most = std::max(most, differing);
  }
  EXPECT_LT(most, kWidth / 500);
}

// The device would shrink its viewport silently.
TEST_F(Slices, APictureBeyondTheDevicesViewportIsRefused) {
  open("builtin:knot?tubular=60&radial=12");
  SceneShot tall = shot(64, 8192, 0);
  tall.supersample = 1;
  EXPECT_TRUE(pictures_->begin(tall));
  tall.supersample = 16;
  EXPECT_FALSE(pictures_->begin(tall));
  EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
}

TEST_F(Slices, ATileIsTheSameHoweverItIsCut) {
  for (const char* scene : {"builtin:forest?trees=6&clutter=20", "builtin:clutter?objects=40"}) {
    open(scene);
    for (const std::uint8_t channels :
         {kLitTile, kRelitTile, kLayeredTile, kShadowTile, kCasterTile}) {
      const std::uint32_t instance = 3;
      const NeedMask needs = prepared_->objects[prepared_->scene.instances[instance].object].needs;
      if (channels == kRelitTile && !can_relight(needs)) continue;
      if (channels == kLayeredTile && !layered(needs)) continue;
      const TileJob job = tile(instance, channels, 512);
      const std::shared_ptr<const PagePixels> whole = page_of(job);
      ASSERT_TRUE(pages_->begin_slow(job, kSmallSlice));
      std::shared_ptr<const PagePixels> cut;
      int slices = 0;
      while (!cut) {
        page_of(tile(0, kLitTile, 64));
        cut = pages_->draw_slow_slice();
        ++slices;
      }
      std::printf("%s, channels %d: %d slices\n", scene, channels, slices);
      EXPECT_GT(slices, 2) << scene << " " << int{channels};
      EXPECT_TRUE(whole->rgba == cut->rgba) << scene << " " << int{channels};
      EXPECT_TRUE(whole->depth == cut->depth) << scene << " " << int{channels};
      EXPECT_TRUE(whole->surface == cut->surface) << scene << " " << int{channels};
    }
  }
}

}  // namespace
}  // namespace mirage::test
