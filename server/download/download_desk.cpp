#include "server/download/download_desk.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>

#include "protocol/output/zip.h"
#include "protocol/process/child.h"

namespace mirage {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kPatienceUs = 15'000'000;  // until nobody wants it any longer
constexpr std::int64_t kLongestUs = 900'000'000;  // a download may take
constexpr std::size_t kMostWaiting = 8, kMostKept = 4;
constexpr std::size_t kMostKeptBytes = 256'000'000;  // but for the newest
constexpr std::size_t kLongestLine = 200;

using Stage = DownloadState::Stage;

std::string last_shown(const std::string& line) {
  std::string out = line.substr(0, kLongestLine);
  std::replace_if(
      out.begin(), out.end(), [](unsigned char c) { return c < 0x20 || c > 0x7e; }, '?');
  return out;
}

Result<std::string> zip_of(const std::string& folder) {
  std::vector<ZipEntry> entries;
  std::error_code failed;
  for (fs::recursive_directory_iterator at(folder, failed), end; !failed && at != end;
       at.increment(failed)) {
    if (!at->is_regular_file()) continue;
    const std::string text = read_whole_file(at->path().string());
    entries.push_back(
        {fs::relative(at->path(), folder).generic_string(), Bytes(text.begin(), text.end())});
  }
  if (failed) return make_error(ErrorId::kIo, "cannot read '" + folder + "'");
  std::sort(entries.begin(), entries.end(),
            [](const ZipEntry& a, const ZipEntry& b) { return a.name < b.name; });
  const Result<Bytes> zip = stored_zip(entries);
  if (!zip) return zip.error();
  return std::string(zip->begin(), zip->end());
}

}  // namespace

DownloadDesk::DownloadDesk(DownloadScene scene)
    : scene_(std::move(scene)), worker_([this] { work(); }) {}

DownloadDesk::~DownloadDesk() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  woken_.notify_all();
  worker_.join();
}

bool DownloadDesk::makes(const DownloadRequest& request) const {
  return sibling_program(download_program(request)).has_value();
}

DownloadState DownloadDesk::ask(const DownloadRequest& request) {
  std::string key;
  for (const std::string& word : download_arguments(request, scene_, "")) key += word + '\n';
  const std::lock_guard lock(mutex_);
  tidy();
  std::size_t ahead = 0;
  for (const auto& job : jobs_) {
    if (job->key == key) {
      job->asked_us = clock_.now_us();
      job->state.ahead = ahead;
      DownloadState out = job->state;
      // Whoever asks again after an error wants another try.
      if (out.stage == Stage::kFailed) job->dropped = true;
      return out;
    }
    ahead += job->state.stage == Stage::kWaiting || job->state.stage == Stage::kMaking;
  }
  if (ahead >= kMostWaiting) return {};
  const auto job = std::make_shared<Job>();
  job->request = request;
  job->key = key;
  job->state.stage = Stage::kWaiting;
  job->state.ahead = ahead;
  job->asked_us = clock_.now_us();
  jobs_.push_back(job);
  woken_.notify_all();
  return job->state;
}

void DownloadDesk::forget() {
  const std::lock_guard lock(mutex_);
  for (const auto& job : jobs_) job->dropped = true;
  tidy();
}

void DownloadDesk::tidy() {
  const std::int64_t now_us = clock_.now_us();
  std::size_t kept = 0, bytes = 0;
  for (auto at = jobs_.rbegin(); at != jobs_.rend(); ++at) {
    Job& job = **at;
    if (job.state.stage == Stage::kDone || job.state.stage == Stage::kFailed) {
      bytes += job.state.file ? job.state.file->size() : 0;
      ++kept;
      if (kept > kMostKept || (kept > 1 && bytes > kMostKeptBytes)) job.dropped = true;
    } else if (now_us - job.asked_us > kPatienceUs) {
      job.dropped = true;
    }
  }
  std::erase_if(jobs_, [](const auto& job) { return job->dropped; });
}

void DownloadDesk::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    std::shared_ptr<Job> next;
    woken_.wait(lock, [&] {
      tidy();
      const auto waits = std::find_if(jobs_.begin(), jobs_.end(), [](const auto& job) {
        return job->state.stage == Stage::kWaiting;
      });
      if (waits != jobs_.end()) next = *waits;
      return ending_ || next;
    });
    if (ending_) return;
    next->state.stage = Stage::kMaking;
    lock.unlock();
    make(*next);
    lock.lock();
  }
}

void DownloadDesk::make(Job& job) {
  const std::int64_t began_us = clock_.now_us();
  const std::string program = download_program(job.request);
  const auto made = [&]() -> Result<std::string> {
    const std::optional<std::string> path = sibling_program(program);
    if (!path) {
      return make_error(ErrorId::kUsage, "there is no " + program + " beside this server",
                        "install mirage-tools");
    }
    const Result<ScratchFolder> folder = ScratchFolder::make();
    if (!folder) return folder.error();
    const std::string out = folder->path() + "/files";
    std::vector<std::string> command = download_arguments(job.request, scene_, out);
    command.insert(command.begin(), *path);
    ChildWatch watch;
    watch.kind = ChildKind::kForOthers;
    watch.on_err = [&](const std::string& line) {
      const std::lock_guard lock(mutex_);
      job.state.line = last_shown(line);
    };
    watch.wanted = [&] {
      const std::lock_guard lock(mutex_);
      tidy();
      return !ending_ && !job.dropped && clock_.now_us() - began_us < kLongestUs;
    };
    const Result<ChildResult> ran = run_child(command, watch);
    if (!ran) return ran.error();
    if (ran->exit_code != 0) {
      return error_said(ran->err).value_or(make_error(
          ErrorId::kInternal, program + " ended with code " + std::to_string(ran->exit_code)));
    }
    return zip_of(out);
  }();
  const double seconds = static_cast<double>(clock_.now_us() - began_us) * 1e-6;
  const std::string name = download_name(job.request, scene_);
  if (made) {
    spdlog::info("download '{}': {} bytes, {:.1f} s", name, made->size(), seconds);
  } else {
    spdlog::warn("download '{}': {}, after {:.1f} s", name, made.error().line(), seconds);
  }
  const std::lock_guard lock(mutex_);
  job.state.stage = made ? Stage::kDone : Stage::kFailed;
  if (made) job.state.file = std::make_shared<const std::string>(*made);
  if (!made) job.state.error = made.error();
}

}  // namespace mirage
