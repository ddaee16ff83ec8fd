#include "server/tile/tile_store.h"

#include <algorithm>

#include "protocol/wire/conversions.h"
#include "protocol/wire/message.h"
#include "server/source/tile_source.h"

namespace mirage {
namespace {

// Reads the record of a source, which is the reply's message. It holds the id, which represents the
// whole key, and the hash of the decoded tile. Returns nullptr if it is no tile of `id` in this
// form.
StoredTilePtr read_record(const Bytes& record, const TileId& id, TileCodec form) {
  Result<Message> message = decode_message(record.data(), record.size());
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

}  // namespace

TileStore::TileStore(std::size_t budget_bytes, TileSources sources, Counters& counters)
    : sources_(std::move(sources)), counters_(counters), budget_(budget_bytes) {}

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
  for (TileSource* const source : sources_) {
    const std::optional<Bytes> record = source->fetch({id, form});
    if (!record) continue;
    if (StoredTilePtr tile = read_record(*record, id, form)) {
      ++(source->tier() == TileSource::Tier::kRedis ? counters_.shared_store_hits
                                                    : counters_.directory_hits);
      return tile;
    }
    ++counters_.records_wrong;  // the tile is rendered again and replaces the record
  }
  return nullptr;
}

std::int64_t TileStore::patience_us() const {
  std::int64_t out = 0;
  for (const TileSource* const source : sources_) out = std::max(out, source->patience_us());
  return out;
}

bool TileStore::claim(const TileId& id) {
  return std::all_of(sources_.begin(), sources_.end(),
                     [&](TileSource* source) { return source->claim(id); });
}

void TileStore::save(const TileId& id, TileCodec codec, const StoredTile& tile) const {
  if (sources_.empty()) return;
  const Bytes record = encode_message(wire::TileReplyT(tile.reply), tile.planes);
  for (TileSource* const source : sources_) {
    if (!source->offer({id, codec}, record)) ++counters_.tiles_not_saved;
  }
}

}  // namespace mirage
