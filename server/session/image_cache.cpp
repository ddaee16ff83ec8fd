#include "server/session/image_cache.h"

#include <algorithm>

namespace mirage {
namespace {
constexpr std::size_t kMaxBytes = 256u * 1024 * 1024;
}  // namespace

const Bytes* ImageCache::find(const ImageLevel& level) const {
  const auto at = encoded_.find(level);
  return at == encoded_.end() ? nullptr : &at->second;
}

bool ImageCache::wait(const ImageLevel& level, Waiting waiting) {
  std::vector<Waiting>& all = waiting_[level];
  const bool again = std::any_of(all.begin(), all.end(),
                                 [&](const Waiting& w) { return w.first == waiting.first; });
  if (again) return false;
  ImageLevel job = level;
  if (all.empty() && !jobs_.try_push(job)) {
    waiting_.erase(level);
    return false;
  }
  all.push_back(waiting);
  return true;
}

std::vector<ImageCache::Waiting> ImageCache::take_waiting(const ImageLevel& level) {
  auto node = waiting_.extract(level);
  return node.empty() ? std::vector<Waiting>{} : std::move(node.mapped());
}

void ImageCache::keep(const ImageLevel& level, Bytes bytes) {
  bytes_ += bytes.size();
  encoded_[level] = std::move(bytes);
  order_.push_back(level);
  while (bytes_ > kMaxBytes) {
    const auto oldest = encoded_.find(order_.front());
    bytes_ -= oldest->second.size();
    encoded_.erase(oldest);
    order_.pop_front();
  }
}

}  // namespace mirage
