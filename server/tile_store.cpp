#include "server/tile_store.h"

#include <spdlog/fmt/fmt.h>
#include <xxhash.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace mirage {
namespace fs = std::filesystem;

TileStore::TileStore(std::size_t budget_bytes, std::string directory, Counters& counters)
    : budget_(budget_bytes), directory_(std::move(directory)), counters_(counters) {}

StoredTilePtr TileStore::find_in_memory(const TileId& id, const std::vector<TileCodec>& codecs) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = slots_.find(id);
  if (found == slots_.end()) return nullptr;
  for (const TileCodec codec : codecs) {
    const StoredTilePtr& form = found->second.forms[static_cast<std::size_t>(codec)];
    if (!form) continue;
    ages_.splice(ages_.begin(), ages_, found->second.age);
    ++counters_.store_hits;
    return form;
  }
  return nullptr;
}

StoredTilePtr TileStore::find(const TileId& id, TileCodec codec) {
  if (StoredTilePtr form = find_in_memory(id, {codec})) return form;
  if (directory_.empty()) return nullptr;
  StoredTilePtr tile = load(id, codec);
  if (!tile || (!is_lossy(codec) && tile->reply.codec != static_cast<std::uint8_t>(codec))) {
    return nullptr;
  }
  ++counters_.store_hits;
  put_in_memory(id, codec, tile);
  return tile;
}

StoredTilePtr TileStore::find_lossless(const TileId& id) {
  const std::vector<TileCodec> lossless = {TileCodec::kZstd, TileCodec::kLz4, TileCodec::kRaw};
  if (StoredTilePtr form = find_in_memory(id, lossless)) return form;
  if (directory_.empty()) return nullptr;
  StoredTilePtr tile = load(id, TileCodec::kZstd);
  if (!tile) return nullptr;
  ++counters_.store_hits;
  put_in_memory(id, static_cast<TileCodec>(tile->reply.codec), tile);
  return tile;
}

void TileStore::put(const TileId& id, TileCodec codec, StoredTilePtr tile) {
  if (!directory_.empty()) save(id, codec, *tile);
  put_in_memory(id, codec, std::move(tile));
}

void TileStore::put_in_memory(const TileId& id, TileCodec codec, StoredTilePtr tile) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto [at, fresh] = slots_.try_emplace(id);
  Slot& slot = at->second;
  if (fresh) {
    ages_.push_front(id);
    slot.age = ages_.begin();
  }
  StoredTilePtr& form = slot.forms[static_cast<std::size_t>(codec)];
  if (form) return;
  const bool shared = std::find(slot.forms.begin(), slot.forms.end(), tile) != slot.forms.end();
  const std::size_t bytes = shared ? 0 : tile->bytes();
  form = std::move(tile);
  slot.bytes += bytes;
  bytes_ += bytes;
  ages_.splice(ages_.begin(), ages_, slot.age);
  while (bytes_ > budget_ && ages_.size() > 1) {
    const auto oldest = slots_.find(ages_.back());
    bytes_ -= oldest->second.bytes;
    slots_.erase(oldest);
    ages_.pop_back();
  }
  counters_.store_bytes = bytes_;
}

std::string TileStore::path(const TileId& id, TileCodec codec) const {
  const std::string name = fmt::format("{:016x}{:016x}", id.high, id.low);
  const std::string form = is_lossy(codec) ? std::string(".") + codec_name(codec) : "";
  return directory_ + "/" + name.substr(0, 2) + "/" + name + form + ".tile";
}

StoredTilePtr TileStore::load(const TileId& id, TileCodec form) const {
  std::ifstream file(path(id, form), std::ios::binary);
  if (!file) return nullptr;
  Bytes bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  // A file is as little trusted as the network: a damaged one is rendered again.
  std::uint64_t checksum = 0;
  if (bytes.size() < sizeof(checksum)) return nullptr;
  std::memcpy(&checksum, &bytes[bytes.size() - sizeof(checksum)], sizeof(checksum));
  bytes.resize(bytes.size() - sizeof(checksum));
  if (XXH3_64bits(bytes.data(), bytes.size()) != checksum) return nullptr;
  Result<Message> message = decode_message(bytes.data(), bytes.size());
  if (!message || message->body.AsTileReply() == nullptr) return nullptr;
  const wire::TileReplyT& reply = *message->body.AsTileReply();
  Result<Tile> tile = tile_from_fields(reply);
  if (!tile || reply.key_low != id.low || reply.key_high != id.high) return nullptr;
  const auto codec = static_cast<TileCodec>(reply.codec);
  const Bytes& planes = message->payload;
  if (is_lossy(codec) && codec != form) return nullptr;
  if (!decode_tile_planes(planes.data(), planes.size(), codec, *tile)) return nullptr;
  if (tile_content_hash(*tile) != reply.content_hash) return nullptr;
  auto stored = std::make_shared<StoredTile>();
  stored->reply = reply;
  stored->planes = message->payload;
  return stored;
}

void TileStore::save(const TileId& id, TileCodec codec, const StoredTile& tile) const {
  std::error_code ignored;
  const std::string target = path(id, codec);
  if (fs::exists(target, ignored) && load(id, codec)) return;  // the first form stays
  fs::create_directories(fs::path(target).parent_path(), ignored);
  wire::TileReplyT reply = tile.reply;
  const Bytes bytes = encode_message(std::move(reply), tile.planes);
  // Written aside and renamed, so that a reader never sees half a tile.
  const std::string aside = target + ".part";
  std::ofstream file(aside, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  // Over all of it: the content hash covers the pixels, not the measures the bound is made of.
  const std::uint64_t checksum = XXH3_64bits(bytes.data(), bytes.size());
  file.write(reinterpret_cast<const char*>(&checksum), sizeof(checksum));
  file.close();
  if (file) fs::rename(aside, target, ignored);
}

}  // namespace mirage
