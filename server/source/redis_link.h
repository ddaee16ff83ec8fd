#pragma once
// One connection to a Redis server; every call ends within a time limit. Only redis_link.cpp
// includes hiredis.
// Thread: one at a time.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "protocol/base/bytes.h"
#include "protocol/base/result.h"
#include "server/source/store_url.h"

struct redisContext;
struct redisReply;

namespace mirage {

class RedisLink {
 public:
  /// Connects. This and every later call may take `limit_us`. Error kNetworkConnect.
  static Result<std::unique_ptr<RedisLink>> connect(const StoreAddress& address,
                                                    std::int64_t limit_us);
  ~RedisLink();

  // Any error of these calls, kNetworkTimeout or kNetworkClosed, makes the connection unusable.

  /// Returns the value of a key; nullopt if there is none.
  Result<std::optional<Bytes>> get(const std::string& key);
  Result<void> set(const std::string& key, const Bytes& value);
  /// Sets the key to `holder` for `life_ms` unless it is set. Returns its holder: `holder` or
  /// another.
  Result<std::string> hold(const std::string& key, const std::string& holder, std::int64_t life_ms);

 private:
  struct FreeReply {
    void operator()(redisReply* reply) const;
  };
  using Reply = std::unique_ptr<redisReply, FreeReply>;

  explicit RedisLink(redisContext* context) : context_(context) {}
  Result<Reply> checked(void* reply);

  redisContext* const context_;
};

}  // namespace mirage
