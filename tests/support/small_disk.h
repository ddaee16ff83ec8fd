#pragma once
// A disk that is soon full.

#include <sys/mount.h>

#include <filesystem>
#include <string>
#include <vector>

namespace mirage::test {

/// A disk of 256 KiB of its own, where the user may mount one.
class SmallDisk {
 public:
  explicit SmallDisk(const std::string& at) : at_(at) {
    std::filesystem::create_directories(at_);
    mounted_ = mount("none", at_.c_str(), "tmpfs", 0, "size=256k") == 0;
  }
  ~SmallDisk() {
    if (mounted_) umount2(at_.c_str(), MNT_DETACH);
  }
  bool mounted() const { return mounted_; }
  std::uintmax_t free_bytes() const { return std::filesystem::space(at_).available; }
  void empty() const {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(at_)) {
      if (entry.is_regular_file()) files.push_back(entry.path());
    }
    for (const std::filesystem::path& file : files) std::filesystem::remove(file);
  }

 private:
  const std::string at_;
  bool mounted_ = false;
};

}  // namespace mirage::test
