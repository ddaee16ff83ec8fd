// The sun's shadows: they are right in the truth, tiles carry them, and the client's picture has
// them whether it is drawn from meshes or from impostors.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstring>

#include "client/draw/frame_renderer.h"
#include "client/draw/frame_target.h"
#include "client/frame/planned_frame.h"
#include "client/frame/reference_frame.h"
#include "client/hold/shadow_cache.h"
#include "client/hold/tile_cache.h"
#include "client/plan/tile_need.h"
#include "client/scene/scene_view.h"
#include "client/session/client_session.h"
#include "protocol/base/limits.h"
#include "protocol/codec/atlas_planes.h"
#include "protocol/codec/tile_codec.h"
#include "protocol/impostor/capture.h"
#include "protocol/impostor/error_bound.h"
#include "protocol/impostor/lighting_state.h"
#include "protocol/model/scene_types.h"
#include "protocol/quality/metrics.h"
#include "protocol/wire/conversions.h"
#include "server/prepare/object_description.h"
#include "server/prepare/prepared_scene.h"
#include "server/render/gpu_scene.h"
#include "server/render/readback_ring.h"
#include "server/render/reference_renderer.h"
#include "server/render/scene_shadow.h"
#include "server/render/tile_page.h"
#include "server/scene/gltf/bounds.h"
#include "server/tile/tile_encode.h"
#include "shaders/gl/egl_context.h"

namespace mirage::test {
namespace {

constexpr std::uint32_t kShadowEdge = 256;
const glm::vec3 kSun = glm::normalize(glm::vec3(0.4f, -1, 0.2f));
constexpr double kBoxHeight = 3;  // height of its centre above the ground; its edge is 2

Mesh box_mesh(const glm::vec3& half) {
  Mesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0f, 1.0f}) {
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      for (int corner = 0; corner < 4; ++corner) {
        Vertex v{};
        glm::vec3 p(0), n(0);
        p[axis] = n[axis] = side;
        p[(axis + 1) % 3] = (corner & 1) ? 1.0f : -1.0f;
        p[(axis + 2) % 3] = (corner & 2) ? side : -side;
        v.position = p * half;
        v.normal = n;
        v.color = glm::u16vec4(65535);
        mesh.vertices.push_back(v);
      }
      for (const std::uint32_t i : {0u, 1u, 2u, 1u, 3u, 2u}) mesh.indices.push_back(first + i);
    }
  }
  mesh.primitives = {
      {PrimitiveKind::kTriangles, 0, static_cast<std::uint32_t>(mesh.indices.size()), 0}};
  return mesh;
}

// Returns a slab with its top at height 0, and a cube that hangs over it.
std::shared_ptr<PreparedScene> slab_and_cube() {
  auto out = std::make_shared<PreparedScene>();
  Scene& scene = out->scene;
  Material grey;
  grey.base_color = glm::vec4(0.5f, 0.5f, 0.5f, 1);
  grey.roughness = 1;
  grey.metallic = 0;
  scene.materials = {grey};
  SceneObject slab, cube;
  slab.mesh = box_mesh({8, 0.5f, 8});
  cube.mesh = box_mesh({1, 1, 1});
  scene.objects = {slab, cube};
  Similarity ground, above;
  ground.position = {0, -0.5, 0};
  above.position = {0, kBoxHeight, 0};
  scene.instances = {Instance{0, ground}, Instance{1, above}};
  Light sun;
  sun.color = glm::vec3(0.8f);
  sun.direction = kSun;
  scene.lighting.ambient = glm::vec3(0.2f);
  scene.lighting.lights = {sun};
  for (const SceneObject& object : scene.objects) {
    out->objects.push_back(describe_object(object, scene));
    out->geometry.push_back(make_geometry(scene, object, out->objects.back()));
  }
  out->grouping = no_groups(2);
  out->bounds_radius = 12;
  return out;
}

SceneView as_client_sees(const PreparedScene& prepared) {
  SceneView view;
  view.shadows = true;
  view.lighting = prepared.scene.lighting;
  view.environment = prepared.scene.environment;
  view.objects = prepared.objects;
  for (const Instance& i : prepared.scene.instances) {
    InstanceView one;
    one.object = i.object;
    one.world_from_object = i.world_from_object;
    one.center = i.world_from_object.position + glm::dvec3(prepared.objects[i.object].center);
    one.radius = prepared.objects[i.object].radius;
    view.instances.push_back(one);
  }
  view.bounds_center = prepared.bounds_center;
  view.bounds_radius = prepared.bounds_radius;
  return view;
}

