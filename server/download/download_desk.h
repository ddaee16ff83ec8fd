#pragma once
// Download desk: has downloads made, one after the other, by other programs at the lowest priority.
// Input:  requests, each asked again until its file is there.
// Output: files, and what is being done.
// Thread: any; a thread of its own waits for the programs.
// Full:   a few requests wait in line, more are told so; a request that nobody asks for any longer
//         is dropped, and its program ended.

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "protocol/base/clock.h"
#include "protocol/base/result.h"
#include "server/download/download_request.h"

namespace mirage {

/// The state of a request.
struct DownloadState {
  enum class Stage { kWaiting, kMaking, kDone, kFailed, kFull };
  Stage stage = Stage::kFull;
  std::size_t ahead = 0;                         ///< requests before it, while it waits
  std::string line;                              ///< last line of the program, while it is made
  std::shared_ptr<const std::string> file;       ///< a zip archive, once it is done
  Error error = make_error(ErrorId::kBusy, "");  ///< if it failed
};

class DownloadDesk {
 public:
  explicit DownloadDesk(DownloadScene scene);
  ~DownloadDesk();
  DownloadDesk(const DownloadDesk&) = delete;
  DownloadDesk& operator=(const DownloadDesk&) = delete;

  /// True if the program for such a request is beside this one.
  bool makes(const DownloadRequest& request) const;
  /// Begins a download, or tells how far it is. Equal requests share one.
  DownloadState ask(const DownloadRequest& request);
  /// Forgets what was made of a scene that has changed.
  void forget();
  const DownloadScene& scene() const { return scene_; }

 private:
  struct Job {
    DownloadRequest request;
    std::string key;
    DownloadState state;
    std::int64_t asked_us = 0;  ///< when somebody asked last
    bool dropped = false;
  };
  void work();
  void make(Job& job);
  /// Drops what nobody asks for, and the oldest files beyond those that are kept.
  void tidy();

  const DownloadScene scene_;
  const SteadyClock clock_;
  std::mutex mutex_;
  std::condition_variable woken_;
  std::deque<std::shared_ptr<Job>> jobs_;  // in the order they came
  bool ending_ = false;
  std::thread worker_;
};

}  // namespace mirage
