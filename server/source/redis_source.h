#pragma once
// Tile source: a Redis server that many render servers share. A call may take 10 ms; after two in a
// row that took longer it is left alone for a while that grows from a quarter of a second to five:
// tiles are rendered here meanwhile.
//
// Of servers that want the same tile at the same time one renders it: it holds a lease,
// `mirage:lease:ID`, for as long as its last tiles took, and the others look again.

#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

#include "protocol/base/clock.h"
#include "server/source/redis_link.h"
#include "server/source/tile_source.h"

namespace mirage {

class RedisSource final : public TileSource {
 public:
  RedisSource(StoreAddress address, const Clock& clock);

  Tier tier() const override { return Tier::kRedis; }
  // It has a limit of its own: what is late beyond that is this machine, whose renderer has all
  // cores, and rendering what is there already would only add to that.
  std::int64_t patience_us() const override { return 100'000; }
  std::optional<Bytes> fetch(const FormId& id) override;
  bool offer(const FormId& id, const Bytes& record) override;
  bool claim(const TileId& id) override;

 private:
  bool write(const FormId& id, const Bytes& record);
  /// A connection that nobody uses, or a new one; nullptr while the server is left alone.
  std::unique_ptr<RedisLink> take();
  void give_back(std::unique_ptr<RedisLink> link);
  void failed(const Error& error);
  void note_made(const TileId& id);
  std::int64_t lease_ms();

  const StoreAddress address_;
  const Clock& clock_;
  const std::string name_;  ///< of this server, as a holder of leases

  std::mutex mutex_;
  std::vector<std::unique_ptr<RedisLink>> idle_;
  std::int64_t alone_until_us_ = INT64_MIN;
  std::int64_t pause_us_ = 0;  ///< 0: it answers
  int failures_ = 0;           ///< in a row
  std::unordered_map<TileId, std::int64_t> claimed_us_;
  std::array<std::int64_t, 128> made_us_{};  ///< what the last tiles took, from claim to offer
  std::size_t made_ = 0;
};

}  // namespace mirage
