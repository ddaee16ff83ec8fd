// Tile store: budget, directory, and untrusted files.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "protocol/codec/tile_color.h"
#include "protocol/wire/conversions.h"
#include "protocol/wire/message.h"
#include "server/source/directory_source.h"
#include "server/tile/tile_form.h"
#include "server/tile/tile_store.h"
#include "tests/support/temp_folder.h"

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

/// Returns every field, as the bytes that a client would get.
Bytes header_of(const StoredTile& tile) { return encode_message(wire::TileReplyT(tile.reply)); }

class ServerStore : public ::testing::Test {
 protected:
  std::string directory() const { return folder_.path().string(); }
  /// Returns the only file in the directory.
  fs::path only_file() const {
    const std::vector<fs::path> files = folder_.files();
    EXPECT_EQ(files.size(), 1u);
    return files.empty() ? fs::path() : files[0];
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
  /// Leaves a tile behind in the directory, as a server that has ended.
  void keep(const StoredTilePtr& tile, std::uint64_t n) {
    CacheDirectory cache(directory(), kRoomy);
    DirectorySource source(cache);
    TileStore(1 << 20, {&source}, counters).save(id_of(n), TileCodec::kRaw, *tile);
  }
  /// Returns the tile that the next server finds there.
  StoredTilePtr kept(std::uint64_t n) {
    CacheDirectory cache(directory(), kRoomy);
    DirectorySource source(cache);
    return TileStore(1 << 20, {&source}, counters).fetch(id_of(n), TileCodec::kRaw).form;
  }

  Counters counters;

 private:
  const TempFolder folder_;
};

TEST_F(ServerStore, LeastRecentlyUsedGoFirst) {
  const std::size_t one = make_stored(0)->bytes();
  TileStore store(3 * one, {}, counters);
  for (std::uint64_t n = 0; n < 3; ++n) store.put(id_of(n), TileCodec::kRaw, make_stored(n));
  ASSERT_TRUE(store.find(id_of(0), TileCodec::kRaw));  // now the youngest
  store.put(id_of(3), TileCodec::kRaw, make_stored(3));
  EXPECT_TRUE(store.find(id_of(0), TileCodec::kRaw));
  EXPECT_FALSE(store.find(id_of(1), TileCodec::kRaw));
  EXPECT_TRUE(store.find(id_of(2), TileCodec::kRaw));
  EXPECT_TRUE(store.find(id_of(3), TileCodec::kRaw));
  EXPECT_EQ(counters.store_bytes, 3 * one);
  EXPECT_EQ(counters.store_hits, 4u);
}

TEST_F(ServerStore, TheSameTileTwiceCountsOnce) {
  const std::size_t one = make_stored(0)->bytes();
  TileStore store(10 * one, {}, counters);
  store.put(id_of(1), TileCodec::kRaw, make_stored(1));
  store.put(id_of(1), TileCodec::kRaw, make_stored(1));
  EXPECT_EQ(counters.store_bytes, one);
}

TEST_F(ServerStore, BudgetIsKeptThroughManySizes) {
  const std::size_t budget = 20 * make_stored(0, 16)->bytes();
  TileStore store(budget, {}, counters);
  for (std::uint64_t n = 0; n < 500; ++n) {
    store.put(id_of(n), TileCodec::kRaw,
              make_stored(n, 4 + static_cast<std::uint32_t>(n * 7 % 40)));
    ASSERT_LE(counters.store_bytes, budget);
    ASSERT_TRUE(store.find(id_of(n), TileCodec::kRaw));
  }
  // A tile larger than the whole budget is kept alone, for the clients that wait for it.
  TileStore tiny(10, {}, counters);
  tiny.put(id_of(1), TileCodec::kRaw, make_stored(1));
  EXPECT_TRUE(tiny.find(id_of(1), TileCodec::kRaw));
}

TEST_F(ServerStore, DirectoryOutlivesTheProcess) {
  const StoredTilePtr original = make_stored(5);
  keep(original, 5);
  CacheDirectory cache(directory(), kRoomy);
  DirectorySource source(cache);
  TileStore store(1 << 20, {&source}, counters);
  EXPECT_FALSE(store.find(id_of(5), TileCodec::kRaw)) << "not in memory yet";
  const StoredTilePtr found = store.fetch(id_of(5), TileCodec::kRaw).form;
  ASSERT_TRUE(found);
  EXPECT_EQ(found->planes, original->planes);
  EXPECT_EQ(header_of(*found), header_of(*original));
  EXPECT_EQ(store.find(id_of(5), TileCodec::kRaw), found) << "in memory now";
  EXPECT_FALSE(store.fetch(id_of(6), TileCodec::kRaw).form);
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

// A tile with smooth colours under a margin without coverage, like a rendered one.
StoredTilePtr rendered_tile(std::uint64_t n) {
  Tile tile;
  tile.edge = 128;
  tile.crop = {0, 0, 100, 80};
  tile.measure = {4, 3.5f, 4.5f, 0.5f, 0.25f, 0.125f, 0.1f};
  for (std::uint32_t y = 0; y < tile.crop.h; ++y) {
    for (std::uint32_t x = 0; x < tile.crop.w; ++x) {
      const bool inside = x > 2 && y > 2;
      const std::uint32_t grain = ((x * 977 + y) * 2654435761u >> 24) % 16;
      for (const std::uint32_t c : {x + y + grain, x + grain / 2, 200 - grain}) {
        tile.rgba.push_back(inside ? static_cast<std::uint8_t>(c) : std::uint8_t{0});
      }
      tile.rgba.push_back(inside ? 255 : 0);
      tile.depth.push_back(inside ? static_cast<std::uint8_t>(90 + x / 2) : std::uint8_t{0});
    }
  }
  wire::TileReplyT fields;
  fields.key_low = id_of(n).low;
  fields.key_high = id_of(n).high;
  return make_form(tile, fields, TileCodec::kZstd);
}

Tile decoded(const StoredTile& stored) {
  Tile tile = tile_from_fields(stored.reply).take();
  const auto codec = static_cast<TileCodec>(stored.reply.codec);
  EXPECT_TRUE(decode_tile_planes(stored.planes.data(), stored.planes.size(), codec, tile));
  return tile;
}

TEST(ServerForm, ErrorAndHashAreOfWhatComesOut) {
  const StoredTilePtr zstd = rendered_tile(1);
  const Tile original = decoded(*zstd);
  EXPECT_EQ(zstd->reply.color_rms, 0);
  const StoredTilePtr form = make_form(original, zstd->reply, TileCodec::kWebp);
  ASSERT_TRUE(form);
  ASSERT_EQ(form->reply.codec, static_cast<std::uint8_t>(TileCodec::kWebp));
  const Tile back = decoded(*form);
  const ColorError error = color_error(original.rgba, back.rgba);
  EXPECT_GT(error.max, 0);
  EXPECT_EQ(form->reply.color_rms, error.rms);
  EXPECT_EQ(form->reply.color_max, error.max);
  EXPECT_EQ(form->reply.content_hash, tile_content_hash(back));
  EXPECT_EQ(back.depth, original.depth);
  EXPECT_EQ(form->reply.key_low, zstd->reply.key_low);
  const StoredTilePtr raw = convert_form(zstd, TileCodec::kRaw);
  EXPECT_EQ(raw->reply.content_hash, zstd->reply.content_hash);
  EXPECT_EQ(decoded(*raw).rgba, original.rgba);
}

TEST(ServerForm, WhereLossSavesNothingThereIsNone) {
  Tile flat = decoded(*rendered_tile(1));
  std::fill(flat.rgba.begin(), flat.rgba.end(), std::uint8_t{255});
  std::fill(flat.depth.begin(), flat.depth.end(), std::uint8_t{90});
  const StoredTilePtr zstd = make_form(flat, {}, TileCodec::kZstd);
  EXPECT_EQ(convert_form(zstd, TileCodec::kWebp), zstd);
  // Tiles that are kept raw are converted as well, because not every client takes them.
  const StoredTilePtr raw = make_form(flat, {}, TileCodec::kRaw);
  EXPECT_EQ(convert_form(raw, TileCodec::kWebp)->planes, zstd->planes);
}

TEST_F(ServerStore, FormsAreApartAndGoTogether) {
  const StoredTilePtr zstd = rendered_tile(1), webp = convert_form(zstd, TileCodec::kWebp);
  TileStore store(10 * zstd->bytes(), {}, counters);
  store.put(id_of(1), TileCodec::kZstd, zstd);
  EXPECT_FALSE(store.find(id_of(1), TileCodec::kWebp));
  EXPECT_EQ(store.find_lossless(id_of(1)), zstd);
  store.put(id_of(1), TileCodec::kWebp, webp);
  EXPECT_EQ(store.find(id_of(1), TileCodec::kWebp), webp);
  EXPECT_EQ(counters.store_bytes, zstd->bytes() + webp->bytes());
  store.put(id_of(1), TileCodec::kRaw, zstd);  // the same bytes, counted once
  EXPECT_EQ(store.find(id_of(1), TileCodec::kRaw), zstd);
  EXPECT_EQ(counters.store_bytes, zstd->bytes() + webp->bytes());
  for (std::uint64_t n = 2; n < 12; ++n) store.put(id_of(n), TileCodec::kZstd, rendered_tile(n));
  EXPECT_FALSE(store.find(id_of(1), TileCodec::kWebp));
  EXPECT_FALSE(store.find_lossless(id_of(1)));
  EXPECT_LE(counters.store_bytes, 10 * zstd->bytes());
}

TEST_F(ServerStore, DirectoryKeepsLossyFormsBesideTheOneWithoutLoss) {
  const StoredTilePtr zstd = rendered_tile(1), webp = convert_form(zstd, TileCodec::kWebp);
  CacheDirectory cache(directory(), kRoomy);
  DirectorySource source(cache);
  {
    const TileStore store(1 << 20, {&source}, counters);
    store.save(id_of(1), TileCodec::kZstd, *zstd);
    store.save(id_of(1), TileCodec::kWebp, *webp);
  }
  TileStore store(1 << 20, {&source}, counters);
  ASSERT_TRUE(store.fetch(id_of(1), TileCodec::kWebp).form);
  EXPECT_EQ(store.find(id_of(1), TileCodec::kWebp)->planes, webp->planes);
  const FetchedTile raw = store.fetch(id_of(1), TileCodec::kRaw);
  EXPECT_FALSE(raw.form) << "to be made";
  ASSERT_TRUE(raw.lossless);
  EXPECT_EQ(raw.lossless->planes, zstd->planes);
  EXPECT_EQ(store.find_lossless(id_of(1)), raw.lossless);
  // A lossy file in the place of the other never passes for the tile itself.
  for (const auto& entry : fs::recursive_directory_iterator(directory())) {
    const std::string name = entry.path().string();
    const std::size_t at = name.find(".webp-tile");
    if (at == std::string::npos) continue;
    write(name.substr(0, at) + ".tile", read(entry.path()));
  }
  EXPECT_FALSE(TileStore(1 << 20, {&source}, counters).fetch(id_of(1), TileCodec::kZstd).form);
}

TEST_F(ServerStore, DirectoryThatCannotBeWrittenIsNoError) {
  CacheDirectory cache("/proc/nowhere", kRoomy);
  DirectorySource source(cache);
  TileStore store(1 << 20, {&source}, counters);
  store.put(id_of(1), TileCodec::kRaw, make_stored(1));
  store.save(id_of(1), TileCodec::kRaw, *make_stored(1));
  EXPECT_TRUE(store.find(id_of(1), TileCodec::kRaw));
  EXPECT_FALSE(store.fetch(id_of(2), TileCodec::kRaw).form);
}

// Opening a pipe for reading waits for a writer, for ever.
TEST_F(ServerStore, APipeInTheDirectoryIsNoFileAndHoldsUpNobody) {
  keep(make_stored(5), 5);
  const fs::path file = only_file();
  fs::remove(file);
  ASSERT_EQ(mkfifo(file.c_str(), 0600), 0);
  EXPECT_FALSE(kept(5));
}

}  // namespace
}  // namespace mirage::test