class Shadows : public ::testing::Test {
 protected:
  void SetUp() override {
    Result<gl::EglContext> egl = gl::EglContext::create("auto");
    ASSERT_TRUE(egl);
    egl_ = std::move(*egl);
    prepared_ = slab_and_cube();
    light_ = prepared_->scene.lighting;
    scene_ = as_client_sees(*prepared_);
    gpu_ = std::make_unique<GpuScene>(prepared_);
    shadow_ = std::make_unique<SceneShadow>(SceneShadow::create(*gpu_).take());
    pages_ = std::make_unique<TilePageRenderer>(
        TilePageRenderer::create(*gpu_, 2, shadow_.get()).take());
    renderer_ = std::make_unique<FrameRenderer>(FrameRenderer::create(1024, 2).take());
    ASSERT_TRUE(renderer_->reset(scene_));
    target_ =
        std::make_unique<FrameTarget>(FrameTarget::create(kShadowEdge, kShadowEdge, 4).take());
    camera_.width = camera_.height = kShadowEdge;
    camera_.pose = look_at({6, 9, 12}, {0, 0.5, 0});
    camera_.fit_depth_range(prepared_->bounds_center, prepared_->bounds_radius);
  }

  ReferenceFrame truth(SceneShadow* shadow) {
    ReferenceRenderer renderer = ReferenceRenderer::create(*gpu_, shadow).take();
    SceneShot shot;
    shot.camera = camera_;
    shot.supersample = 4;
    shot.lighting = light_;
    SceneFrame drawn = renderer.draw(shot).take();
    return {kShadowEdge, kShadowEdge, std::move(drawn.rgba), std::move(drawn.depth), {}};
  }

  /// Returns the world position that a pixel of the truth shows.
  glm::dvec3 world_at(const ReferenceFrame& frame, std::uint32_t x, std::uint32_t y) const {
    const double z = frame.depth[std::size_t{y} * kShadowEdge + x];
    const double f = camera_.focal_px(), half = 0.5 * kShadowEdge;
    const glm::dvec3 ray = camera_.forward() + camera_.right() * ((x + 0.625 - half) / f) -
                           camera_.up() * ((y + 0.625 - half) / f);
    return camera_.pose.eye + ray * z;
  }

  TileJob job(std::uint32_t instance, std::uint8_t channels, const glm::dvec3& eye,
              double distance_radii) const {
    TileJob out;
    out.key.object = prepared_->scene.instances[instance].object;
    out.key.cell = *view_cell_from_direction(eye, limits::kMaxViewLevel);
    out.key.distance = *distance_bucket_from_radii(distance_radii, limits::kMaxDistanceLevel);
    out.key.size_class = static_cast<std::uint8_t>(size_class_for(256));
    out.key.channels = channels;
    const ObjectDescription& object = prepared_->objects[out.key.object];
    if (channels == kLitTile) {
      out.lighting = object_lighting(light_, prepared_->scene.instances[instance].world_from_object,
                                     object.center, object.radius);
    } else if (channels == kShadowTile) {
      out.key.instance = instance + 1;
      out.key.lighting = lighting_hash(light_);
      out.world = light_;
    }
    return out;
  }

  std::vector<StoredTilePtr> render(const std::vector<TileJob>& jobs) {
    PagePacker packer(1024);
    PendingPage pending;
    pending.jobs = jobs;
    pending.surface = pages_->writes_surface(jobs);
    for (const TileJob& one : jobs) {
      packer.add(tile_edge(one.key.size_class));
      pending.places.emplace_back(packer.places().back().x, packer.places().back().y);
    }
    pending.width = packer.used().x;
    pending.height = packer.used().y;
    ReadbackRing ring(1);
    ring.start(*pages_->render(jobs, packer), pending);
    const ReadbackRing::Collected page = *ring.collect(true);
    std::vector<StoredTilePtr> out;
    for (std::size_t i = 0; i < jobs.size(); ++i) {
      const auto [x, y] = pending.places[i];
      out.push_back(encode_tile({jobs[i], *page.pixels, x, y, 0, 0},
                                prepared_->objects[jobs[i].key.object], TileCodec::kRaw));
    }
    return out;
  }

  static Tile decoded(const StoredTile& stored) {
    Tile tile = tile_from_fields(stored.reply).take();
    EXPECT_TRUE(
        decode_tile_planes(stored.planes.data(), stored.planes.size(), TileCodec::kRaw, tile));
    return tile;
  }

  Capture capture_of(const TileJob& one) const {
    return Capture(one.key.cell, one.key.distance, prepared_->objects[one.key.object].radius,
                   tile_edge(one.key.size_class));
  }

