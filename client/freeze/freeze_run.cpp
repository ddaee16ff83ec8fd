#include "client/freeze/freeze_run.h"

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "client/folder/frozen_file.h"
#include "client/freeze/finish.h"
#include "client/freeze/recording_link.h"
#include "client/freeze/sampler.h"
#include "client/host/server_process.h"
#include "client/native/native_link.h"
#include "client/scene/scene_view.h"
#include "protocol/base/clock.h"

namespace mirage {
namespace {

constexpr int kConnectMs = 20'000;
constexpr int kReplyMs = 120'000;     // of a large scene's slowest tile
constexpr std::size_t kDryShare = 8;  // of the eyes, in a dry run
constexpr const char* kSettingsName = ".freeze/settings";

std::vector<std::string> server_options(const FreezeOptions& o) {
  std::vector<std::string> out;
  if (!o.geometry) out.push_back("--no-geometry");
  if (!o.environment.empty()) out.insert(out.end(), {"--environment", o.environment});
  if (!o.look.empty()) out.insert(out.end(), {"--look", o.look});
  if (o.home) out.insert(out.end(), {"--home", to_text(*o.home)});
  return out;
}

bool right(const OutputFolder& store, const std::string& name, const FrozenEntry& entry) {
  const std::optional<Bytes> file = store.read(name);
  return file && file->size() == entry.bytes() && frozen_hash(*file) == entry.hash();
}

}  // namespace

std::string part_name(std::size_t index) { return fmt::format(".freeze/part-{:05}", index); }

FreezeRun::FreezeRun(const FreezeOptions& options) : o_(options) {}
FreezeRun::~FreezeRun() = default;

Result<void> FreezeRun::run() {
  if (!o_.dry_run) {
    Result<OutputFolder> store = OutputFolder::open(o_.out, ".freeze", o_.shard);
    if (!store) return store.error();
    store_.emplace(store.take());
  }
  Result<std::unique_ptr<ServerProcess>> server =
      ServerProcess::start(o_.scene, o_.device, server_options(o_));
  if (!server) return server.error();
  server_ = server.take();
  if (Result<void> learnt = learn_scene(); !learnt) return learnt;
  if (o_.dry_run) return estimate();
  if (Result<void> checked = check_settings(); !checked) return checked;
  if (is_finished(*store_, o_, revision_)) {
    store_->clear_work();
    fmt::print("frozen {}: nothing to do, every file is there and right\n", o_.out);
    return {};
  }
  if (Result<void> parts = make_parts(); !parts) return parts;
  std::size_t missing = 0;
  for (std::size_t i = 0; i < tasks_.size(); ++i) missing += !store_->has(part_name(i));
  if (missing > 0) {
    fmt::print("frozen {}: shard {}/{} is done; {} parts of others are not\n", o_.out,
               o_.shard.index, o_.shard.count, missing);
    return {};
  }
  if (Result<void> alone = store_->wait_for_others(); !alone) return alone;
  if (is_finished(*store_, o_, revision_)) return {};  // another shard was last
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    const std::optional<FrozenPart> part = made(i);
    if (!part) {
      return make_error(ErrorId::kIo, fmt::format("part {} of '{}' is damaged", i, o_.out),
                        "run the same command again: it makes the part again");
    }
    all_.add(*part);
  }
  fmt::print(stderr, "measuring the error of the folder\n");
  return finish(*store_, o_, {*server_, revision_, tasks_.size()}, all_, [this] {
    std::vector<EyePart> eyes;
    for (const Task& task : tasks_) eyes.push_back(task.eyes);
    return eyes;
  }());
}

Result<void> FreezeRun::learn_scene() {
  const Result<ServerUrl> url = parse_url(server_->url());
  if (!url) return url.error();
  NativeLink link(*url);
  if (!link.wait_connected(kConnectMs)) {
    return make_error(ErrorId::kNetworkConnect, "the server does not answer");
  }
  Sampler sampler(link, o_, [&link] {
    link.wait_message(kReplyMs);
    return link.connected();
  });
  if (Result<void> opened = sampler.open(); !opened) return opened;
  revision_ = sampler.scene().revision;
  const glm::dvec3 home = sampler.scene().home.eye;
  if (o_.box && !o_.box->holds(home)) {
    fmt::print(stderr,
               "warning: the page begins at {:g},{:g},{:g}, outside of --box, where its error is "
               "not bounded: --home moves it\n",
               home.x, home.y, home.z);
  }
  const std::vector<EyePart> parts = eye_parts(o_, sampler.scene().home);
  const bool meshes = o_.geometry && sampler.scene().geometry;
  for (const EyePart& part : parts) {
    if (meshes) tasks_.push_back({part, true});
  }
  // Tiles are for devices that draw few triangles; beside geometry they show whole objects from the
  // home view's distance.
  const std::size_t rings = meshes && !o_.box ? parts.size() / 2 : parts.size();
  for (std::size_t i = 0; i < rings; ++i) tasks_.push_back({parts[i], false});
  return {};
}

