#include "client/hold/upload_queue.h"

#include <algorithm>
#include <iterator>

#include "protocol/impostor/tile.h"
#include "protocol/impostor/tile_key.h"

namespace mirage {

std::size_t tile_upload_bytes(std::size_t w, std::size_t h, std::uint8_t channels) {
  const std::size_t texels = w * h == 0 ? 0 : (w + 2) * (h + 2);
  if (!is_picture(channels)) return texels;
  return texels * (channels == kRelitTile ? 9 : channels == kLayeredTile ? 15 : 5);
}

std::vector<Message> UploadQueue::take(std::vector<Message> arrived, std::int64_t now_us,
                                       const Cost& cost, const First& first) {
  frame_bytes_ = 0;
  for (Message& message : waiting_) message.waited_us += now_us - taken_us_;
  taken_us_ = now_us;
  std::vector<Message> all = std::move(waiting_);
  waiting_.clear();
  std::move(arrived.begin(), arrived.end(), std::back_inserter(all));
  std::size_t in_all = 0;
  for (const Message& message : all) in_all += cost(message);
  if (in_all <= budget_bytes_) return all;

  ++counts_.frames_over_budget;
  const auto free =
      std::stable_partition(all.begin(), all.end(), [&](const Message& m) { return cost(m) == 0; });
  std::stable_partition(free, all.end(), first);
  // A message that was overtaken keeps the arrival time of the one that overtook it. Arrival times
  // are used for timing, so they never run backwards.
  std::int64_t waited_us = INT64_MAX;
  for (auto m = free; m != all.end(); ++m)
    waited_us = m->waited_us = std::min(waited_us, m->waited_us);
  std::size_t bytes = 0;
  const auto over = std::find_if(free, all.end(), [&](const Message& message) {
    const bool alone = bytes == 0;
    bytes += cost(message);
    return !alone && bytes > budget_bytes_;
  });
  const auto most = static_cast<std::ptrdiff_t>(kMostWaiting);
  const auto kept = all.end() - over > most ? all.end() - most : over;
  waiting_.assign(std::make_move_iterator(kept), std::make_move_iterator(all.end()));
  all.erase(kept, all.end());
  return all;
}

void UploadQueue::uploaded(std::size_t bytes, bool tile) {
  counts_.tiles += tile ? 1 : 0;
  counts_.bytes += bytes;
  frame_bytes_ += bytes;
  counts_.largest_frame_bytes = std::max(counts_.largest_frame_bytes, frame_bytes_);
}

}  // namespace mirage
