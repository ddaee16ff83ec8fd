#pragma once
// Output folder: the files that a bake or a freeze writes. A file is written under another name in
// the folder's working folder and renamed, so under its own name it is whole, whenever the program
// is ended. Only one run, or the shards of one run, write into a folder at a time.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocol/base/bytes.h"
#include "protocol/base/result.h"
#include "protocol/base/shard.h"

namespace mirage {

/// An exclusive or shared lock on a file; the system takes it back when the program ends, however
/// that happens.
class FileLock {
 public:
  FileLock() = default;
  FileLock(FileLock&& other) noexcept;
  FileLock& operator=(FileLock&& other) noexcept;
  ~FileLock();
  /// Makes the file if need be. `wait`: until it is free; otherwise nullopt if another holds it.
  /// Error kIo: the file cannot be made or locked.
  static Result<std::optional<FileLock>> take(const std::string& file, bool shared, bool wait);
  /// Makes a shared lock exclusive. False: another run holds it, and the shared lock may be lost.
  bool make_exclusive(bool wait);

 private:
  explicit FileLock(int file) : file_(file) {}
  int file_ = -1;
};

class OutputFolder {
 public:
  /// Makes and locks the folder for one run, or for one shard of a run. `work`: name of
  /// the working folder in it, ".bake". Errors kIo, with the system's reason; kUsage: another run
  /// writes into it.
  static Result<OutputFolder> open(const std::string& path, const std::string& work, Shard shard);

  const std::string& path() const { return path_; }
  /// Writes a file whole or not at all, unless it has these bytes already; makes the folders in its
  /// name. Error kIo.
  Result<void> write(const std::string& name, std::span<const std::uint8_t> bytes) const;
  Result<void> write(const std::string& name, const std::string& text) const;
  /// Returns a file's bytes; nullopt: it is not there.
  std::optional<Bytes> read(const std::string& name) const;
  std::optional<std::string> read_text(const std::string& name) const;
  bool has(const std::string& name) const;
  void remove(const std::string& name) const;
  /// Returns the files of the folder itself whose names end with `ending`, sorted.
  std::vector<std::string> names(const std::string& ending) const;

  /// One shard at a time holds the returned lock: it may read what others have written and write
  /// what depends on it. Error kIo.
  Result<FileLock> one_at_a_time() const;
  /// Waits until no other shard is at work. Error kIo.
  Result<void> wait_for_others();
  /// Removes the working folder, with what killed runs have left in it. Does nothing while another
  /// shard is at work: the last one does it. Call it at the end of a run.
  void clear_work();

 private:
  OutputFolder(std::string path, std::string work);
  std::string in_work(const std::string& name) const;

  std::string path_, work_;
  FileLock all_, own_;
};

}  // namespace mirage
