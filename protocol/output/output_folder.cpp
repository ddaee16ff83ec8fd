#include "protocol/output/output_folder.h"

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

constexpr const char* kNew = "new-";  // begins the name of a file that is not whole yet

Error cannot(const std::string& what, const std::string& path, int reason) {
  const bool full = reason == ENOSPC || reason == EDQUOT;
  return make_error(ErrorId::kIo, "cannot " + what + " '" + path + "': " + std::strerror(reason),
                    full ? "make room and run the same command again: it goes on where it was"
                         : "check the path and its permissions");
}

// Returns 0 or the reason. Some file systems cannot be told to write to the disk: EINVAL.
int write_whole(int file, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(file, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return n < 0 ? errno : ENOSPC;
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
  return ::fsync(file) == 0 || errno == EINVAL ? 0 : errno;
}

int lock_file(int file, bool shared, bool wait) {
  int taken = 0;
  do {
    taken = ::flock(file, (shared ? LOCK_SH : LOCK_EX) | (wait ? 0 : LOCK_NB));
  } while (taken != 0 && errno == EINTR);
  return taken == 0 ? 0 : errno;
}

// Removes the files that killed runs had begun. Only for a run that has the folder to itself.
void remove_begun(const fs::path& work) {
  std::error_code failed;
  for (fs::directory_iterator at(work, failed), end; !failed && at != end;) {
    const fs::path file = at->path();
    at.increment(failed);
    std::error_code ignored;
    if (file.filename().string().starts_with(kNew)) fs::remove(file, ignored);
  }
}

template <class Text>
std::optional<Text> read_as(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::nullopt;
  return Text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
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
  if (opened < 0) return cannot("write", file, errno);
  FileLock lock(opened);
  const int reason = lock_file(opened, shared, wait);
  if (reason == EWOULDBLOCK) return std::optional<FileLock>();
  if (reason != 0) return cannot("lock", file, reason);
  return std::optional<FileLock>(std::move(lock));
}

bool FileLock::make_exclusive(bool wait) { return lock_file(file_, false, wait) == 0; }

OutputFolder::OutputFolder(std::string path, std::string work)
    : path_(std::move(path)), work_(std::move(work)) {}

std::string OutputFolder::in_work(const std::string& name) const {
  return path_ + "/" + work_ + "/" + name;
}

Result<OutputFolder> OutputFolder::open(const std::string& path, const std::string& work,
                                        Shard shard) {
  std::error_code failed;
  fs::create_directories(fs::path(path) / work, failed);
  if (failed) return cannot("make", path, failed.value());
  OutputFolder out(path, work);
  const auto hold = [&](const std::string& name, bool shared, FileLock& into) -> Result<void> {
    Result<std::optional<FileLock>> taken = FileLock::take(out.in_work(name), shared, false);
    if (!taken) return taken.error();
    if (!taken->has_value()) {
      return make_error(ErrorId::kUsage, "another run writes into '" + path + "'",
                        "wait for it, or give this one a folder of its own");
    }
    into = std::move(**taken);
    return {};
  };
  if (Result<void> held = hold("lock", shard.count > 1, out.all_); !held) return held.error();
  if (shard.count == 1) {
    remove_begun(fs::path(path) / work);
    return out;
  }
  const std::string own = "lock." + std::to_string(shard.index) + "-" + std::to_string(shard.count);
  if (Result<void> held = hold(own, false, out.own_); !held) return held.error();
  return out;
}

Result<void> OutputFolder::write(const std::string& name,
                                 std::span<const std::uint8_t> bytes) const {
  if (const std::optional<Bytes> there = read(name); there && std::ranges::equal(*there, bytes)) {
    return {};
  }
  const fs::path target = fs::path(path_) / name;
  const std::string begun = in_work(kNew + std::to_string(static_cast<long>(::getpid())));
  std::error_code failed;
  for (const fs::path& folder : {target.parent_path(), fs::path(begun).parent_path()}) {
    fs::create_directories(folder, failed);
    if (failed) return cannot("make", folder.string(), failed.value());
  }
  const int file = ::open(begun.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file < 0) return cannot("write", begun, errno);
  int reason = write_whole(file, bytes);
  if (::close(file) != 0 && reason == 0) reason = errno;
  if (reason == 0 && ::rename(begun.c_str(), target.c_str()) != 0) reason = errno;
  if (reason == 0) return {};
  ::unlink(begun.c_str());
  return cannot("write", target.string(), reason);
}

Result<void> OutputFolder::write(const std::string& name, const std::string& text) const {
  return write(name, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

std::optional<Bytes> OutputFolder::read(const std::string& name) const {
  return read_as<Bytes>(fs::path(path_) / name);
}

std::optional<std::string> OutputFolder::read_text(const std::string& name) const {
  return read_as<std::string>(fs::path(path_) / name);
}

bool OutputFolder::has(const std::string& name) const {
  std::error_code failed;
  return fs::is_regular_file(fs::path(path_) / name, failed);
}

void OutputFolder::remove(const std::string& name) const {
  std::error_code ignored;
  fs::remove(fs::path(path_) / name, ignored);
}

std::vector<std::string> OutputFolder::names(const std::string& ending) const {
  std::vector<std::string> out;
  std::error_code failed;
  for (const fs::directory_entry& entry : fs::directory_iterator(path_, failed)) {
    const std::string name = entry.path().filename().string();
    if (name.size() > ending.size() && name.ends_with(ending)) out.push_back(name);
  }
  std::sort(out.begin(), out.end());
  return out;
}

Result<FileLock> OutputFolder::one_at_a_time() const {
  const std::string name = in_work("lock.index");
  Result<std::optional<FileLock>> lock = FileLock::take(name, false, true);
  if (!lock) return lock.error();
  if (!lock->has_value()) return cannot("lock", name, EWOULDBLOCK);
  return std::move(**lock);
}

Result<void> OutputFolder::wait_for_others() {
  return all_.make_exclusive(true) ? Result<void>() : cannot("lock", path_, errno);
}

void OutputFolder::clear_work() {
  if (!all_.make_exclusive(false)) return;
  std::error_code ignored;
  fs::remove_all(fs::path(path_) / work_, ignored);
}

}  // namespace mirage
