// Cache directory: things that can be made again: its budget, age, damage, and several writers.
#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "server/base/cache_directory.h"
#include "tests/support/temp_folder.h"

namespace mirage::test {
namespace {
namespace fs = std::filesystem;

constexpr std::uint64_t kRoomy = 1u << 30;

CacheKey key_of(std::uint64_t n) { return {n * 0x9e3779b97f4a7c15ull, n, "thing"}; }
Bytes thing(std::uint64_t n, std::size_t size = 1000) {
  Bytes out(size);
  for (std::size_t i = 0; i < size; ++i) out[i] = static_cast<std::uint8_t>(i * 13 + n * 7);
  return out;
}

class ServerCache : public ::testing::Test {
 protected:
  /// Returns all regular files, the one used longest ago first.
  std::vector<fs::path> files() const {
    std::vector<fs::path> out = temporary_.files();
    std::sort(out.begin(), out.end(), [](const fs::path& a, const fs::path& b) {
      return fs::last_write_time(a) < fs::last_write_time(b);
    });
    return out;
  }
  std::uint64_t bytes_there() const {
    std::uint64_t sum = 0;
    for (const fs::path& file : files()) sum += fs::file_size(file);
    return sum;
  }
  /// Makes every file look as if it was last used long ago, in the order in which they were used.
  void grow_old() const {
    const auto past = fs::file_time_type::clock::now() - std::chrono::hours(1);
    int i = 0;
    for (const fs::path& file : files()) {
      fs::last_write_time(file, past + std::chrono::seconds(i++));
    }
  }

