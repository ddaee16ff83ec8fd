#include "server/base/cache_directory.h"

#include <fcntl.h>
#include <spdlog/spdlog.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <vector>

namespace mirage {
namespace fs = std::filesystem;
namespace {

constexpr const char* kPart = ".part";
// age at which a file whose writer is gone is removed
constexpr auto kPartLife = std::chrono::minutes(10);
// looks again after writing 1/16 of the budget: other servers may write, too
constexpr std::uint64_t kLookShare = 16;

std::string name_of(const CacheKey& key) {
  return fmt::format("{:016x}{:016x}.{}", key.high, key.low, key.kind);
}

std::uint64_t hash_of(const std::string& name, const void* bytes, std::size_t size) {
  return XXH3_64bits_withSeed(bytes, size, XXH3_64bits(name.data(), name.size()));
}

// True if a file is one of ours. Nothing else in the directory is touched.
bool is_ours(const fs::path& file) {
  const std::string name = file.filename().string();
  const std::string folder = file.parent_path().filename().string();
  return name.size() > 33 && name[32] == '.' && folder == name.substr(0, 2) &&
         name.find_first_not_of("0123456789abcdef") == 32;
}

struct Found {
  fs::path path;
  fs::file_time_type used;
  std::uint64_t bytes = 0;
};

std::vector<Found> files_in(const std::string& directory) {
  std::vector<Found> out;
  std::error_code failed;
  fs::recursive_directory_iterator at(directory, failed), end;
  for (; !failed && at != end; at.increment(failed)) {
    std::error_code gone;  // another server may trim the directory at the same time
    if (at.depth() > 1 || !at->is_regular_file(gone) || !is_ours(at->path())) continue;
    const std::uint64_t bytes = at->file_size(gone);
    const fs::file_time_type used = at->last_write_time(gone);
    if (!gone) out.push_back({at->path(), used, bytes});
  }
  return out;
}

// Reads a whole regular file. Returns nullopt if it is missing or no regular file, because opening
// a pipe without a writer would block for ever. Returns empty bytes if it is larger than `most` or
// ends early.
std::optional<Bytes> read_regular_file(const std::string& path, std::uint64_t most) {
  const int file = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) return std::nullopt;
  struct stat about {};
  const bool regular = fstat(file, &about) == 0 && S_ISREG(about.st_mode);
  const auto size = static_cast<std::uint64_t>(about.st_size);
  Bytes bytes(regular && size <= most ? size : 0);
  std::size_t here = 0;
  while (here < bytes.size()) {
    const ssize_t n = ::read(file, bytes.data() + here, bytes.size() - here);
    if (n <= 0) break;
    here += static_cast<std::size_t>(n);
  }
  close(file);
  if (!regular) return std::nullopt;
  if (here < bytes.size()) bytes.clear();
  return bytes;
}

}  // namespace

CacheDirectory::CacheDirectory(std::string path, std::uint64_t budget_bytes, Use use)
    : directory_(std::move(path)),
      use_(use),
      budget_(budget_bytes),
      writer_(std::random_device()()),
      keeper_([this] { look_after(); }) {}

CacheDirectory::~CacheDirectory() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  keeper_.join();
  if (lock_ >= 0) close(lock_);
}

