#pragma once
// A directory of files that can be made again: finished tiles, and what was derived from meshes
// and images when a scene was loaded.
//
// A file is written aside and renamed, so that a reader never sees half of one, and ends with a
// hash of its name and its bytes: what is damaged is as good as not there. Several servers may
// share a directory. Beyond the budget the files that were used longest ago go; a thread of its
// own looks after that, so nobody who reads or writes waits for it. Of servers that share it the
// one that has locked the folder does so for all; the others let go of what they wrote themselves
// only, or the smallest budget would be everybody's.

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>

#include "protocol/base/bytes.h"

namespace mirage {

/// What a file is made from, as a hash, and what kind of thing it is: "tile" for AB….tile.
struct CacheKey {
  std::uint64_t high = 0, low = 0;
  const char* kind = "";
};

class CacheDirectory {
 public:
  enum class Use : std::uint8_t { kReadAndWrite, kReadOnly };
  /// `path` is made when something is first written. Any thread may use it.
  CacheDirectory(std::string path, std::uint64_t budget_bytes, Use use = Use::kReadAndWrite);
  ~CacheDirectory();
  CacheDirectory(const CacheDirectory&) = delete;
  CacheDirectory& operator=(const CacheDirectory&) = delete;

  /// Nothing when it is not there, or damaged: then it goes, with a warning.
  std::optional<Bytes> read(const CacheKey& key) const;
  /// False: it is not kept. A directory that cannot be written, or is full, is no error: it is said
  /// once, and once more when it can be again.
  bool write(const CacheKey& key, Bytes bytes);

  /// Waits until the directory has been looked through and is within its budget.
  void settle();
  /// Of all files, as of the last look and what was written since.
  std::uint64_t bytes() const { return bytes_; }

 private:
  std::string path_of(const CacheKey& key) const;
  void look_after();
  void sweep();
  /// Writes aside and renames. Empty: it is there; else why not.
  std::string put(const std::string& path, const Bytes& bytes);
  void note_write(const std::string& path, std::size_t bytes, const std::string& failure);
  /// Nobody else trims the directory.
  bool take_lock();

  const std::string directory_;
  const Use use_;
  const std::uint64_t budget_;
  const std::uint32_t writer_;  ///< by chance: process ids are the same in two containers
  std::atomic<std::uint64_t> bytes_{0};
  std::atomic<std::uint64_t> unseen_{0};  ///< written since the last look
  std::atomic<std::uint32_t> parts_{0};   ///< files written aside so far
  std::mutex mutex_;
  std::condition_variable changed_;
  std::set<std::string> written_;  ///< by this server, as far as it does not hold the lock
  bool failing_ = false;
  int lock_ = -1;
  bool due_ = true;
  bool sweeping_ = false;
  bool stopping_ = false;
  std::thread keeper_;
};

}  // namespace mirage
