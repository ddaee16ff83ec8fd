// An impostor drawn from the view it was captured for, against the full render of the same build:
// the fidelity protocol of the field (24 Fibonacci directions, tight field of view).

#include <gtest/gtest.h>

#include <cmath>

#include "client/core/frame_renderer.h"
#include "client/core/geometric_error.h"
#include "client/quality/metrics.h"
#include "server/encode_stage.h"
#include "server/render/readback_ring.h"
#include "server/render/reference_renderer.h"
#include "server/render/tile_page.h"
#include "server/session.h"
#include "shaders/gl/egl_context.h"

namespace mirage {
namespace {

constexpr int kSize = 512;
constexpr int kDirections = 24;

glm::dvec3 fibonacci_direction(int i) {
  const double s = std::sin(5.0 * 0.017453292519943295);
  const double y = s + (1.0 - s) * (i + 0.5) / kDirections;
  const double azimuth = 2.399963 * i, ring = std::sqrt(1.0 - y * y);
  return {ring * std::cos(azimuth), y, ring * std::sin(azimuth)};
}

// Server and client of one scene in one GL context.
class Bench {
 public:
  static std::unique_ptr<Bench> create(const std::string& spec) {
    auto bench = std::make_unique<Bench>();
    Result<gl::EglContext> egl = gl::EglContext::create("auto");
    if (!egl) return nullptr;
    bench->egl_ = std::move(*egl);
    Result<std::shared_ptr<const PreparedScene>> scene = load_scene(spec);
    if (!scene) return nullptr;
    bench->prepared_ = scene.take();
    bench->gpu_ = std::make_unique<GpuScene>(bench->prepared_);
    bench->pages_ =
        std::make_unique<TilePageRenderer>(TilePageRenderer::create(*bench->gpu_, 2).take());
    bench->references_ =
        std::make_unique<ReferenceRenderer>(ReferenceRenderer::create(*bench->gpu_).take());
    bench->renderer_ = std::make_unique<FrameRenderer>(FrameRenderer::create(1024, 4).take());
    bench->target_ = std::make_unique<FrameTarget>(FrameTarget::create(kSize, kSize, 4).take());
    bench->describe();
    return bench;
  }

  const InstanceView& instance() const { return scene_.instances[0]; }

  Camera camera(double radii, const glm::dvec3& direction) const {
    const double r = instance().radius, d = radii * r;
    Camera c;
    c.width = c.height = kSize;
    c.fov_y = 2.0 * std::atan(1.05 * r / std::sqrt((d - r) * (d + r)));
    c.pose = look_at(instance().center + direction * d, instance().center);
    c.fit_depth_range(prepared_->bounds_center, prepared_->bounds_radius);
    return c;
  }

  // The tile captured for exactly this camera, through the real encoder and decoder.
  TileRecordPtr tile_for(const Camera& c, TileCache& cache) {
    const ObjectDescription& object = scene_.objects[0];
    const ViewGeometry view = view_geometry(c, instance(), object);
    TileNeed need = need_for_view(view, 1.0);
    need.cell = *view_cell_from_direction(view.eye, limits::kMaxViewLevel);
    need.distance = *distance_bucket_from_radii(glm::length(view.eye) / view.radius, 16);
    TileJob job;
    job.key.cell = need.cell;
    job.key.distance = need.distance;
    job.key.size_class = need.size_class;
    job.lighting = object_lighting(scene_.lighting, instance().world_from_object, object.center,
                                   object.radius);
    PagePacker packer(512);
    packer.add(tile_edge(need.size_class));
    ReadbackRing ring(1);
    PendingPage pending;
    pending.jobs = {job};
    pending.places = {{0, 0}};
    pending.edge = packer.page_edge();
    ring.start(*pages_->render({job}, packer), pending);
    const ReadbackRing::Collected page = *ring.collect(true);
    const StoredTilePtr stored =
        EncodeStage::encode({job, page.pixels, 0, 0, 0, 0}, object, TileCodec::kZstd);
    Tile tile = tile_from_fields(stored->reply).take();
    EXPECT_TRUE(
        decode_tile_planes(stored->planes.data(), stored->planes.size(), TileCodec::kZstd, tile));
    const std::vector<std::uint8_t> rgba = tile.rgba;
    const Capture capture(need.cell, need.distance, object.radius, tile.edge);
    TileRecordPtr record = cache.insert(0, scene_, capture, std::move(tile), 1, 0);
    if (record) renderer_->upload(*record, rgba);
    return record;
  }

  std::vector<std::uint8_t> draw(const Camera& c, const TileRecordPtr& tile, DrawMethod method) {
    DrawList list;
    list.impostors.push_back({0, tile, method, 0, glm::length(c.pose.eye), 1});
    renderer_->draw(*target_, c, scene_, list, scene_.lighting);
    return target_->read();
  }

  std::vector<std::uint8_t> truth(const Camera& c, std::uint32_t samples) {
    ReferenceJob job;
    job.camera = c;
    job.supersample = samples;
    job.lighting = scene_.lighting;
    const Bytes bytes = references_->render(job).take();
    const Message message = decode_message(bytes.data(), bytes.size()).take();
    const std::size_t pixels = std::size_t{c.width} * c.height;
    const Bytes raw =
        decompress_block(message.payload.data(), message.payload.size(), pixels * 12).take();
    return {raw.begin(), raw.begin() + static_cast<std::ptrdiff_t>(pixels * 4)};
  }

