#include "client/view/choice_log.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <string>
#include <vector>

namespace mirage {
namespace {

std::string listed(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : ", ") + name;
  return out;
}

// Returns the name after `name`; the first after the last, and after one that is not listed.
std::string next_of(const std::vector<std::string>& names, const std::string& name) {
  if (names.empty()) return name;
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() || found + 1 == names.end() ? names.front() : *(found + 1);
}

void tell(const char* kind, const std::vector<std::string>& names, const std::string& shown,
          const std::string& asked) {
  if (!asked.empty() && asked != shown) spdlog::warn("the scene has no {} '{}'", kind, asked);
  if (names.empty()) return;
  spdlog::info("{}s: {}; shown: {}", kind, listed(names), shown.empty() ? "as the file is" : shown);
}

}  // namespace

bool ChoiceLog::ask_next(const SceneChoices& offered, bool clip, bool variant) {
  SceneChoice next = offered.shown;
  if (clip) next.clip = next_of(offered.clips, next.clip);
  if (variant) next.variant = next_of(offered.variants, next.variant);
  if (next == offered.shown) return false;
  asked_ = next;
  return true;
}

void ChoiceLog::note(const SceneChoices& offered) {
  if (told_ == offered.shown) return;
  told_ = offered.shown;
  tell("clip", offered.clips, told_->clip, asked_.clip);
  tell("variant", offered.variants, told_->variant, asked_.variant);
}

}  // namespace mirage
