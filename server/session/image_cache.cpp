#include "server/session/image_cache.h"

namespace mirage {

const Bytes* ImageCache::find(const ImageLevel& level) const {
  const auto at = encoded_.find(level);
  return at == encoded_.end() ? nullptr : &at->second;
}

bool ImageCache::wait(const ImageLevel& level, Waiting waiting) {
  const bool again =
      waiting_.any(level, [&](const Waiting& other) { return other.first == waiting.first; });
  if (again) return false;
  ImageLevel job = level;
  if (!waiting_.under_way(level) && !jobs_.try_push(job)) return false;
  waiting_.add(level, waiting);
  return true;
}

void ImageCache::remove_session(SessionId session) {
  // A level under way is still encoded and kept for later asks.
  waiting_.remove([&](const Waiting& waiting) { return waiting.first == session; },
                  [](const ImageLevel&) { return false; });
}

std::size_t ImageCache::asks_of(SessionId session) const {
  return waiting_.count([&](const Waiting& waiting) { return waiting.first == session; });
}

void ImageCache::keep(const ImageLevel& level, Bytes bytes) {
  budget_.add(level, bytes.size());
  encoded_[level] = std::move(bytes);
  while (const std::optional<ImageLevel> oldest = budget_.take_excess()) encoded_.erase(*oldest);
}

}  // namespace mirage
