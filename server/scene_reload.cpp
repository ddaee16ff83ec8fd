#include "server/scene_reload.h"

#include <spdlog/spdlog.h>
#include <sys/stat.h>

#include <utility>

#include "server/served_scene.h"

namespace mirage {

SceneReload::SceneReload(std::string path, Load load)
    : path_(std::move(path)), load_(std::move(load)), served_(stamp()), told_(served_) {}

void SceneReload::end() {
  if (loading_.joinable()) loading_.join();
  if (retiring_.joinable()) retiring_.join();
  next_.reset();
}

std::optional<SceneReload::Stamp> SceneReload::stamp() const {
  struct stat file {};
  if (stat(path_.c_str(), &file) != 0 || !S_ISREG(file.st_mode)) return std::nullopt;
  constexpr std::int64_t kNsPerS = 1'000'000'000;
  return Stamp{file.st_ino, static_cast<std::uint64_t>(file.st_size),
               file.st_mtim.tv_sec * kNsPerS + file.st_mtim.tv_nsec};
}

void SceneReload::look() {
  const std::optional<Stamp> now = stamp();
  if (!now || now == told_) return;
  told_ = now;
  if (now != served_) {
    spdlog::warn("'{}' is another file than the one that is served: SIGHUP loads it", path_);
  }
}

void SceneReload::hangup() {
  const std::optional<Stamp> now = stamp();
  if (!now || now == served_) return;
  if (under_way_) {
    again_ = true;
    return;
  }
  under_way_ = true;
  served_ = told_ = now;
  if (loading_.joinable()) loading_.join();
  spdlog::info("loading '{}' anew, beside what is served", path_);
  loading_ = std::thread([this] {
    Result<std::unique_ptr<ServedScene>> next = load_();
    if (next) {
      next_ = next.take();
    } else {
      spdlog::error("{}; the scene stays as it is", next.error().line());
    }
    loaded_ = true;
  });
}

std::unique_ptr<ServedScene> SceneReload::take() {
  if (!loaded_.exchange(false)) return nullptr;
  under_way_ = false;
  std::unique_ptr<ServedScene> next = std::move(next_);
  if (std::exchange(again_, false)) hangup();
  return next;
}

void SceneReload::retire(std::unique_ptr<ServedScene> old) {
  if (retiring_.joinable()) retiring_.join();
  retiring_ = std::thread([gone = std::move(old)]() mutable { gone.reset(); });
}

}  // namespace mirage
