#include "server/bake/bake_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>

namespace mirage {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPart = ".part";  // ending of a file that is not whole yet

Error cannot_write(const std::string& path, int reason) {
  return make_error(ErrorId::kIo, "cannot write '" + path + "': " + std::strerror(reason),
                    reason == ENOSPC ? "free some space and run it again: it goes on where it was"
                                     : "check the path and its permissions");
}

// Returns 0 or the reason.
int write_all(int file, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(file, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return n < 0 ? errno : ENOSPC;
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
  return ::fsync(file) == 0 ? 0 : errno;
}

// Removes what a run left that was killed. Only for a run that has the folder to itself.
void remove_parts(const std::string& path) {
  std::error_code failed;
  for (fs::recursive_directory_iterator at(path, failed), end; !failed && at != end;) {
    const fs::path file = at->path();
    at.increment(failed);
    std::error_code ignored;
    if (file.extension() == kPart) fs::remove(file, ignored);
  }
}

}  // namespace

FileLock::FileLock(FileLock&& other) noexcept : file_(std::exchange(other.file_, -1)) {}
FileLock& FileLock::operator=(FileLock&& other) noexcept {
  std::swap(file_, other.file_);
  return *this;
}
FileLock::~FileLock() {
  if (file_ >= 0) ::close(file_);
}

Result<std::optional<FileLock>> FileLock::take(const std::string& file, bool shared, bool wait) {
  const int opened = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (opened < 0) return cannot_write(file, errno);
  FileLock lock(opened);
  int taken = 0;
  do {
    taken = ::flock(opened, (shared ? LOCK_SH : LOCK_EX) | (wait ? 0 : LOCK_NB));
  } while (taken != 0 && errno == EINTR);
  if (taken != 0) return std::optional<FileLock>();
  return std::optional<FileLock>(std::move(lock));
}

Result<BakeFolder> BakeFolder::open(const std::string& path, int shard, int shards) {
  std::error_code failed;
  fs::create_directories(path, failed);
  if (failed) return cannot_write(path, failed.value());
  BakeFolder out(path);
  const auto hold = [&](const std::string& name, bool shared, FileLock& into) -> Result<void> {
    Result<std::optional<FileLock>> taken = FileLock::take(path + "/" + name, shared, false);
    if (!taken) return taken.error();
    if (!taken->has_value()) {
      return make_error(ErrorId::kUsage, "another run writes into '" + path + "'",
                        "wait for it, or give this one a folder of its own");
    }
    into = std::move(**taken);
    return {};
  };
  if (Result<void> held = hold(".bake.lock", shards > 1, out.all_); !held) return held.error();
  if (shards == 1) {
    remove_parts(path);
  } else {
    const std::string own =
        ".bake." + std::to_string(shard) + "-" + std::to_string(shards) + ".lock";
    if (Result<void> held = hold(own, false, out.own_); !held) return held.error();
  }
  return out;
}

Result<void> BakeFolder::write(const std::string& name, std::span<const std::uint8_t> bytes) const {
  const fs::path target = fs::path(path_) / name;
  std::error_code failed;
  fs::create_directories(target.parent_path(), failed);
  if (failed) return cannot_write(target.parent_path().string(), failed.value());
  const std::string part =
      target.string() + "." + std::to_string(static_cast<long>(::getpid())) + kPart;
  const int file = ::open(part.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file < 0) return cannot_write(part, errno);
  int reason = write_all(file, bytes);
  if (::close(file) != 0 && reason == 0) reason = errno;
  if (reason == 0 && ::rename(part.c_str(), target.c_str()) != 0) reason = errno;
  if (reason == 0) return {};
  ::unlink(part.c_str());
  return cannot_write(target.string(), reason);
}

Result<void> BakeFolder::write(const std::string& name, const std::string& text) const {
  return write(name, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

std::optional<std::string> BakeFolder::read(const std::string& name) const {
  std::ifstream file(fs::path(path_) / name, std::ios::binary);
  if (!file) return std::nullopt;
  return std::string{std::istreambuf_iterator<char>(file), {}};
}

std::optional<std::uint64_t> BakeFolder::size(const std::string& name) const {
  std::error_code failed;
  const std::uintmax_t bytes = fs::file_size(fs::path(path_) / name, failed);
  if (failed) return std::nullopt;
  return bytes;
}

std::vector<std::string> BakeFolder::names(const std::string& ending) const {
  std::vector<std::string> out;
  std::error_code failed;
  for (const fs::directory_entry& entry : fs::directory_iterator(path_, failed)) {
    const std::string name = entry.path().filename().string();
    if (name.size() > ending.size() && name.ends_with(ending)) out.push_back(name);
  }
  std::sort(out.begin(), out.end());
  return out;
}

Result<FileLock> BakeFolder::alone() const {
  Result<std::optional<FileLock>> lock = FileLock::take(path_ + "/.bake.index.lock", false, true);
  if (!lock) return lock.error();
  if (!lock->has_value()) return make_error(ErrorId::kIo, "'" + path_ + "' cannot be locked");
  return std::move(**lock);
}

}  // namespace mirage
