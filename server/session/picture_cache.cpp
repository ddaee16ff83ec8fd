#include "server/session/picture_cache.h"

#include <utility>

namespace mirage {

std::shared_ptr<const Bytes> PictureCache::find(const std::string& key) const {
  const auto at = made_.find(key);
  return at == made_.end() ? nullptr : at->second;
}

bool PictureCache::wait(PictureAsk ask, std::uint32_t request) {
  if (making_.under_way(ask.key)) {
    making_.add(ask.key, request);
    return true;
  }
  if (making_.under_way() >= kMostPicturesWaiting) return false;
  const SessionId job = next_job_++;
  making_.add(ask.key, request);
  jobs_[ask.key] = job;
  ReferenceJob render{job, 0, std::move(ask.shot)};
  render.picture = PictureName{std::move(ask.key), ask.format, render.shot.camera, ask.most_bytes};
  render.idle = ask.idle;
  queue_.submit(std::move(render));
  return true;
}

std::vector<std::uint32_t> PictureCache::finish(const std::string& key,
                                                std::shared_ptr<const Bytes> file) {
  if (file && made_.count(key) == 0) {
    budget_.add(key, file->size());
    made_[key] = std::move(file);
    while (const std::optional<std::string> oldest = budget_.take_excess()) made_.erase(*oldest);
  }
  jobs_.erase(key);
  return making_.take(key);
}

void PictureCache::cancel(std::uint32_t request) {
  making_.remove([&](std::uint32_t waiting) { return waiting == request; },
                 [&](const std::string& key) {
                   const auto job = jobs_.extract(key);
                   if (!job.empty()) queue_.remove_session(job.mapped());
                   return true;
                 });
}

}  // namespace mirage
