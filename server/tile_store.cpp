#include "server/tile_store.h"

namespace mirage {
namespace {
constexpr const char* kKind = "tile";
}  // namespace

TileStore::TileStore(std::size_t budget_bytes, CacheDirectory* directory, Counters& counters)
    : budget_(budget_bytes), directory_(directory), counters_(counters) {}

StoredTilePtr TileStore::find(const TileId& id) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = slots_.find(id);
    if (found != slots_.end()) {
      ages_.splice(ages_.begin(), ages_, found->second.age);
      ++counters_.store_hits;
      return found->second.tile;
    }
  }
  if (!directory_) return nullptr;
  StoredTilePtr tile = load(id);
  if (tile) {
    ++counters_.store_hits;
    put(id, tile);
  }
  return tile;
}

void TileStore::put(const TileId& id, StoredTilePtr tile) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (slots_.count(id) != 0) return;
  bytes_ += tile->bytes();
  ages_.push_front(id);
  slots_[id] = {std::move(tile), ages_.begin()};
  while (bytes_ > budget_ && ages_.size() > 1) {
    const auto oldest = slots_.find(ages_.back());
    bytes_ -= oldest->second.tile->bytes();
    slots_.erase(oldest);
    ages_.pop_back();
  }
  counters_.store_bytes = bytes_;
}

StoredTilePtr TileStore::load(const TileId& id) const {
  const std::optional<Bytes> bytes = directory_->read({id.high, id.low, kKind});
  if (!bytes) return nullptr;
  Result<Message> message = decode_message(bytes->data(), bytes->size());
  if (!message || message->body.AsTileReply() == nullptr) return nullptr;
  const wire::TileReplyT& reply = *message->body.AsTileReply();
  Result<Tile> tile = tile_from_fields(reply);
  if (!tile || reply.key_low != id.low || reply.key_high != id.high) return nullptr;
  const auto codec = static_cast<TileCodec>(reply.codec);
  const Bytes& planes = message->payload;
  if (!decode_tile_planes(planes.data(), planes.size(), codec, *tile)) return nullptr;
  if (tile_content_hash(*tile) != reply.content_hash) return nullptr;
  auto stored = std::make_shared<StoredTile>();
  stored->reply = reply;
  stored->planes = message->payload;
  return stored;
}

void TileStore::save(const TileId& id, const StoredTile& tile) const {
  if (!directory_) return;
  wire::TileReplyT reply = tile.reply;
  directory_->write({id.high, id.low, kKind}, encode_message(std::move(reply), tile.planes));
}

}  // namespace mirage
