#pragma once
// Tile source: a Redis server that many render servers share. A call may take 10 ms. After two slow
// calls in a row the server is left alone, first for 0.25 s and in the end for 5 s. Tiles are
// rendered here meanwhile.
//
// When several servers want the same tile at once, one of them renders it. It holds a lease,
// `mirage:lease:ID`, for twice the time that its last tiles took. The other servers look for the
// finished tile again.

#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

#include "protocol/base/clock.h"
#include "protocol/codec/tile_codec.h"
#include "server/source/redis_link.h"
#include "server/source/tile_source.h"

namespace mirage {

class RedisSource final : public TileSource {
 public:
  RedisSource(StoreAddress address, const Clock& clock);

  Tier tier() const override { return Tier::kRedis; }
  // 100 ms. Each call has its own shorter limit, so a later answer means that this machine is busy
  // rendering. Rendering a tile that exists would add to its load.
  std::int64_t patience_us() const override { return 100'000; }
  std::optional<Bytes> fetch(const FormId& id) override;
  bool offer(const FormId& id, const Bytes& record) override;
  bool claim(const TileId& id) override;

 private:
  bool write(const FormId& id, const Bytes& record);
  /// Returns an idle connection or a new one; nullptr while the server is left alone.
  std::unique_ptr<RedisLink> take();
  void give_back(std::unique_ptr<RedisLink> link);
  void failed(const Error& error);
  void note_made(const TileId& id);
  std::int64_t lease_ms();

  const StoreAddress address_;
  const Clock& clock_;
  const std::string name_;  ///< random name of this server as a holder of leases

  std::mutex mutex_;
  std::vector<std::unique_ptr<RedisLink>> idle_;
  std::int64_t alone_until_us_ = INT64_MIN;
  std::int64_t pause_us_ = 0;  ///< 0: the server answers
  int failures_ = 0;           ///< in a row
  std::unordered_map<TileId, std::int64_t> claimed_us_;
  std::array<std::int64_t, 128> made_us_{};  ///< times of the last tiles, from claim to offer, µs
  std::size_t made_ = 0;
};

}  // namespace mirage