  ShadowRecordPtr hold(ShadowCache& cache, const TileJob& one) {
    const Tile tile = decoded(*render({one})[0]);
    const Capture capture = capture_of(one);
    if (one.key.channels == kCasterTile) {
      const ShadowRecordPtr record = cache.add_caster(one.key.object, capture, tile.crop, 1);
      EXPECT_TRUE(renderer_->upload_shadow(*record, atlas_planes(tile).depth));
      return record;
    }
    const ShadowRecordPtr record = cache.add_shadow(one.key.instance - 1, 1, capture, tile.crop, 1);
    EXPECT_TRUE(renderer_->upload_shadow(*record, atlas_planes(tile).shadow));
    return record;
  }

  void hold_mesh(std::uint32_t object) {
    ASSERT_TRUE(renderer_->add_mesh(
        object, 0, object_model(prepared_->scene, prepared_->scene.objects[object].mesh)));
  }

  std::vector<std::uint8_t> picture(const DrawList& list) {
    renderer_->draw(*target_, {camera_, &scene_, list, light_});
    return target_->read();
  }
  double psnr(const std::vector<std::uint8_t>& drawn, const ReferenceFrame& reference) const {
    const ImageView truth_view{kShadowEdge, kShadowEdge, reference.rgba.data()};
    const ImageView test_view{kShadowEdge, kShadowEdge, drawn.data()};
    return measure_images(truth_view, test_view).psnr_db.value_or(99);
  }

  gl::EglContext egl_;
  std::shared_ptr<PreparedScene> prepared_;
  Lighting light_;
  SceneView scene_;
  std::unique_ptr<GpuScene> gpu_;
  std::unique_ptr<SceneShadow> shadow_;
  std::unique_ptr<TilePageRenderer> pages_;
  std::unique_ptr<FrameRenderer> renderer_;
  std::unique_ptr<FrameTarget> target_;
  Camera camera_;
};

// Returns how far inside (> 0) or outside of the cube's shadow a point on the slab's top lies, m.
double inside_shadow(const glm::dvec3& p) {
  double inside = -1e9;
  // The shadow is the union of those of the cube's slices.
  for (int i = 0; i <= 64; ++i) {
    const double height = kBoxHeight - 1 + 2 * i / 64.0;
    const glm::dvec3 at = p - glm::dvec3(kSun) * ((height - p.y) / -kSun.y);
    inside = std::max(inside, 1 - std::max(std::abs(at.x), std::abs(at.z)));
  }
  return inside;
}

TEST_F(Shadows, TruthHasThemWhereTheSunPutsThemAndNowhereElse) {
  const ReferenceFrame with = truth(shadow_.get()), without = truth(nullptr);
  const double margin = 3 * SunFrame(kSun, {}, 12, kShadowMapEdge).texel_m() + 0.1;
  int dark = 0, bright = 0;
  for (std::uint32_t y = 1; y + 1 < kShadowEdge; ++y) {
    for (std::uint32_t x = 1; x + 1 < kShadowEdge; ++x) {
      const glm::dvec3 p = world_at(with, x, y);
      const bool on_top = std::abs(p.y) < 0.02 && std::max(std::abs(p.x), std::abs(p.z)) < 7.8;
      if (with.depth[std::size_t{y} * kShadowEdge + x] == 0 || !on_top) continue;
      const double inside = inside_shadow(p);
      const std::size_t i = (std::size_t{y} * kShadowEdge + x) * 4;
      if (inside > margin) {
        ++dark;
        // The value is ambient 0.2 of 0.2 + 0.8 n.l, as sRGB.
        ASSERT_NEAR(with.rgba[i], 89, 1) << x << ", " << y;
      } else if (inside < -margin) {
        ++bright;
        ASSERT_EQ(with.rgba[i], without.rgba[i]) << x << ", " << y << ": no acne";
      }
    }
  }
  EXPECT_GT(dark, 300);
  EXPECT_GT(bright, 5000);
}

TEST_F(Shadows, TileCarriesThemAndIsAFunctionOfItsKey) {
  const TileJob one = job(0, kShadowTile, {0.3, 1, 0.2}, 4);
  const StoredTilePtr alone = render({one})[0];
  const Tile tile = decoded(*alone);
  ASSERT_GT(tile.crop.area(), 1000u);
  const Capture capture = capture_of(one);
  int dark = 0, bright = 0;
  for (double x = -7.5; x <= 7.5; x += 0.25) {
    for (double z = -7.5; z <= 7.5; z += 0.25) {
      const double inside = inside_shadow({x, 0, z});
      const glm::dvec2 at = capture.texel_from_point({x, 0.5, z});
      const auto tx = static_cast<std::uint32_t>(at.x) - tile.crop.x;
      const auto ty = static_cast<std::uint32_t>(at.y) - tile.crop.y;
      const std::uint8_t share = tile.shadow[std::size_t{ty} * tile.crop.w + tx];
      // The slab's tile does not have the cube, only its shadow.
      if (inside > 0.25) {
        ++dark;
        const double left = 0.2 / (0.2 + 0.8 * -kSun.y);
        ASSERT_NEAR((share - 1) / 254.0, left, 0.03) << x << ", " << z;
      } else if (inside < -0.25) {
        ++bright;
        ASSERT_EQ(share, 255) << x << ", " << z;
      }
    }
  }
  EXPECT_GT(dark, 20);
  EXPECT_GT(bright, 2000);
  // Bytes are equal beside other tiles, and after a map for another sun has been drawn.
  TileJob other = one;
  other.world.lights[0].direction = glm::normalize(glm::vec3(-1, -1, 0));
  other.key.lighting = lighting_hash(other.world);
  const TileJob lit = job(1, kLitTile, {1, 1, 1}, 6), caster = job(1, kCasterTile, -kSun, 64);
  const std::vector<StoredTilePtr> page = render({other, lit, one, caster});
  EXPECT_EQ(page[2]->planes, alone->planes);
  EXPECT_NE(page[0]->planes, alone->planes);
  EXPECT_EQ(page[1]->planes, render({lit})[0]->planes);
  EXPECT_EQ(render({one})[0]->planes, alone->planes);
}

