// Codec benchmarks: the cost of each tile codec beside zstd: bytes, encoding, decoding, and the
// error of its colours.
#include <spdlog/fmt/fmt.h>

#include "protocol/codec/tile_codec.h"
#include "protocol/codec/tile_color.h"
#include "protocol/wire/conversions.h"
#include "tests/bench/bench.h"
#include "tests/bench/stages.h"

namespace mirage::bench {
namespace {

constexpr std::size_t kTiles = 64;

Result<std::vector<Tile>> tiles_of_scene(const std::string& name, std::uint32_t edge) {
  Result<std::shared_ptr<const PreparedScene>> scene = load_scene(name);
  if (!scene) return scene.error();
  Stages stages;
  if (const Result<void> started = stages.start(*scene); !started) return started.error();
  std::uint32_t serial = 0;
  std::vector<Tile> out;
  for (const StoredTilePtr& stored : stages.make(tiles_of(**scene, kTiles, edge, serial))) {
    Result<Tile> tile = tile_from_fields(stored->reply);
    if (!tile) return tile.error();
    const auto codec = static_cast<TileCodec>(stored->reply.codec);
    const Result<void> decoded =
        decode_tile_planes(stored->planes.data(), stored->planes.size(), codec, *tile);
    if (!decoded) return decoded.error();
    out.push_back(tile.take());
  }
  return out;
}

struct Encoded {
  std::vector<std::vector<std::uint8_t>> tiles;
  std::size_t bytes = 0;
  double squares = 0;  ///< mean of the tiles' mean squared colour errors
};

void decode_all(const std::vector<Tile>& tiles, const Encoded& encoded, TileCodec codec,
                std::vector<Tile>& out) {
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    const std::vector<std::uint8_t>& bytes = encoded.tiles[i];
    if (!decode_tile_planes(bytes.data(), bytes.size(), codec, out[i])) std::abort();
  }
}

Encoded encode_all(const std::vector<Tile>& tiles, TileCodec codec) {
  Encoded out;
  for (const Tile& tile : tiles) {
    out.tiles.push_back(encode_tile_planes(tile, codec));
    out.bytes += out.tiles.back().size();
  }
  return out;
}

std::string quality_of(const std::vector<Tile>& tiles, const Encoded& encoded, TileCodec codec) {
  if (!is_lossy(codec)) return "exact";
  std::vector<Tile> decoded = tiles;
  decode_all(tiles, encoded, codec, decoded);
  double squares = 0;
  int worst = 0;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    const ColorError error = color_error(tiles[i].rgba, decoded[i].rgba);
    squares += double{error.rms} * error.rms / static_cast<double>(tiles.size());
    worst = std::max<int>(worst, error.max);
  }
  return fmt::format("covered colours {:.1f} dB, at worst {} of 255 off",
                     10 * std::log10(255.0 * 255.0 / squares), worst);
}

Result<std::vector<Row>> codecs(const Conditions& conditions) {
  std::vector<Row> rows;
  const int rounds = conditions.quick ? 5 : 15;
  for (const std::string scene : {"forest?trees=60", "clutter"}) {
    for (const std::uint32_t edge : {32u, 128u}) {
      const Result<std::vector<Tile>> tiles = tiles_of_scene("builtin:" + scene, edge);
      if (!tiles) return tiles.error();
      const Encoded zstd = encode_all(*tiles, TileCodec::kZstd);
      const auto per_tile = [&](double all) { return all / static_cast<double>(tiles->size()); };
      for (const TileCodec codec : kTileCodecs) {
        if (codec == TileCodec::kZstd) continue;
        const std::string what = fmt::format(
            "{} of {} texels, {}", scene.substr(0, scene.find('?')), edge, codec_name(codec));
        const Encoded encoded = encode_all(*tiles, codec);
        std::vector<Tile> decoded = *tiles;
        const Pair encoding = in_turn(
            Time::kCpu, rounds, [&] { encode_all(*tiles, codec); },
            [&] { encode_all(*tiles, TileCodec::kZstd); });
        const Pair decoding = in_turn(
            Time::kCpu, rounds, [&] { decode_all(*tiles, encoded, codec, decoded); },
            [&] { decode_all(*tiles, zstd, TileCodec::kZstd, decoded); });
        const auto bytes = [&](const Encoded& e) {
          return fmt::format("{:.0f} bytes", per_tile(static_cast<double>(e.bytes)));
        };
        const auto us = [&](double s) { return fmt::format("{:.0f} us", 1e6 * per_tile(s)); };
        rows.push_back({what + ", a tile", bytes(encoded), "zstd: " + bytes(zstd),
                        static_cast<double>(zstd.bytes) / static_cast<double>(encoded.bytes), "",
                        true, std::nullopt, quality_of(*tiles, encoded, codec)});
        rows.push_back({what + ", encoding", us(encoding.ours_s), "zstd: " + us(encoding.beside_s),
                        encoding.ratio, "", true, encoding.spread_pct});
        rows.push_back({what + ", decoding", us(decoding.ours_s), "zstd: " + us(decoding.beside_s),
                        decoding.ratio, "", true, decoding.spread_pct});
      }
    }
  }
  return rows;
}

}  // namespace

std::vector<Bench> codec_benches() {
  return {{"codecs", "bytes and time of every tile codec beside zstd", codecs}};
}

}  // namespace mirage::bench
