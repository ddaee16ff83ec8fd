#pragma once
#include "protocol/base/bytes.h"
#include "server/tile/tile_job.h"

namespace mirage {

/// Whole reply message: the planes of the frame, one after the other, zstd.
Bytes encode_reference(RenderedReference&& drawn);

}  // namespace mirage
