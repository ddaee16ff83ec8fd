#include "client/freeze/sampler.h"

#include <algorithm>
#include <cmath>

#include "client/frame/planned_frame.h"
#include "client/freeze/eyes.h"
#include "client/hold/mesh_cache.h"
#include "client/link/modelled_link.h"
#include "client/price/frame_work.h"
#include "client/scene/scene_view.h"
#include "client/session/client_session.h"
#include "client/session/session_options.h"
#include "client/session/tile_sink.h"
#include "protocol/base/clock.h"
#include "protocol/codec/codec_id.h"

namespace mirage {
namespace {

constexpr std::int64_t kFrameUs = 33'000;
constexpr int kMostFrames = 120;  // at an eye
// Between two eyes: none of them is on the way to the other.
constexpr std::int64_t kJumpUs = 3'000'000;
constexpr int kFadingFrames = 15;
constexpr int kOpeningFrames = 2000;
constexpr double kTileMs = 0.1;  // of the modelled server: it is not waited for

ClientOptions session_options(const FreezeOptions& options) {
  ClientOptions out;
  out.tau_px = options.error_px;
  out.name = "mirage-freeze";
  out.samples = 4;
  out.geometry_first = true;
  out.animation = false;
  out.codec = codec_from_name(options.codec);
  out.screen = freeze_camera(options);
  return out;
}

NetModel instant_network() {
  NetModel model;
  model.server_ms = kTileMs;
  return model;
}

}  // namespace

void SeenError::add(const SeenError& other) {
  worst_px = std::max(worst_px, other.worst_px);
  views += other.views;
  beyond += other.beyond;
  bare += other.bare;
}

struct Sampler::Parts {
  Parts(Link& link, const FreezeOptions& options, std::function<bool()> wait)
      : modelled(link, clock, instant_network(), true, std::move(wait)),
        session(modelled, session_options(options), TileSink{}),
        camera(freeze_camera(options)),
        error_px(options.error_px) {}

  Result<void> step() {
    clock.advance_to_us(clock.now_us() + kFrameUs);
    return session.receive(clock.now_us());
  }
  SeenError error_of(const PlannedFrame& frame) const;

  VirtualClock clock;
  ModelledLink modelled;
  ClientSession session;
  Camera camera;
  const double error_px;
};

SeenError Sampler::Parts::error_of(const PlannedFrame& frame) const {
  const SceneView& scene = session.scene();
  // Things beside the picture are drawn where their spheres touch it, from whatever is there.
  const auto seen = [&](std::uint32_t instance) {
    const InstanceView& view = scene.instances[instance];
    return shown_area_px(frame.camera, view.center - frame.camera.pose.eye, view.radius) > 0;
  };
  SeenError out;
  out.views = 1;
  for (const DrawnImpostor& drawn : frame.list.impostors) {
    if (seen(drawn.instance)) out.worst_px = std::max(out.worst_px, drawn.bound_px);
  }
  for (const DrawnMesh& drawn : frame.list.meshes) {
    const ObjectDescription& object = scene.objects[scene.instances[drawn.instance].object];
    const double error = static_cast<double>(object.lods[drawn.lod].error);
    if (error > 0 && seen(drawn.instance)) {
      const double px = error * px_per_unit(scene, frame.camera, drawn.instance);
      out.worst_px = std::max(out.worst_px, px);
    }
  }
  out.beyond = out.worst_px > error_px ? 1 : 0;
  const std::vector<DrawnPlaceholder>& bare = frame.list.placeholders;
  out.bare = std::any_of(bare.begin(), bare.end(),
                         [&](const DrawnPlaceholder& one) { return seen(one.instance); });
  return out;
}

Sampler::Sampler(Link& link, const FreezeOptions& options, std::function<bool()> wait)
    : parts_(std::make_unique<Parts>(link, options, std::move(wait))) {}
Sampler::~Sampler() = default;

const SceneView& Sampler::scene() const { return parts_->session.scene(); }

Result<void> Sampler::open() {
  for (int i = 0; i < kOpeningFrames; ++i) {
    if (Result<void> received = parts_->step(); !received) return received;
    if (scene().complete() && scene().described()) return {};
  }
  return make_error(ErrorId::kNetworkClosed, "the scene was not described to its end");
}

Result<SeenError> Sampler::look(const Pose& pose) {
  Parts& p = *parts_;
  p.camera.pose = pose;
  p.camera.fit_depth_range(scene().bounds_center, scene().bounds_radius);
  p.clock.advance_to_us(p.clock.now_us() + kJumpUs);
  for (int i = 0; i < kMostFrames; ++i) {
    if (Result<void> received = p.step(); !received) return received.error();
    p.session.frame(p.camera, p.clock.now_us());
    if (p.session.at_rest()) break;
  }
  // A tile or geometry that has just come fades in.
  SeenError seen;
  for (int i = 0; i < kFadingFrames; ++i) {
    if (Result<void> received = p.step(); !received) return received.error();
    seen = p.error_of(p.session.frame(p.camera, p.clock.now_us()));
  }
  return seen;
}

}  // namespace mirage
