#pragma once
// The folder of a bake. A file has its final name only when it is whole, and only one run, or the
// shards of one run, write into a folder at a time.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocol/base/result.h"

namespace mirage {

/// An exclusive or shared lock on a file; the system takes it back when the program ends.
class FileLock {
 public:
  FileLock() = default;
  FileLock(FileLock&& other) noexcept;
  FileLock& operator=(FileLock&& other) noexcept;
  ~FileLock();
  /// Makes the file if need be. `wait`: until it is free; otherwise nullopt if another holds it.
  /// Error kIo: the file cannot be made.
  static Result<std::optional<FileLock>> take(const std::string& file, bool shared, bool wait);

 private:
  explicit FileLock(int file) : file_(file) {}
  int file_ = -1;
};

class BakeFolder {
 public:
  /// Makes the folder and locks it. Errors kIo; kUsage: another run writes into it.
  static Result<BakeFolder> open(const std::string& path, int shard, int shards);

  /// Writes a file whole or not at all. `name` may have one folder in front. Error kIo.
  Result<void> write(const std::string& name, std::span<const std::uint8_t> bytes) const;
  Result<void> write(const std::string& name, const std::string& text) const;
  /// Returns a file's bytes; nullopt: it is not there.
  std::optional<std::string> read(const std::string& name) const;
  /// Returns the size of a file, bytes; nullopt: it is not there.
  std::optional<std::uint64_t> size(const std::string& name) const;
  /// Returns the files whose names end with `ending`, sorted.
  std::vector<std::string> names(const std::string& ending) const;
  /// Only one shard at a time holds the returned lock: it may read what others have written, and
  /// write what depends on it. Error kIo.
  Result<FileLock> alone() const;

 private:
  explicit BakeFolder(std::string path) : path_(std::move(path)) {}
  std::string path_;
  FileLock all_, own_;
};

}  // namespace mirage
