#include "client/freeze/folder_store.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace mirage {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWork = ".freeze";

Error cannot(const std::string& what, const std::string& name, int why) {
  const bool full = why == ENOSPC || why == EDQUOT;
  return make_error(
      ErrorId::kIo, "cannot " + what + " '" + name + "': " + std::strerror(why),
      full ? "make room and run the same command again: it goes on where it was" : "");
}

Error in_use(const std::string& folder) {
  return make_error(ErrorId::kUsage, "another mirage-freeze writes into '" + folder + "'",
                    "wait for it, or choose another folder");
}

int open_lock(const std::string& name) {
  return ::open(name.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
}

// Writes the whole, to the disk; 0 or the error's number.
int write_whole(int file, const Bytes& bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t n = ::write(file, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return errno;
    done += static_cast<std::size_t>(n);
  }
  return ::fsync(file) == 0 || errno == EINVAL ? 0 : errno;
}

}  // namespace

Result<FolderStore> FolderStore::open(const std::string& folder) {
  std::error_code failed;
  fs::create_directories(fs::path(folder) / kWork, failed);
  if (failed) return cannot("make", folder, failed.value());
  return FolderStore(folder);
}

FolderStore::FolderStore(FolderStore&& other) noexcept
    : folder_(std::move(other.folder_)),
      lock_(std::exchange(other.lock_, -1)),
      shard_lock_(std::exchange(other.shard_lock_, -1)) {}

FolderStore::~FolderStore() {
  for (const int file : {lock_, shard_lock_}) {
    if (file >= 0) ::close(file);
  }
}

Result<void> FolderStore::lock(unsigned shard, unsigned shards) {
  const std::string base = folder_ + "/" + kWork + "/lock";
  lock_ = open_lock(base);
  if (lock_ < 0) return cannot("open", base, errno);
  if (::flock(lock_, (shards > 1 ? LOCK_SH : LOCK_EX) | LOCK_NB) != 0) return in_use(folder_);
  if (shards == 1) return {};
  const std::string own = base + "." + std::to_string(shard) + "." + std::to_string(shards);
  shard_lock_ = open_lock(own);
  if (shard_lock_ < 0) return cannot("open", own, errno);
  if (::flock(shard_lock_, LOCK_EX | LOCK_NB) != 0) return in_use(folder_);
  return {};
}

Result<void> FolderStore::lock_alone() {
  if (::flock(lock_, LOCK_EX) != 0) return cannot("lock", folder_, errno);
  return {};
}

Result<void> FolderStore::write(const std::string& name, const Bytes& bytes) const {
  const fs::path path = fs::path(folder_) / name;
  if (const std::optional<Bytes> there = read(name); there && *there == bytes) return {};
  std::error_code failed;
  fs::create_directories(path.parent_path(), failed);
  if (failed) return cannot("make", path.parent_path().string(), failed.value());
  const std::string temporary = path.string() + ".new-" + std::to_string(::getpid());
  const int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file < 0) return cannot("write", path.string(), errno);
  int why = write_whole(file, bytes);
  if (::close(file) != 0 && why == 0) why = errno;
  if (why == 0 && std::rename(temporary.c_str(), path.c_str()) != 0) why = errno;
  if (why == 0) return {};
  ::unlink(temporary.c_str());
  return cannot("write", path.string(), why);
}

std::optional<Bytes> FolderStore::read(const std::string& name) const {
  std::ifstream file(fs::path(folder_) / name, std::ios::binary);
  if (!file) return std::nullopt;
  return Bytes(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
}

bool FolderStore::has(const std::string& name) const {
  std::error_code failed;
  return fs::is_regular_file(fs::path(folder_) / name, failed);
}

void FolderStore::remove(const std::string& name) const {
  std::error_code ignored;
  fs::remove(fs::path(folder_) / name, ignored);
}

void FolderStore::clear_work() const {
  std::error_code ignored;
  fs::remove_all(fs::path(folder_) / kWork, ignored);
}

std::vector<std::string> FolderStore::list(const std::string& below) const {
  std::vector<std::string> out;
  std::error_code failed;
  fs::recursive_directory_iterator at(fs::path(folder_) / below, failed), end;
  for (; !failed && at != end; at.increment(failed)) {
    std::error_code ignored;
    if (at->is_regular_file(ignored)) {
      out.push_back(fs::relative(at->path(), folder_, ignored).generic_string());
    }
  }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace mirage
