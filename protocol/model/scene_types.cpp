#include "protocol/model/scene_types.h"

#include <algorithm>

namespace mirage {
namespace {

/// Replaces a name that is empty or not offered by the shown one.
void settle(std::string& wanted, const std::vector<std::string>& offered,
            const std::string& shown) {
  if (std::find(offered.begin(), offered.end(), wanted) == offered.end()) wanted = shown;
}

}  // namespace

std::optional<SceneChoice> other_choice(const SceneChoices& offered, SceneChoice wanted) {
  settle(wanted.clip, offered.clips, offered.shown.clip);
  settle(wanted.variant, offered.variants, offered.shown.variant);
  if (wanted == offered.shown) return std::nullopt;
  return wanted;
}

}  // namespace mirage
