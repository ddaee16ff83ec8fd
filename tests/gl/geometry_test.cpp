// Geometry on the client against the same drawn from the server's own data: quantised vertices,
// octahedral normals and compressed images must not show.

#include <gtest/gtest.h>

#include <cmath>

#include "client/draw/frame_renderer.h"
#include "client/frame/planned_frame.h"
#include "protocol/codec/mip_chain.h"
#include "protocol/codec/tile_codec.h"
#include "server/stage/image_stage.h"
#include "tests/gl/bench.h"

namespace mirage {
namespace {

constexpr int kSize = 384;

class GeometryBench {
 public:
  static std::unique_ptr<GeometryBench> create(const std::string& spec) {
    auto bench = std::make_unique<GeometryBench>();
    Result<gl::EglContext> egl = gl::EglContext::create("auto");
    Result<std::shared_ptr<const PreparedScene>> scene = load_scene(spec);
    if (!egl || !scene) return nullptr;
    bench->egl_ = std::move(*egl);
    bench->prepared_ = scene.take();
    bench->renderer_ = std::make_unique<FrameRenderer>(FrameRenderer::create(256, 1).take());
    bench->target_ = std::make_unique<FrameTarget>(FrameTarget::create(kSize, kSize, 4).take());
    std::optional<SceneView> told = test::scene_as_told(bench->prepared_);
    if (!told) return nullptr;
    bench->scene_ = std::move(*told);
    return bench;
  }

  const PreparedScene& prepared() const { return *prepared_; }
  std::size_t levels(std::uint32_t object) const { return prepared_->objects[object].lods.size(); }

  std::vector<std::uint8_t> from_server_data(std::uint32_t object, double radii) {
    EXPECT_TRUE(renderer_->reset(scene_));
    for (std::uint32_t i = 0; i < scene_.images.size(); ++i) {
      renderer_->add_image(i, prepared_->scene.images[i], prepared_->mips[i]);
    }
    const Scene& scene = prepared_->scene;
    EXPECT_TRUE(renderer_->add_mesh(object, 0, object_model(scene, scene.objects[object].mesh)));
    return draw(object, radii);
  }

  std::vector<std::uint8_t> through_the_wire(std::uint32_t object, std::size_t lod, double radii) {
    EXPECT_TRUE(renderer_->reset(scene_));
    for (std::uint32_t i = 0; i < scene_.images.size(); ++i) {
      const auto level = static_cast<std::uint8_t>(image_levels(scene_.images[i]) - 1);
      const Bytes bytes = ImageStage::encode(*prepared_, {i, level});
      const ImageDescription& described = scene_.images[i];
      const Result<Image> image = decode_image(bytes.data(), bytes.size(),
                                               image_level_size(described, level), described.srgb);
      const float cutoff = described.alpha_cutoff;
      renderer_->add_image(
          i, *image, cutoff > 0 ? alpha_preserving_mips(*image, cutoff) : std::vector<Image>{});
    }
    const EncodedLod& encoded = prepared_->geometry[object].encoded[lod];
    const Bytes raw =
        encoded.raw_bytes == encoded.payload.size()
            ? encoded.payload
            : decompress_block(encoded.payload.data(), encoded.payload.size(), encoded.raw_bytes)
                  .take();
    EXPECT_TRUE(renderer_->add_mesh(
        object, 0, decode_model(raw.data(), raw.size(), scene_.images.size()).take()));
    return draw(object, radii);
  }

  std::vector<std::uint8_t> nothing(std::uint32_t object, double radii) {
    EXPECT_TRUE(renderer_->reset(scene_));
    return draw(object, radii);
  }

 private:
  std::vector<std::uint8_t> draw(std::uint32_t object, double radii) {
    std::uint32_t instance = 0;
    while (scene_.instances.at(instance).object != object) ++instance;
    const InstanceView& view = scene_.instances[instance];
    Camera c;
    c.width = c.height = kSize;
    c.fov_y = 2.0 * std::asin(std::min(0.9, 1.05 / radii));
    const glm::dvec3 direction = glm::normalize(glm::dvec3(0.5, 0.35, 0.8));
    c.pose = look_at(view.center + direction * (radii * view.radius), view.center);
    c.fit_depth_range(scene_.bounds_center, scene_.bounds_radius);
    DrawList list;
    list.meshes = {{instance, 0, 1.0f}};
    renderer_->draw(*target_, {c, &scene_, list, scene_.lighting});
    return target_->read();
  }

  gl::EglContext egl_;
  std::shared_ptr<const PreparedScene> prepared_;
  SceneView scene_;
  std::unique_ptr<FrameRenderer> renderer_;
  std::unique_ptr<FrameTarget> target_;
};

/// Returns the PSNR over the pixels that differ from the empty picture in either.
double masked_psnr(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b,
                   const std::vector<std::uint8_t>& empty) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i + 3 < a.size(); i += 4) {
    const auto same = [&](const std::vector<std::uint8_t>& image) {
      return std::equal(image.begin() + static_cast<std::ptrdiff_t>(i),
                        image.begin() + static_cast<std::ptrdiff_t>(i + 3),
                        empty.begin() + static_cast<std::ptrdiff_t>(i));
    };
    if (same(a) && same(b)) continue;
    for (std::size_t c = i; c < i + 3; ++c) {
      const double d = double(a[c]) - double(b[c]);
      sum += d * d;
    }
    count += 3;
  }
  EXPECT_GT(count, 3000) << "there is a picture";
  return 10 * std::log10(255.0 * 255.0 * count / std::max(sum, 1e-9));
}

TEST(Geometry, KnotThroughTheWireLooksTheSame) {
  const auto bench = GeometryBench::create("builtin:knot");
  ASSERT_TRUE(bench);
  const auto empty = bench->nothing(0, 2.5), full = bench->from_server_data(0, 2.5);
  const double same = masked_psnr(full, bench->through_the_wire(0, 0, 2.5), empty);
  std::printf("[ FIGURES  ] knot through the wire, level 0: %.1f dB\n", same);
  EXPECT_GE(same, 45.0);
  for (std::size_t lod = 1; lod < bench->levels(0); ++lod) {
    std::printf("[ FIGURES  ] knot level %zu: %.1f dB\n", lod,
                masked_psnr(full, bench->through_the_wire(0, lod, 2.5), empty));
  }
}

TEST(Geometry, TreesThroughTheWireLookTheSame) {
  const auto bench = GeometryBench::create("builtin:forest?trees=40&clutter=1");
  ASSERT_TRUE(bench);
  double best = 0;
  for (std::uint32_t tree = 0; tree < 4; ++tree) {
    const auto empty = bench->nothing(tree, 2.5), full = bench->from_server_data(tree, 2.5);
    const double same = masked_psnr(full, bench->through_the_wire(tree, 0, 2.5), empty);
    std::printf("[ FIGURES  ] %s through the wire, level 0: %.1f dB\n",
                bench->prepared().scene.objects[tree].name.c_str(), same);
    // Thousands of leaf edges move by up to 1/150 px. One sample of four flips in every 40 edge
    // pixels, which alone gives some 43 dB on the tree with the most edges.
    EXPECT_GE(same, 42.5);
    best = std::max(best, same);
  }
  EXPECT_GE(best, 45.0);
}

}  // namespace
}  // namespace mirage
