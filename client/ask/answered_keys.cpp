#include "client/ask/answered_keys.h"

#include <algorithm>

namespace mirage {

AnsweredKeys::Key AnsweredKeys::key_of(const TileNeed& need) {
  return {need.instance, need.light,  need.channels,       need.size_class,    need.cell.level,
          need.cell.x,   need.cell.y, need.distance.level, need.distance.index};
}

void AnsweredKeys::note(const TileNeed& need, std::int64_t now_us) {
  if (need.phase == kStaticPhase) answers_[key_of(need)] = {now_us, false};
}

void AnsweredKeys::remove_from(std::vector<TileNeed>& needs, bool stands, std::int64_t now_us) {
  for (auto it = answers_.begin(); it != answers_.end();) {
    Answer& answer = it->second;
    answer.moved = answer.moved || !stands;
    const bool forgotten = answer.moved && now_us - answer.came_us > kForgetUs;
    it = forgotten ? answers_.erase(it) : std::next(it);
  }
  const auto answered = [&](const TileNeed& need) {
    return need.phase == kStaticPhase && answers_.count(key_of(need)) != 0;
  };
  needs.erase(std::remove_if(needs.begin(), needs.end(), answered), needs.end());
}

}  // namespace mirage
