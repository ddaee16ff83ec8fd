// Runs the corpus of every target, and seeded mutations of each file, in the ordinary test run.
// Usage: mirage_fuzz_replay CORPUS [MUTATIONS] with CORPUS/<target>/<files>. A crash is the
// failure.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <vector>

#include "fuzz_targets.h"

namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;

struct Target {
  const char* name;
  void (*run)(const std::uint8_t*, std::size_t);
};

constexpr Target kTargets[] = {
    {"message", mirage::fuzz::run_message}, {"tile", mirage::fuzz::run_tile},
    {"model", mirage::fuzz::run_model},     {"image", mirage::fuzz::run_image},
    {"draco", mirage::fuzz::run_draco},     {"meshopt", mirage::fuzz::run_meshopt},
    {"session", mirage::fuzz::run_session}};

Bytes read_file(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return Bytes(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
}

/// Returns one of the values at which lengths and floats break.
std::uint32_t telling_word(std::mt19937& random) {
  constexpr std::uint32_t kWords[] = {0,          1,          0x7f,       0xff,
                                      0x7fff,     0xffff,     0x7fffffff, 0x80000000,
                                      0xffffffff, 0x7fc00000, 0x7f800000, 0xff800000};
  return kWords[random() % std::size(kWords)];
}

Bytes mutated(const Bytes& seed, std::mt19937& random) {
  Bytes bytes = seed;
  for (std::uint32_t n = 1 + random() % 4; n > 0 && !bytes.empty(); --n) {
    const std::size_t at = random() % bytes.size();
    switch (random() % 5) {
      case 0:
        bytes[at] = static_cast<std::uint8_t>(bytes[at] ^ (1u << random() % 8));
        break;
      case 1:
        bytes[at] = static_cast<std::uint8_t>(random());
        break;
      case 2: {
        const std::uint32_t word = telling_word(random);
        for (std::size_t i = 0; i < 4 && at + i < bytes.size(); ++i) {
          bytes[at + i] = static_cast<std::uint8_t>(word >> (8 * i));
        }
        break;
      }
      case 3:
        bytes.resize(at);
        break;
      default:
        bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at), bytes.back());
        break;
    }
  }
  return bytes;
}

/// Replays this target's corpus. Returns the number of files.
std::size_t replay(const Target& target, const fs::path& folder, int mutations) {
  std::vector<fs::path> files;
  if (fs::is_directory(folder)) {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
      if (entry.is_regular_file()) files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  std::mt19937 random(1);
  for (const fs::path& file : files) {
    const Bytes seed = read_file(file);
    target.run(seed.data(), seed.size());
    for (int i = 0; i < mutations; ++i) {
      const Bytes bytes = mutated(seed, random);
      target.run(bytes.data(), bytes.size());
    }
  }
  std::printf("%s: %zu files, %d mutations each\n", target.name, files.size(), mutations);
  return files.size();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: mirage_fuzz_replay CORPUS [MUTATIONS]\n");
    return 2;
  }
  const int mutations = argc > 2 ? std::atoi(argv[2]) : 3000;
  bool complete = true;
  for (const Target& target : kTargets) {
    complete = replay(target, fs::path(argv[1]) / target.name, mutations) > 0 && complete;
  }
  // An empty corpus must fail, because no test would have run.
  return complete ? 0 : 1;
}
