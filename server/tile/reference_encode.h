#pragma once
#include "protocol/base/bytes.h"
#include "server/tile/tile_job.h"

namespace mirage {

/// Whole reply message: the planes of the frame, one after the other, zstd.
Bytes encode_reference(RenderedReference&& drawn);

/// The answer that there is none, since there is no room for it.
FinishedReference refused_reference(SessionId session, std::uint32_t request_id);

}  // namespace mirage
