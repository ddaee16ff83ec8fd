#include "server/chosen_scenes.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "server/net/endpoint.h"
#include "server/served_scene.h"
#include "server/session/hub_state.h"
#include "server/session/session.h"

namespace mirage {
namespace {

// Time for which a scene without viewers is kept. Who looks through the clips of a scene comes
// back.
constexpr std::int64_t kUnusedUs = 60'000'000;

std::string name_of(const SceneChoice& choice) {
  std::string out;
  if (!choice.clip.empty()) out += "clip '" + choice.clip + "'";
  if (!choice.variant.empty())
    out += (out.empty() ? "" : " and ") + ("variant '" + choice.variant) + "'";
  return out;
}

}  // namespace

void ChosenScenes::end() {
  if (loading_.joinable()) loading_.join();
  load_.reset();
  scenes_.clear();
}

bool ChosenScenes::has_viewers(const Chosen& one) const {
  const HubState state = one.scene->hub().state();
  return state.clients + state.strangers > 0;
}

Result<SessionHub*> ChosenScenes::find(const SceneChoice& choice) {
  for (Chosen& one : scenes_) {
    if (one.choice == choice) return &one.scene->hub();
  }
  const bool loading = load_ && !load_->dropped && load_->choice == choice;
  if (loading || std::find(wanted_.begin(), wanted_.end(), choice) != wanted_.end()) return nullptr;
  const auto used = std::count_if(scenes_.begin(), scenes_.end(),
                                  [this](const Chosen& one) { return has_viewers(one); });
  if (static_cast<std::size_t>(used) + wanted_.size() + (load_ ? 1 : 0) >= most_) {
    return make_error(ErrorId::kBusy,
                      "as many clips and variants as this server shows at a time "
                      "(" +
                          std::to_string(most_) + ") have viewers");
  }
  wanted_.push_back(choice);
  return nullptr;
}

void ChosenScenes::look(Endpoint& endpoint, const Access& access) {
  take_loaded(endpoint, access);
  end_unused(endpoint);
  load_next();
}

void ChosenScenes::take_loaded(Endpoint& endpoint, const Access& access) {
  if (!loaded_.exchange(false)) return;
  loading_.join();
  Load load = std::move(*load_);
  load_.reset();
  Result<ScenePtr>& done = *load.done;
  if (load.dropped) {
    if (done) hooks_.retire(done.take());
    return;
  }
  if (!done) {
    spdlog::error("{}: {}", name_of(load.choice), done.error().line());
    return endpoint.give_up(load.choice, done.error());
  }
  Chosen& one = scenes_.emplace_back(Chosen{load.choice, done.take(), clock_.now_us()});
  one.scene->hub().set_access(access);
  one.scene->hub().make_home_view();
  spdlog::info("shows {} too, as revision {:016x}", name_of(one.choice),
               one.scene->hub().revision());
  endpoint.add(one.choice, one.scene->hub(), one.scene->queues());
}

// Ends scenes that nobody looks at: those that are old, or whose room another one needs.
void ChosenScenes::end_unused(Endpoint& endpoint) {
  const std::int64_t now_us = clock_.now_us();
  for (std::size_t i = 0; i < scenes_.size();) {
    Chosen& one = scenes_[i];
    if (has_viewers(one)) one.used_us = now_us;
    const bool needed = !wanted_.empty() && scenes_.size() >= most_;
    if (has_viewers(one) || (!needed && now_us - one.used_us < kUnusedUs)) {
      ++i;
      continue;
    }
    spdlog::info("{}: nobody looks at it any more", name_of(one.choice));
    endpoint.remove(one.scene->hub());
    hooks_.retire(std::move(one.scene));
    scenes_.erase(scenes_.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

void ChosenScenes::load_next() {
  if (load_ || wanted_.empty() || scenes_.size() >= most_) return;
  load_ = std::make_unique<Load>();
  load_->choice = wanted_.front();
  wanted_.pop_front();
  spdlog::info("loading {}, beside what is served", name_of(load_->choice));
  loading_ = std::thread([this] {
    load_->done = hooks_.load(load_->choice);
    loaded_ = true;
  });
}

void ChosenScenes::set_access(const Access& access) {
  for (Chosen& one : scenes_) one.scene->hub().set_access(access);
}

void ChosenScenes::clear() {
  for (Chosen& one : scenes_) hooks_.retire(std::move(one.scene));
  scenes_.clear();
  wanted_.clear();
  if (load_) load_->dropped = true;
}

}  // namespace mirage
