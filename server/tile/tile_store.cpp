#include "server/tile/tile_store.h"

#include <algorithm>

namespace mirage {
namespace {

CacheKey file_of(const TileId& id, TileCodec codec) {
  const char* kind = "tile";
  if (codec == TileCodec::kWebp) kind = "webp-tile";
  return {id.high, id.low, kind};
}

}  // namespace

TileStore::TileStore(std::size_t budget_bytes, CacheDirectory* directory, Counters& counters)
    : directory_(directory), counters_(counters), budget_(budget_bytes) {}

StoredTilePtr TileStore::find_in_memory(const TileId& id, const std::vector<TileCodec>& codecs) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = slots_.find(id);
  if (found == slots_.end()) return nullptr;
  for (const TileCodec codec : codecs) {
    const StoredTilePtr& form = found->second.forms[static_cast<std::size_t>(codec)];
    if (!form) continue;
    budget_.touch(found->second.place);
    ++counters_.store_hits;
    return form;
  }
  return nullptr;
}

StoredTilePtr TileStore::find(const TileId& id, TileCodec codec) {
  return find_in_memory(id, {codec});
}

StoredTilePtr TileStore::find_lossless(const TileId& id) {
  return find_in_memory(id, {TileCodec::kZstd, TileCodec::kRaw});
}

FetchedTile TileStore::fetch(const TileId& id, TileCodec codec) {
  StoredTilePtr tile = load(id, codec);
  const bool as_asked =
      tile && (is_lossy(codec) || tile->reply.codec == static_cast<std::uint8_t>(codec));
  if (as_asked) {
    put(id, codec, tile);
    return {tile, nullptr};
  }
  if (is_lossy(codec)) tile = load(id, TileCodec::kZstd);
  if (tile) put(id, static_cast<TileCodec>(tile->reply.codec), tile);
  return {nullptr, tile};
}

void TileStore::put(const TileId& id, TileCodec codec, StoredTilePtr tile) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto [at, fresh] = slots_.try_emplace(id);
  Slot& slot = at->second;
  if (fresh) slot.place = budget_.add(id, 0);
  StoredTilePtr& form = slot.forms[static_cast<std::size_t>(codec)];
  if (form) return;
  const bool shared = std::find(slot.forms.begin(), slot.forms.end(), tile) != slot.forms.end();
  const std::size_t bytes = shared ? 0 : tile->bytes();
  form = std::move(tile);
  budget_.grow(slot.place, bytes);
  budget_.touch(slot.place);
  while (const std::optional<TileId> oldest = budget_.take_excess()) {
    slots_.erase(*oldest);
    ++counters_.store_evictions;
  }
  counters_.store_bytes = budget_.bytes();
  counters_.store_tiles = slots_.size();
}

StoredTilePtr TileStore::load(const TileId& id, TileCodec form) const {
  const std::optional<Bytes> bytes = directory_->read(file_of(id, form));
  if (!bytes) return nullptr;
  Result<Message> message = decode_message(bytes->data(), bytes->size());
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
  if (!directory_) return;
  wire::TileReplyT reply = tile.reply;
  directory_->write(file_of(id, codec), encode_message(std::move(reply), tile.planes));
}

}  // namespace mirage