bool CacheDirectory::take_lock() {
  if (lock_ >= 0) return true;
  const int folder = open(directory_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return false;
  if (flock(folder, LOCK_EX | LOCK_NB) != 0) {
    close(folder);
    return false;
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  lock_ = folder;
  written_.clear();
  return true;
}

std::string CacheDirectory::path_of(const CacheKey& key) const {
  const std::string name = name_of(key);
  return directory_ + "/" + name.substr(0, 2) + "/" + name;
}

std::optional<Bytes> CacheDirectory::read(const CacheKey& key) const {
  const std::string path = path_of(key);
  std::optional<Bytes> whole_file = read_regular_file(path, budget_);
  if (!whole_file) return std::nullopt;
  Bytes& bytes = *whole_file;
  std::uint64_t hash = 0;
  const std::size_t own = bytes.size() - std::min(bytes.size(), sizeof(hash));
  if (bytes.size() >= sizeof(hash)) std::memcpy(&hash, bytes.data() + own, sizeof(hash));
  const bool whole = bytes.size() >= sizeof(hash);
  if (!whole || hash_of(name_of(key), bytes.data(), own) != hash) {
    spdlog::warn("cache: '{}' is damaged and made anew", path);
    std::error_code ignored;
    if (use_ == Use::kReadAndWrite) fs::remove(path, ignored);
    return std::nullopt;
  }
  // The new time of use keeps the file longer.
  if (use_ == Use::kReadAndWrite) utimensat(AT_FDCWD, path.c_str(), nullptr, 0);
  bytes.resize(own);
  return whole_file;
}

std::string CacheDirectory::put(const std::string& path, const Bytes& bytes) {
  std::error_code failed;
  fs::create_directories(fs::path(path).parent_path(), failed);
  if (failed) return failed.message();
  const std::string aside = fmt::format("{}.{:08x}-{}{}", path, writer_, parts_++, kPart);
  errno = 0;
  std::ofstream file(aside, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  file.close();
  const int why = errno;
  if (file) {
    fs::rename(aside, path, failed);
    if (!failed) return "";
  }
  const std::string text = failed ? failed.message() : std::generic_category().message(why);
  fs::remove(aside, failed);
  return text;
}

bool CacheDirectory::write(const CacheKey& key, Bytes bytes) {
  if (use_ == Use::kReadOnly) return false;
  const std::string path = path_of(key);
  const std::uint64_t hash = hash_of(name_of(key), bytes.data(), bytes.size());
  const std::size_t own = bytes.size();
  bytes.resize(own + sizeof(hash));
  std::memcpy(bytes.data() + own, &hash, sizeof(hash));
  const std::string failure = put(path, bytes);
  note_write(path, bytes.size(), failure);
  return failure.empty();
}

void CacheDirectory::note_write(const std::string& path, std::size_t bytes,
                                const std::string& failure) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (failing_ == failure.empty()) {
    failing_ = !failing_;
    if (failing_) {
      spdlog::warn("cache: '{}' cannot be written ({}): nothing more is kept", directory_, failure);
    } else {
      spdlog::info("cache: '{}' can be written again", directory_);
    }
  }
  if (failing_) return;
  if (lock_ < 0) written_.insert(path);
  bytes_ += bytes;
  unseen_ += bytes;
  if (bytes_ <= budget_ && unseen_ <= budget_ / kLookShare) return;
  due_ = true;
  changed_.notify_all();
}

void CacheDirectory::settle() {
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait(lock, [this] { return !due_ && !sweeping_; });
}

void CacheDirectory::look_after() {
  std::unique_lock<std::mutex> lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return due_ || stopping_; });
    if (stopping_) return;
    due_ = false;
    sweeping_ = true;
    lock.unlock();
    sweep();
    lock.lock();
    sweeping_ = false;
    changed_.notify_all();
  }
}

void CacheDirectory::sweep() {
  unseen_ = 0;
  std::vector<Found> files = files_in(directory_);
  const bool all_are_ours = use_ == Use::kReadAndWrite && take_lock();
  if (!all_are_ours) {
    const std::lock_guard<std::mutex> lock(mutex_);
    files.erase(
        std::remove_if(files.begin(), files.end(),
                       [&](const Found& file) { return written_.count(file.path.string()) == 0; }),
        files.end());
  }
  const auto now = fs::file_time_type::clock::now();
  std::error_code ignored;
  std::uint64_t total = 0;
  for (const Found& file : files) {
    const bool aside = file.path.extension() == kPart;
    if (aside && now - file.used > kPartLife) fs::remove(file.path, ignored);
    if (!aside) total += file.bytes;
  }
  if (total > budget_) {
    std::sort(files.begin(), files.end(),
              [](const Found& a, const Found& b) { return a.used < b.used; });
    // The target is somewhat below the budget, or the next file would start another sweep.
    const std::uint64_t wanted = budget_ - budget_ / kLookShare;
    for (const Found& file : files) {
      if (total <= wanted) break;
      if (file.path.extension() == kPart) continue;
      if (!fs::remove(file.path, ignored)) continue;
      total -= file.bytes;
      const std::lock_guard<std::mutex> lock(mutex_);
      written_.erase(file.path.string());
    }
  }
  bytes_ = total + unseen_;
}

}  // namespace mirage
