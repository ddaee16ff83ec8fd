#include "tests/extreme/studio.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "client/draw/frame_target.h"
#include "client/frame/planned_frame.h"
#include "client/plan/tile_need.h"
#include "protocol/base/limits.h"
#include "protocol/base/stable_math.h"
#include "protocol/codec/atlas_planes.h"
#include "protocol/codec/model_codec.h"
#include "protocol/codec/tile_codec.h"
#include "protocol/impostor/error_bound.h"
#include "protocol/impostor/lighting_state.h"
#include "protocol/wire/conversions.h"
#include "server/render/gpu_scene.h"
#include "server/render/readback_ring.h"
#include "server/tile/tile_encode.h"
#include "tests/gl/bench.h"

namespace mirage::extreme {
namespace {

constexpr int kAtlasEdge = 1024;
constexpr int kAtlasLayers = 4;

}  // namespace

Result<std::unique_ptr<Studio>> Studio::create(const std::string& spec,
                                               const StudioOptions& options) {
  return create(load_scene(spec), options);
}

Result<std::unique_ptr<Studio>> Studio::create(Scene scene, const StudioOptions& options) {
  return create(prepare_scene(std::move(scene)), options);
}

Result<std::unique_ptr<Studio>> Studio::create(Result<std::shared_ptr<const PreparedScene>> loaded,
                                               const StudioOptions& options) {
  auto studio = std::make_unique<Studio>();
  if (!loaded) return loaded.error();
  Result<gl::EglContext> egl = gl::EglContext::create("auto");
  if (!egl) return egl.error();
  studio->egl_ = egl.take();
  studio->options_ = options;
  studio->prepared_ = loaded.take();
  studio->light_ = studio->prepared_->scene.lighting;
  studio->gpu_ = std::make_unique<GpuScene>(studio->prepared_);
  Result<TilePageRenderer> pages = TilePageRenderer::create(*studio->gpu_, options.samples);
  if (!pages) return pages.error();
  studio->pages_ = std::make_unique<TilePageRenderer>(pages.take());
  Result<ReferenceRenderer> references = ReferenceRenderer::create(*studio->gpu_);
  if (!references) return references.error();
  studio->references_ = std::make_unique<ReferenceRenderer>(references.take());
  Result<FrameRenderer> renderer = FrameRenderer::create(kAtlasEdge, kAtlasLayers, kFlatMethods);
  if (!renderer) return renderer.error();
  studio->renderer_ = std::make_unique<FrameRenderer>(renderer.take());
  std::optional<SceneView> told = test::scene_as_told(studio->prepared_);
  if (!told) return make_error(ErrorId::kWireState, "the scene does not get across");
  studio->scene_ = std::move(*told);
  if (Result<void> made = studio->renderer_->reset(studio->scene_); !made) return made.error();
  studio->cache_ = std::make_unique<TileCache>(kAtlasEdge, kAtlasLayers);
  studio->cache_->reset(studio->scene_, studio->light_);
  return studio;
}

Camera Studio::camera(std::uint32_t instance, const glm::dvec3& direction, double radii, int size,
                      double fill) const {
  const InstanceView& view = scene_.instances[instance];
  const double r = view.radius, d = radii * r;
  Camera c;
  c.width = c.height = static_cast<std::uint32_t>(size);
  c.fov_y = 2.0 * std::atan(fill * r / tangent_length(d, r));
  c.pose = look_at(view.center + safe_normalize(direction) * d, view.center);
  c.fit_depth_range(scene_.bounds_center, scene_.bounds_radius);
  return c;
}

TileKey Studio::key_for(const Camera& camera, std::uint32_t instance, std::uint8_t channels) const {
  const InstanceView& view_of = scene_.instances[instance];
  const ObjectDescription& object = scene_.objects[view_of.object];
  const ViewGeometry view = view_geometry(camera, view_of, object);
  TileKey key;
  key.scene_revision = scene_.revision;
  key.object = view_of.object;
  const std::optional<ViewCell> cell = view_cell_from_direction(view.eye, limits::kMaxViewLevel);
  const std::optional<DistanceBucket> distance =
      distance_bucket_from_radii(glm::length(view.eye) / view.radius, limits::kMaxDistanceLevel);
  if (cell) key.cell = *cell;
  if (distance) key.distance = *distance;
  // A client asks for nothing of an object without extent.
  if (view.radius > 0) key.size_class = need_for_view(view, ViewPlan{}).size_class;
  key.channels = channels;
  return key;
}

MadeTile Studio::make_tile(const TileKey& key, std::uint32_t instance, TileCodec codec) {
  make_current();
  const ObjectDescription& object = prepared_->objects[key.object];
  TileJob job;
  job.key = key;
  job.id = tile_id(key);
  job.lighting = object_lighting(light_, scene_.instances[instance].world_from_object,
                                 object.center, object.radius);
  PagePacker packer(512);
  packer.add(tile_edge(key.size_class));
  ReadbackRing ring(1);
  PendingPage pending;
  pending.jobs = {job};
  pending.places = {{0, 0}};
  pending.width = packer.used().x;
  pending.height = packer.used().y;
  pending.surface = pages_->writes_surface({job});
  ring.start(*pages_->render({job}, packer), pending);
  const ReadbackRing::Collected page = *ring.collect(true);
  const StoredTilePtr stored = encode_tile({job, *page.pixels, 0, 0, 0, 0}, object, codec);
  MadeTile out;
  out.header = stored->reply;
  // The rest does what a client does with a reply.
  out.capture = Capture(key.cell, key.distance, object.radius, tile_edge(key.size_class));
  Result<Tile> tile = tile_from_fields(stored->reply);
  if (!tile) return out;
  out.tile = tile.take();
  if (!decode_tile_planes(stored->planes.data(), stored->planes.size(), codec, out.tile)) {
    out.tile = Tile{};
  }
  return out;
}

TileRecordPtr Studio::hold(const MadeTile& made, std::uint32_t instance) {
  make_current();
  const AtlasPlanes planes = atlas_planes(made.tile);
  cache_->relight(light_, 0);
  TileRecordPtr record = cache_->insert(instance, scene_, made.capture, made.tile, ++frame_, 0);
  if (record && !renderer_->upload(*record, planes)) return nullptr;
  return record;
}

Pixels Studio::draw(const Camera& camera, const DrawList& list) {
  make_current();
  const int w = static_cast<int>(camera.width), h = static_cast<int>(camera.height);
  if (!target_ || target_->width() != w || target_->height() != h) {
    Result<FrameTarget> made = FrameTarget::create(w, h, options_.msaa, scene_.blends());
    if (!made) return {};
    target_ = made.take();
  }
  renderer_->draw(*target_, {camera, &scene_, list, light_});
  return target_->read();
}

DrawList Studio::impostor_list(const Camera& camera, DrawMethod method, std::uint8_t channels) {
  DrawList list;
  for (std::uint32_t i = 0; i < prepared_->scene.instances.size(); ++i) {
    const double distance = glm::length(scene_.instances[i].center - camera.pose.eye);
    const TileRecordPtr tile = hold(make_tile(key_for(camera, i, channels), i), i);
    if (tile) list.impostors.push_back({i, tile, method, 0, distance, 1});
  }
  std::stable_sort(list.impostors.begin(), list.impostors.end(),
                   [](const auto& a, const auto& b) { return a.distance > b.distance; });
  return list;
}

Pixels Studio::impostors(const Camera& camera, DrawMethod method, std::uint8_t channels) {
  return draw(camera, impostor_list(camera, method, channels));
}

Pixels Studio::meshes(const Camera& camera) {
  make_current();
  const Scene& own = prepared_->scene;
  for (std::uint32_t i = 0; i < own.objects.size(); ++i) {
    const Bytes bytes = encode_model(object_model(own, own.objects[i].mesh));
    Result<ObjectModel> model =
        decode_model(bytes.data(), bytes.size(), static_cast<std::uint32_t>(own.images.size()));
    if (!model || !renderer_->add_mesh(i, 0, model.take())) return {};
  }
  for (std::uint32_t i = 0; i < own.images.size(); ++i) {
    renderer_->add_image(i, own.images[i], prepared_->mips[i]);
  }
  DrawList list;
  for (std::uint32_t i = 0; i < own.instances.size(); ++i) list.meshes.push_back({i, 0, 1});
  return draw(camera, list);
}

ReferenceFrame Studio::truth(const Camera& camera, std::uint32_t samples) {
  make_current();
  SceneShot shot;
  shot.camera = camera;
  shot.supersample = samples;
  shot.lighting = light_;
  Result<SceneFrame> drawn = references_->draw(shot);
  if (!drawn) return {camera.width, camera.height, {}, {}, {}};
  return {camera.width, camera.height, std::move(drawn->rgba), std::move(drawn->depth),
          std::move(drawn->ids)};
}

Outcome no_studio(const Error& error) {
  Checks checks;
  checks.failed(error.line());
  return checks.outcome();
}

int largest_difference(const Pixels& a, const Pixels& b) {
  if (a.size() != b.size() || a.empty()) return 256;
  int most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

int not_finite(const wire::TileReplyT& h) {
  int bad = 0;
  for (const float v : {h.plane_depth, h.depth_min, h.depth_max, h.dz_quad, h.dz_cuboid, h.dz_hull,
                        h.depth_gap, h.dz_behind, h.lod_error}) {
    bad += std::isfinite(v) ? 0 : 1;
  }
  return bad;
}

int encoded(double linear_value) {
  const double v = std::clamp(linear_value, 0.0, 1.0);
  const double s = v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
  return static_cast<int>(std::lround(s * 255));
}

int above_alpha(const Pixels& rgba) {
  int n = 0;
  for (std::size_t i = 0; i < rgba.size(); i += 4) {
    const int most = encoded((rgba[i + 3] + 0.5) / 255.0);
    for (std::size_t c = 0; c < 3; ++c) n += rgba[i + c] > most ? 1 : 0;
  }
  return n;
}

std::size_t covered(const Pixels& rgba, int alpha) {
  std::size_t n = 0;
  for (std::size_t i = 3; i < rgba.size(); i += 4) n += rgba[i] >= alpha ? 1 : 0;
  return n;
}

}  // namespace mirage::extreme