  SceneView& scene() { return scene_; }

 private:
  void describe() {
    // Through the protocol, as a client learns it.
    const SteadyClock clock;
    Counters counters;
    TileQueue queue(clock, counters);
    TileStore store(1 << 20, "", counters);
    BoundedQueue<ImageLevel> image_jobs(16);
    SessionHub hub(prepared_, {}, clock, counters, queue, store, image_jobs);
    const SessionId id = hub.open().take();
    wire::HelloT hello;
    hello.version_min = hello.version_max = limits::kProtocolVersion;
    hello.codecs = {0, 1};
    const Bytes greeting = encode_message(std::move(hello));
    ASSERT_TRUE(hub.receive(id, greeting.data(), greeting.size()));
    while (const FramePtr frame = hub.next_frame(id)) {
      Message m = decode_message(frame->data(), frame->size()).take();
      if (m.body.AsWelcome()) {
        EXPECT_TRUE(scene_.accept(*m.body.AsWelcome()));
      }
      if (m.body.AsImagePage()) {
        EXPECT_TRUE(scene_.accept(*m.body.AsImagePage()));
      }
      if (m.body.AsObjectPage()) {
        EXPECT_TRUE(scene_.accept(*m.body.AsObjectPage()));
      }
      if (m.body.AsInstancePage()) {
        EXPECT_TRUE(scene_.accept(*m.body.AsInstancePage()));
      }
    }
    ASSERT_TRUE(scene_.complete());
    renderer_->reset(scene_);
  }

  gl::EglContext egl_;
  std::shared_ptr<const PreparedScene> prepared_;
  SceneView scene_;
  std::unique_ptr<GpuScene> gpu_;
  std::unique_ptr<TilePageRenderer> pages_;
  std::unique_ptr<ReferenceRenderer> references_;
  std::unique_ptr<FrameRenderer> renderer_;
  std::unique_ptr<FrameTarget> target_;
};

struct Fidelity {
  double psnr = 0, ssim = 0, iou = 0;
};

Fidelity exactly_viewed(Bench& bench, double radii, DrawMethod method) {
  Fidelity mean;
  for (int i = 0; i < kDirections; ++i) {
    TileCache cache(1024, 4);
    cache.reset(bench.scene(), bench.scene().lighting);
    const Camera c = bench.camera(radii, fibonacci_direction(i));
    const TileRecordPtr tile = bench.tile_for(c, cache);
    if (!tile) {
      ADD_FAILURE() << "empty tile for direction " << i;
      continue;
    }
    const std::vector<std::uint8_t> drawn = bench.draw(c, tile, method);
    const std::vector<std::uint8_t> truth = bench.truth(c, 4);
    const FieldFidelity f =
        field_fidelity({kSize, kSize, truth.data()}, {kSize, kSize, drawn.data()});
    mean.psnr += f.psnr_db.value_or(0) / kDirections;
    mean.ssim += f.ssim.value_or(0) / kDirections;
    mean.iou += f.iou.value_or(0) / kDirections;
  }
  return mean;
}

TEST(Fidelity, KnotExactlyViewedAtFourRadii) {
  const std::unique_ptr<Bench> bench = Bench::create("builtin:knot");
  ASSERT_TRUE(bench);
  const Fidelity quad = exactly_viewed(*bench, 4, DrawMethod::kQuad);
  std::printf("[ FIGURES  ] knot lit 4r exactly viewed, quad: PSNR %.1f dB, SSIM %.4f, IoU %.4f\n",
              quad.psnr, quad.ssim, quad.iou);
  EXPECT_GE(quad.psnr, 40.0);
  EXPECT_GE(quad.ssim, 0.99);
  EXPECT_GE(quad.iou, 0.99);
}

// Every method shows the same picture from the capture pose: proxies only matter away from it.
TEST(Fidelity, MethodsAgreeAtTheCapturePose) {
  const std::unique_ptr<Bench> bench = Bench::create("builtin:knot");
  ASSERT_TRUE(bench);
  TileCache cache(1024, 4);
  cache.reset(bench->scene(), bench->scene().lighting);
  const Camera c = bench->camera(4, fibonacci_direction(5));
  const TileRecordPtr tile = bench->tile_for(c, cache);
  ASSERT_TRUE(tile);
  const std::vector<std::uint8_t> quad = bench->draw(c, tile, DrawMethod::kQuad);
  for (const DrawMethod method :
       {DrawMethod::kCuboid, DrawMethod::kHull, DrawMethod::kWarp, DrawMethod::kDepth}) {
    const std::vector<std::uint8_t> other = bench->draw(c, tile, method);
    const FieldFidelity f =
        field_fidelity({kSize, kSize, quad.data()}, {kSize, kSize, other.data()});
    // Marching finds depth steps within a texel; the flat proxies differ by rounding only.
    const double least = method == DrawMethod::kDepth ? 33.0 : 50.0;
    EXPECT_GE(f.psnr_db.value_or(0), least) << "method " << static_cast<int>(method);
  }
}

}  // namespace
}  // namespace mirage