  const TempFolder temporary_;
  const fs::path folder_ = temporary_.path();
};

TEST_F(ServerCache, WhatIsWrittenIsReadByTheNextProcess) {
  { CacheDirectory(folder_, kRoomy).write(key_of(1), thing(1)); }
  const CacheDirectory cache(folder_, kRoomy);
  EXPECT_EQ(cache.read(key_of(1)), thing(1));
  EXPECT_FALSE(cache.read(key_of(2)));
  EXPECT_FALSE(cache.read({key_of(1).high, key_of(1).low, "other"}));
}

TEST_F(ServerCache, EmptyThingsAreKeptToo) {
  CacheDirectory cache(folder_, kRoomy);
  cache.write(key_of(1), {});
  EXPECT_EQ(cache.read(key_of(1)), Bytes{});
}

TEST_F(ServerCache, DamageAndAnotherThingsFileAreNotRead) {
  CacheDirectory cache(folder_, kRoomy);
  const auto made = [&] {
    cache.write(key_of(1), thing(1));
    return files()[0];
  };
  fs::resize_file(made(), 500);
  EXPECT_FALSE(cache.read(key_of(1)));
  EXPECT_TRUE(files().empty()) << "to be made anew";
  std::fstream(made(), std::ios::in | std::ios::out | std::ios::binary).seekp(300).put('!');
  EXPECT_FALSE(cache.read(key_of(1)));
  const fs::path one = made();
  cache.write(key_of(2), thing(2));
  for (const fs::path& file : files()) {
    if (file != one) fs::copy_file(one, file, fs::copy_options::overwrite_existing);
  }
  EXPECT_TRUE(cache.read(key_of(1)));
  EXPECT_FALSE(cache.read(key_of(2))) << "the bytes of another name";
}

TEST_F(ServerCache, StaysWithinItsBudgetAndTheLongestUnusedGo) {
  constexpr std::uint64_t kBudget = 20'000;
  CacheDirectory cache(folder_, kBudget);
  for (std::uint64_t n = 0; n < 15; ++n) cache.write(key_of(n), thing(n));
  cache.settle();
  EXPECT_EQ(files().size(), 15u);
  grow_old();
  ASSERT_TRUE(cache.read(key_of(0))) << "used again";
  for (std::uint64_t n = 15; n < 25; ++n) cache.write(key_of(n), thing(n));
  cache.settle();
  EXPECT_LE(bytes_there(), kBudget);
  EXPECT_EQ(cache.bytes(), bytes_there());
  EXPECT_TRUE(cache.read(key_of(0)));
  EXPECT_FALSE(cache.read(key_of(1)));
  EXPECT_TRUE(cache.read(key_of(24)));
}

TEST_F(ServerCache, WhatEarlierProcessesLeftCounts) {
  {
    CacheDirectory cache(folder_, kRoomy);
    for (std::uint64_t n = 0; n < 50; ++n) cache.write(key_of(n), thing(n));
  }
  CacheDirectory cache(folder_, 10'000);
  cache.settle();
  EXPECT_LE(bytes_there(), 10'000u);
  EXPECT_GT(bytes_there(), 5'000u);
}

TEST_F(ServerCache, ASmallBudgetIsNotThatOfOthersWhoShareTheDirectory) {
  CacheDirectory owner(folder_, kRoomy);
  owner.settle();  // the owner was here first
  for (std::uint64_t n = 0; n < 20; ++n) EXPECT_TRUE(owner.write(key_of(n), thing(n)));
  CacheDirectory small(folder_, 4'000);
  small.settle();
  for (std::uint64_t n = 100; n < 120; ++n) {
    EXPECT_TRUE(small.write(key_of(n), thing(n)));
    small.settle();
  }
  for (std::uint64_t n = 0; n < 20; ++n) EXPECT_TRUE(owner.read(key_of(n))) << n;
  EXPECT_FALSE(owner.read(key_of(100)));
  EXPECT_TRUE(owner.read(key_of(119)));
}

TEST_F(ServerCache, OneThatOnlyReadsChangesNothing) {
  CacheDirectory(folder_, kRoomy).write(key_of(1), thing(1));
  std::ofstream(files()[0], std::ios::app) << "damage";
  CacheDirectory(folder_, kRoomy).write(key_of(2), thing(2));
  const std::size_t there = files().size();
  CacheDirectory reader(folder_, kRoomy, CacheDirectory::Use::kReadOnly);
  EXPECT_FALSE(reader.read(key_of(1)));
  EXPECT_TRUE(reader.read(key_of(2)));
  EXPECT_FALSE(reader.write(key_of(3), thing(3)));
  reader.settle();
  EXPECT_EQ(files().size(), there);
}

TEST_F(ServerCache, WhatCannotBeWrittenIsSaidOnceAndIsNoError) {
  const auto lines = std::make_shared<std::ostringstream>();
  const auto before = spdlog::default_logger();
  spdlog::set_default_logger(std::make_shared<spdlog::logger>(
      "test", std::make_shared<spdlog::sinks::ostream_sink_mt>(*lines)));
  {
    std::ofstream(folder_ / "not_a_folder") << "x";
    CacheDirectory cache(folder_ / "not_a_folder", kRoomy);
    for (std::uint64_t n = 0; n < 5; ++n) EXPECT_FALSE(cache.write(key_of(n), thing(n)));
    fs::remove(folder_ / "not_a_folder");
    EXPECT_TRUE(cache.write(key_of(6), thing(6)));
  }
  spdlog::set_default_logger(before);
  const std::string said = lines->str();
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 2) << said;
  EXPECT_NE(said.find("cannot be written"), std::string::npos) << said;
  EXPECT_NE(said.find("can be written again"), std::string::npos) << said;
}

TEST_F(ServerCache, TouchesNothingThatIsNotItsOwn) {
  fs::create_directories(folder_ / "ab");
  const fs::path foreign[] = {folder_ / "letter.txt", folder_ / "ab" / "photo.jpg",
                              folder_ / "ab" / (std::string(32, 'c') + ".tile"),
                              folder_ / "ab" / ("ab" + std::string(30, 'x') + ".tile"),
                              folder_ / "ab" / "ab.tile"};
  for (const fs::path& path : foreign) std::ofstream(path) << std::string(5000, 'x');
  CacheDirectory cache(folder_, 2'000);
  cache.write(key_of(1), thing(1));
  cache.settle();
  for (const fs::path& path : foreign) EXPECT_TRUE(fs::exists(path)) << path;
}

TEST_F(ServerCache, HalvesThatAWriterLeftAreRemovedOnceItIsSurelyGone) {
  CacheDirectory(folder_, kRoomy).write(key_of(1), thing(1));
  const fs::path old = files()[0].string() + ".99-1.part",
                 young = files()[0].string() + ".99-2.part";
  for (const fs::path& path : {old, young}) std::ofstream(path) << "half";
  fs::last_write_time(old, fs::file_time_type::clock::now() - std::chrono::hours(1));
  CacheDirectory cache(folder_, kRoomy);
  cache.settle();
  EXPECT_FALSE(fs::exists(old));
  EXPECT_TRUE(fs::exists(young));
  EXPECT_EQ(cache.read(key_of(1)), thing(1));
}

// Several writers of one name: a reader sees one whole thing or none, never two halves.
TEST_F(ServerCache, SeveralWritersAtOnceLeaveWholeFiles) {
  constexpr std::size_t kSize = 300'000;
  CacheDirectory one(folder_, kRoomy), other(folder_, kRoomy);
  std::atomic<int> writing{3};
  const auto write = [&](CacheDirectory& cache) {
    for (int i = 0; i < 100; ++i) cache.write(key_of(1), thing(1, kSize));
    --writing;
  };
  one.write(key_of(1), thing(1, kSize));
  std::thread first([&] { write(one); }), second([&] { write(other); }), third([&] { write(one); });
  int torn = 0;
  while (writing > 0) torn += one.read(key_of(1)) != thing(1, kSize);
  for (std::thread* thread : {&first, &second, &third}) thread->join();
  EXPECT_EQ(torn, 0);
  EXPECT_EQ(files().size(), 1u) << "nothing written aside is left";
}

}  // namespace
}  // namespace mirage::test
