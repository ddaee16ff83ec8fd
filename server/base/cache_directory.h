#pragma once
// A directory of files that can be made again: finished tiles, and data derived from meshes and
// images when a scene was loaded.
//
// A file is written aside and renamed, so a reader never sees half of one. It ends with a hash of
// its name and its bytes, and a damaged file counts as missing. Several servers may share a
// directory.
//
// Over budget, the files used longest ago are removed. A separate thread does that, so no reader or
// writer waits for it. Among servers that share the directory, the one that holds its lock trims
// all files. The others remove only files they wrote themselves, or the smallest budget would apply
// to everybody.

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

/// Names a file: a hash of what it is made from, and its kind ("tile" for AB….tile).
struct CacheKey {
  std::uint64_t high = 0, low = 0;
  const char* kind = "";
};

class CacheDirectory {
 public:
  enum class Use : std::uint8_t { kReadAndWrite, kReadOnly };
  /// Uses the directory `path`, which is created at the first write. Any thread may use it.
  CacheDirectory(std::string path, std::uint64_t budget_bytes, Use use = Use::kReadAndWrite);
  ~CacheDirectory();
  CacheDirectory(const CacheDirectory&) = delete;
  CacheDirectory& operator=(const CacheDirectory&) = delete;

  /// Returns the file's bytes; nullopt if it is missing or damaged. A damaged file is removed with
  /// a warning.
  std::optional<Bytes> read(const CacheKey& key) const;
  /// Writes a file; false if it was not kept. A full or unwritable directory is no error: it is
  /// logged once, and once more when writing works again.
  bool write(const CacheKey& key, Bytes bytes);

  /// Waits until the directory has been listed and is within its budget.
  void settle();
  /// Bytes of all files: as last listed, plus later writes.
  std::uint64_t bytes() const { return bytes_; }

 private:
  std::string path_of(const CacheKey& key) const;
  void look_after();
  void sweep();
  /// Writes aside and renames. Returns an empty text, or why it failed.
  std::string put(const std::string& path, const Bytes& bytes);
  void note_write(const std::string& path, std::size_t bytes, const std::string& failure);
  /// Takes the lock of the directory; its holder alone trims files of other servers.
  bool take_lock();

  const std::string directory_;
  const Use use_;
  const std::uint64_t budget_;
  const std::uint32_t writer_;  ///< random: process ids repeat among containers
  std::atomic<std::uint64_t> bytes_{0};
  std::atomic<std::uint64_t> unseen_{0};  ///< bytes written since the last listing
  std::atomic<std::uint32_t> parts_{0};   ///< files written aside so far
  std::mutex mutex_;
  std::condition_variable changed_;
  std::set<std::string> written_;  ///< by this server while it did not hold the lock
  bool failing_ = false;
  int lock_ = -1;
  bool due_ = true;
  bool sweeping_ = false;
  bool stopping_ = false;
  std::thread keeper_;
};

}  // namespace mirage
