// Sessions: views, from the request to the reply.
#include <algorithm>

#include "protocol/impostor/tile_key.h"
#include "protocol/wire/view_codec.h"
#include "server/prepare/prepared_scene.h"
#include "server/session/session.h"

namespace mirage {
namespace {
// A view is shown at about its size, for a second, so moderate quality is enough.
constexpr std::uint32_t kViewSupersample = 2;
constexpr double kViewLevelPx = 1;

// True if the home view is drawn from whole meshes, at once, rather than from levels of detail
// once they are made. Making them takes at least as long as drawing the same triangles 16 times.
bool drawn_whole(const Scene& scene) {
  constexpr std::uint64_t kFew = 4'000'000, kTimes = 16;
  return scene.triangles() <= std::max(kFew, kTimes * scene.own_triangles());
}

}  // namespace

ViewJob SessionHub::view_job(const wire::ViewRequestT& m, const Lighting& lighting) const {
  ViewPose pose = view_pose(m);
  if (m.home) {
    pose.camera.pose = home_pose(scene_->scene.home, screen_of(pose.camera));
  }
  if (!scene_->animated()) pose.time_s = 0;
  pose.camera.fit_depth_range(scene_->bounds_center, scene_->bounds_radius);
  ViewJob job;
  job.id = view_id(revision_, lighting_hash(lighting), pose);
  job.shot = {pose.camera, kViewSupersample, lighting, pose.time_s, kViewLevelPx};
  job.home = m.home;
  job.shot.whole = m.home && drawn_whole(scene_->scene);
  return job;
}

void SessionHub::make_home_view() {
  if (!options_.view) return;
  views_.keep_ready(view_job(home_view_request(), scene_->scene.lighting));
}

void SessionHub::view(SessionId id, Session& s, const wire::ViewRequestT& m) {
  const auto found = s.lighting.find(m.lighting_id);
  const bool known = m.lighting_id == 0 || found != s.lighting.end();
  if (!options_.view || !known) {
    return refuse(id, m.request_id,
                  known ? wire::RefusalReason::NoView : wire::RefusalReason::BadKey);
  }
  ViewJob job = view_job(m, found != s.lighting.end() ? found->second : scene_->scene.lighting);
  ViewCache::Waiting waiting{id, m.request_id, clock_.now_us()};
  if (const auto made = views_.find(job.id)) {
    waiting.kept = true;
    return push_view(waiting, *made);
  }
  if (!views_.wait(std::move(job), waiting)) {
    refuse(id, m.request_id, wire::RefusalReason::Busy);
  }
}

void SessionHub::push_view(const ViewCache::Waiting& waiting, const EncodedView& view) {
  const auto at = sessions_.find(waiting.session);
  if (at == sessions_.end()) return;
  wire::ViewReplyT reply = view.reply;
  reply.request_id = waiting.request_id;
  reply.kept = waiting.kept;
  reply.server_us = static_cast<std::uint32_t>(clock_.now_us() - waiting.asked_us);
  ++counters_.views_sent;
  // The control lane puts the view before the scene's description: it is the first picture.
  push(waiting.session, Outbox::Lane::kControl, encode_message(std::move(reply), view.payload));
}

void SessionHub::finish(FinishedView done) {
  for (const ViewCache::Waiting& w : views_.finish(done.id, done.view)) {
    const auto at = sessions_.find(w.session);
    if (at == sessions_.end()) continue;
    if (done.view) {
      push_view(w, *done.view);
    } else {
      refuse(w.session, w.request_id, wire::RefusalReason::TooLarge);
    }
  }
}

}  // namespace mirage
