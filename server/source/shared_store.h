#pragma once
// The store that servers share, if one is configured.

#include <memory>

#include "protocol/base/clock.h"
#include "protocol/base/result.h"
#include "server/source/store_url.h"
#include "server/source/tile_source.h"

namespace mirage {

/// Opens the store. One that does not answer is left alone until it does, with a warning. Error
/// kUsage: this build has no Redis. The clock must outlive the source.
Result<std::unique_ptr<TileSource>> open_shared_store(const StoreAddress& address,
                                                      const Clock& clock);

}  // namespace mirage
