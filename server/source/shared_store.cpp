#include "server/source/shared_store.h"

#ifdef MIRAGE_REDIS
#include "server/source/redis_source.h"
#endif

namespace mirage {

Result<std::unique_ptr<TileSource>> open_shared_store([[maybe_unused]] const StoreAddress& address,
                                                      [[maybe_unused]] const Clock& clock) {
#ifdef MIRAGE_REDIS
  auto source = std::make_unique<RedisSource>(address, clock);
  for (int i = 0; i < 2; ++i) source->fetch({});  // logs a warning if it does not answer
  return std::unique_ptr<TileSource>(std::move(source));
#else
  return make_error(ErrorId::kUsage, "--store: this build has no Redis",
                    "install libhiredis-dev and configure anew");
#endif
}

}  // namespace mirage