// A folder has the files of one freeze. Those of another would be taken for its own.
Result<void> FreezeRun::check_settings() {
  const std::string text = fmt::format("{:016x} {}\n", revision_, o_.settings());
  const std::optional<std::string> before = settings_of(*store_);
  const std::optional<Bytes> begun = store_->read(kSettingsName);
  const std::string known = begun ? std::string(begun->begin(), begun->end()) : before.value_or("");
  if (!known.empty() && known != text) {
    return make_error(ErrorId::kUsage, "'" + o_.out + "' has another freeze: " + known,
                      "choose another folder, remove this one, or use its scene and options");
  }
  return store_->write(kSettingsName, Bytes(text.begin(), text.end()));
}

std::optional<FrozenPart> FreezeRun::made(std::size_t index) const {
  const std::optional<Bytes> file = store_->read(part_name(index));
  if (!file) return std::nullopt;
  Result<FrozenPart> part = decode_part(*file);
  if (!part) return std::nullopt;
  const auto wrong = [this](const auto& f) { return !right(*store_, f.first, f.second); };
  if (std::any_of(part->files.begin(), part->files.end(), wrong)) return std::nullopt;
  return part.take();
}

Result<void> FreezeRun::make_parts() {
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    tell(i, tasks_.size());
    if (!o_.shard.has(i) || made(i)) continue;
    Result<FrozenPart> part = make(tasks_[i], true);
    if (!part) return part.error();
    if (Result<void> kept = store_->write(part_name(i), encode_part(*part)); !kept) return kept;
  }
  tell(tasks_.size(), tasks_.size());
  return {};
}

// Sees a part with a session of its own.
Result<FrozenPart> FreezeRun::make(const Task& task, bool write) {
  const Result<ServerUrl> url = parse_url(server_->url());
  if (!url) return url.error();
  NativeLink link(*url, nullptr, true);
  if (!link.wait_connected(kConnectMs)) {
    return make_error(ErrorId::kNetworkConnect, "the server does not answer");
  }
  RecordingLink recorded(link,
                         task.geometry ? Record::kAll
                         : o_.geometry ? Record::kWholeTiles
                                       : Record::kTiles,
                         [&](const std::string& name, const Bytes& file) {
                           return write ? store_->write(name, file) : Result<void>();
                         });
  Sampler sampler(recorded, o_, [&link] {
    link.wait_message(kReplyMs);
    return link.connected();
  });
  if (Result<void> opened = sampler.open(); !opened) return opened.error();
  for (const Pose& pose : task.eyes) {
    const Result<SeenError> seen = sampler.look(pose);
    if (!seen) return seen.error();
    if (!recorded.kept()) return recorded.kept().error();
    if (!link.connected()) {
      return make_error(ErrorId::kNetworkClosed, "the server ended: " + link.last_problem());
    }
  }
  FrozenPart part = recorded.part();
  part.eyes = task.eyes.size();
  return part;
}

Result<void> FreezeRun::estimate() {
  const SteadyClock clock;
  FrozenPart some;
  std::size_t eyes = 0;
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    eyes += tasks_[i].eyes.size();
    if (i % kDryShare != 0) continue;
    Result<FrozenPart> part = make(tasks_[i], false);
    if (!part) return part.error();
    some.add(*part);
  }
  const double share = static_cast<double>(some.eyes) / static_cast<double>(eyes);
  double tiles = 0, tile_mb = 0, assets = 0, asset_mb = 0;
  for (const auto& [name, entry] : some.files) {
    (entry.is_tile ? tiles : assets) += 1;
    (entry.is_tile ? tile_mb : asset_mb) += 1e-6 * entry.bytes();
  }
  fmt::print(
      "about {} eyes, {:.0f} tiles of {:.1f} MB, {:.0f} meshes and images of {:.1f} MB, {:.0f} s; "
      "--mb keeps the folder below {} MB\n",
      eyes, tiles / share, tile_mb / share, assets, asset_mb,
      1e-6 * static_cast<double>(clock.now_us()) / share, o_.mb);
  return {};
}

void FreezeRun::tell(std::size_t done, std::size_t all) const {
  const bool person = isatty(STDERR_FILENO) != 0;
  if (person) fmt::print(stderr, "\r{} of {} parts{}", done, all, done == all ? "\n" : "");
  if (!person) fmt::print(stderr, "{} of {} parts\n", done, all);
  std::fflush(stderr);
}

}  // namespace mirage
