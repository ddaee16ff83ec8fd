// Sessions: pictures by HTTP, from the request to the file.
#include "server/prepare/prepared_scene.h"
#include "server/session/session.h"

namespace mirage {
namespace {

// Returns by how many px the geometry of a picture may be simplified: by the width of a sample,
// which the picture cannot tell. A picture with as many samples as a comparison is exact.
double level_px(std::uint32_t samples) {
  return samples < limits::kMaxReferenceSupersample ? 1.0 / samples : 0.0;
}

}  // namespace

std::uint32_t SessionHub::get(PictureRequest wanted) {
  const std::uint32_t request = next_get_++;
  const auto answer = [&](std::shared_ptr<const Bytes> file, wire::RefusalReason reason) {
    got_pictures_.push_back({request, std::move(file), reason});
    return request;
  };
  if (!options_.pictures) return answer(nullptr, wire::RefusalReason::NoReference);
  if (draining_) return answer(nullptr, wire::RefusalReason::Busy);
  PictureAsk ask;
  ask.key = wanted.key();
  ask.format = wanted.format;
  ask.most_bytes = wanted.most_bytes;
  ask.idle = wanted.idle;
  if (auto made = pictures_.find(ask.key)) {
    ++counters_.pictures_sent;
    return answer(std::move(made), wire::RefusalReason::None);
  }
  Camera& camera = wanted.camera;
  if (!wanted.posed) camera.pose = home_pose(scene_->scene.home, camera);
  camera.fit_depth_range(scene_->bounds_center, scene_->bounds_radius);
  ask.shot.camera = camera;
  ask.shot.supersample = wanted.samples;
  ask.shot.level_px = level_px(wanted.samples);
  ask.shot.lighting = scene_->scene.lighting;
  if (wanted.sun) put_sun(*wanted.sun, ask.shot.lighting);
  if (!pictures_.wait(std::move(ask), request)) answer(nullptr, wire::RefusalReason::Busy);
  return request;
}

std::vector<GotPicture> SessionHub::take_pictures() { return std::exchange(got_pictures_, {}); }

void SessionHub::finish(FinishedPicture done) {
  const auto reason = done.file ? wire::RefusalReason::None : wire::RefusalReason::TooLarge;
  for (const std::uint32_t request : pictures_.finish(done.key, done.file)) {
    if (done.file) ++counters_.pictures_sent;
    got_pictures_.push_back({request, done.file, reason});
  }
}

}  // namespace mirage
