#pragma once
// Folder store: the files of the folder that is written. A file is written under a temporary name
// and renamed, so under its own name it is whole, whenever the program is ended.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "protocol/base/bytes.h"
#include "protocol/base/result.h"

namespace mirage {

class FolderStore {
 public:
  /// Makes the folder, with its working folder `.freeze`. Error kIo.
  static Result<FolderStore> open(const std::string& folder);
  FolderStore(FolderStore&& other) noexcept;
  FolderStore& operator=(FolderStore&&) = delete;
  ~FolderStore();

  /// Locks the folder for this run, or for one shard of a run. The system unlocks it when the
  /// program ends, however that happens. Error kUsage: another run has it.
  Result<void> lock(unsigned shard, unsigned shards);
  /// Waits until no other shard is at work.
  Result<void> lock_alone();

  /// Writes a file, unless it has these bytes already. Error kIo, with the system's reason.
  Result<void> write(const std::string& name, const Bytes& bytes) const;
  std::optional<Bytes> read(const std::string& name) const;
  bool has(const std::string& name) const;
  void remove(const std::string& name) const;
  /// Removes what a run needs and the folder does not.
  void clear_work() const;
  /// Returns the names of all files below a part of the folder, sorted.
  std::vector<std::string> list(const std::string& below) const;
  const std::string& folder() const { return folder_; }

 private:
  explicit FolderStore(std::string folder) : folder_(std::move(folder)) {}

  std::string folder_;
  int lock_ = -1;
  int shard_lock_ = -1;
};

}  // namespace mirage