TEST_F(Shadows, ImpostorsCastOnGeometry) {
  ASSERT_NO_FATAL_FAILURE(hold_mesh(0));
  ASSERT_NO_FATAL_FAILURE(hold_mesh(1));
  ShadowCache cache;
  const ShadowRecordPtr tile = hold(cache, job(1, kCasterTile, -kSun, 64));
  CasterList casters;
  casters.frame = SunFrame(kSun, scene_.bounds_center, scene_.bounds_radius, kShadowMapEdge);
  casters.meshes = {{0, 0}};
  DrawList list;
  list.meshes = {{0, 0}, {1, 0}};
  const ReferenceFrame reference = truth(shadow_.get());
  const double none = psnr(picture(list), reference);
  list.casters = std::make_shared<const CasterList>(casters);
  const double alone = psnr(picture(list), reference);
  casters.tiles = {{1, tile}};
  list.casters = std::make_shared<const CasterList>(casters);
  const double from_tile = psnr(picture(list), reference);
  casters.tiles.clear();
  casters.meshes.push_back({1, 0});
  list.casters = std::make_shared<const CasterList>(casters);
  const double from_mesh = psnr(picture(list), reference);
  std::printf(
      "no shadows %.1f dB, slab as its own caster %.1f, cube cast by its tile %.1f, by its "
      "mesh %.1f\n",
      none, alone, from_tile, from_mesh);
  EXPECT_NEAR(alone, none, 0.5) << "the slab throws none on itself";
  EXPECT_GT(from_tile, none + 8);
  EXPECT_GT(from_mesh, none + 12);
}

TEST_F(Shadows, ImpostorsWearThem) {
  TileCache tiles(1024, 2);
  tiles.reset(scene_, light_);
  ShadowCache cache;
  const ReferenceFrame reference = truth(shadow_.get());
  for (const std::uint8_t kind : {kLitTile, kRelitTile}) {
    DrawList list;
    for (const std::uint32_t instance : {0u, 1u}) {
      const ViewGeometry view =
          view_geometry(camera_, scene_.instances[instance], scene_.objects[instance]);
      TileJob one = job(instance, kind, view.eye, glm::length(view.eye) / view.radius);
      one.key.size_class = static_cast<std::uint8_t>(size_class_for(512));
      Tile tile = decoded(*render({one})[0]);
      const AtlasPlanes planes = atlas_planes(tile);
      const TileRecordPtr record =
          tiles.insert(instance, scene_, capture_of(one), std::move(tile), 1, 0);
      ASSERT_TRUE(record);
      ASSERT_TRUE(renderer_->upload(*record, planes));
      list.impostors.push_back({instance, record, DrawMethod::kQuad, 0, 10, 1});
    }
    for (const DrawMethod method : {DrawMethod::kQuad, DrawMethod::kDepth}) {
      for (DrawnImpostor& drawn : list.impostors) {
        drawn.method = method;
        drawn.shadow.reset();
      }
      const double bare = psnr(picture(list), reference);
      // The shadows are captured from elsewhere than the picture, and are found by the points
      // shown.
      list.impostors[0].shadow = hold(cache, job(0, kShadowTile, {0.2, 1, 0.5}, 3));
      list.impostors[1].shadow = hold(cache, job(1, kShadowTile, {0.4, 0.8, 1}, 8));
      const double worn = psnr(picture(list), reference);
      std::printf("%s tiles, %s: %.1f dB bare, %.1f with shadow tiles\n",
                  kind == kLitTile ? "lit" : "relit",
                  method == DrawMethod::kQuad ? "quad" : "relief", bare, worn);
      EXPECT_GT(worn, bare + 8);
    }
  }
}

}  // namespace
}  // namespace mirage::test
