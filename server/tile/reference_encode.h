#pragma once
#include "protocol/base/bytes.h"
#include "server/tile/tile_job.h"

namespace mirage {

/// Returns the whole reply message: the planes of the frame, one after the other, as zstd.
Bytes encode_reference(RenderedReference&& drawn);

/// Returns the answer that refuses a full render for lack of room.
FinishedReference refused_reference(SessionId session, std::uint32_t request_id);

}  // namespace mirage
