// Tile store: budget, directory, and files that are not trusted.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "server/tile_store.h"

namespace mirage::test {
namespace {
namespace fs = std::filesystem;

TileId id_of(std::uint64_t n) { return {n * 0x9e3779b97f4a7c15ull, n}; }

StoredTilePtr make_stored(std::uint64_t n, std::uint32_t crop = 8) {
  Tile tile;
  tile.edge = 64;
  tile.crop = {2, 3, crop, crop};
  tile.measure = {4, 3.5f, 4.5f, 0.5f, 0.25f, 0.125f, 0.1f};
  for (std::size_t i = 0; i < tile.crop.area() * 4; ++i) {
    tile.rgba.push_back(static_cast<std::uint8_t>(i * 7 + n));
  }
  tile.depth.assign(tile.crop.area(), static_cast<std::uint8_t>(100 + n));
  auto stored = std::make_shared<StoredTile>();
  stored->planes = encode_tile_planes(tile, TileCodec::kRaw);
  set_tile_fields(tile, stored->reply);
  stored->reply.key_low = id_of(n).low;
  stored->reply.key_high = id_of(n).high;
  stored->reply.content_hash = tile_content_hash(tile);
  stored->reply.codec = static_cast<std::uint8_t>(TileCodec::kRaw);
  return stored;
}

/// Every field, as the bytes a client would get.
Bytes header_of(const StoredTile& tile) { return encode_message(wire::TileReplyT(tile.reply)); }

class ServerStore : public ::testing::Test {
 protected:
  ServerStore()
      : directory_(fs::temp_directory_path() /
                   ("mirage_store_" + std::to_string(::getpid()) + "_" +
                    ::testing::UnitTest::GetInstance()->current_test_info()->name())) {
    fs::create_directories(directory_);
  }
  ~ServerStore() override { fs::remove_all(directory_); }
  std::string directory() const { return directory_.string(); }
  /// The only file in the directory.
  fs::path only_file() const {
    fs::path found;
    int count = 0;
    for (const auto& entry : fs::recursive_directory_iterator(directory_)) {
      if (!entry.is_regular_file()) continue;
      found = entry.path();
      ++count;
    }
    EXPECT_EQ(count, 1);
    return found;
  }
  static Bytes read(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return Bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  }
  static void write(const fs::path& path, const Bytes& bytes) {
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  }

  static constexpr std::uint64_t kRoomy = 1u << 30;
  /// What a server that has ended left behind.
  void keep(const StoredTilePtr& tile, std::uint64_t n) {
    CacheDirectory cache(directory(), kRoomy);
    TileStore(1 << 20, &cache, counters).save(id_of(n), *tile);
  }
  /// What the next one finds.
  StoredTilePtr kept(std::uint64_t n) {
    CacheDirectory cache(directory(), kRoomy);
    return TileStore(1 << 20, &cache, counters).find(id_of(n));
  }

  Counters counters;

 private:
  const fs::path directory_;
};

TEST_F(ServerStore, LeastRecentlyUsedGoFirst) {
  const std::size_t one = make_stored(0)->bytes();
  TileStore store(3 * one, nullptr, counters);
  for (std::uint64_t n = 0; n < 3; ++n) store.put(id_of(n), make_stored(n));
  ASSERT_TRUE(store.find(id_of(0)));  // now the youngest
  store.put(id_of(3), make_stored(3));
  EXPECT_TRUE(store.find(id_of(0)));
  EXPECT_FALSE(store.find(id_of(1)));
  EXPECT_TRUE(store.find(id_of(2)));
  EXPECT_TRUE(store.find(id_of(3)));
  EXPECT_EQ(counters.store_bytes, 3 * one);
  EXPECT_EQ(counters.store_hits, 4u);
}

TEST_F(ServerStore, TheSameTileTwiceCountsOnce) {
  const std::size_t one = make_stored(0)->bytes();
  TileStore store(10 * one, nullptr, counters);
  store.put(id_of(1), make_stored(1));
  store.put(id_of(1), make_stored(1));
  EXPECT_EQ(counters.store_bytes, one);
}

TEST_F(ServerStore, BudgetIsKeptThroughManySizes) {
  const std::size_t budget = 20 * make_stored(0, 16)->bytes();
  TileStore store(budget, nullptr, counters);
  for (std::uint64_t n = 0; n < 500; ++n) {
    store.put(id_of(n), make_stored(n, 4 + static_cast<std::uint32_t>(n * 7 % 40)));
    ASSERT_LE(counters.store_bytes, budget);
    ASSERT_TRUE(store.find(id_of(n)));
  }
  // One larger than everything: kept alone, for the clients that wait for it.
  TileStore tiny(10, nullptr, counters);
  tiny.put(id_of(1), make_stored(1));
  EXPECT_TRUE(tiny.find(id_of(1)));
}

TEST_F(ServerStore, DirectoryOutlivesTheProcess) {
  const StoredTilePtr original = make_stored(5);
  keep(original, 5);
  CacheDirectory cache(directory(), kRoomy);
  TileStore store(1 << 20, &cache, counters);
  const StoredTilePtr found = store.find(id_of(5));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->planes, original->planes);
  EXPECT_EQ(header_of(*found), header_of(*original));
  EXPECT_EQ(store.find(id_of(5)), found) << "in memory now";
  EXPECT_FALSE(store.find(id_of(6)));
}

TEST_F(ServerStore, DamagedFilesAreRenderedAgain) {
  keep(make_stored(5), 5);
  const fs::path file = only_file();
  const Bytes whole = read(file);
  for (std::size_t cut = 0; cut < whole.size(); cut += 3) {
    write(file, Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(cut)));
    ASSERT_FALSE(kept(5)) << "cut at " << cut;
    ASSERT_FALSE(fs::exists(file)) << "made anew";
  }
  Bytes longer = whole;
  longer.push_back(0);
  write(file, longer);
  EXPECT_FALSE(kept(5));
  write(file, whole);
  EXPECT_TRUE(kept(5));
}

TEST_F(ServerStore, NoFlippedBitIsTakenForATile) {
  keep(make_stored(5), 5);
  const fs::path file = only_file();
  const Bytes whole = read(file);
  for (std::size_t i = 0; i < whole.size(); ++i) {
    Bytes damaged = whole;
    damaged[i] = static_cast<std::uint8_t>(damaged[i] ^ (1u << (i % 8)));
    write(file, damaged);
    ASSERT_FALSE(kept(5)) << "byte " << i;
  }
}

TEST_F(ServerStore, FileOfAnotherTileIsRefused) {
  keep(make_stored(5), 5);
  const Bytes other = read(only_file());
  fs::remove_all(only_file().parent_path());
  keep(make_stored(6), 6);
  write(only_file(), other);
  EXPECT_FALSE(kept(6));
}

TEST_F(ServerStore, DirectoryThatCannotBeWrittenIsNoError) {
  CacheDirectory cache("/proc/nowhere", kRoomy);
  TileStore store(1 << 20, &cache, counters);
  store.put(id_of(1), make_stored(1));
  store.save(id_of(1), *make_stored(1));
  EXPECT_TRUE(store.find(id_of(1)));
  EXPECT_FALSE(store.find(id_of(2)));
}

}  // namespace
}  // namespace mirage::test
