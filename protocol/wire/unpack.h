#pragma once
// Unpacks the slow parts of a message ahead of time. A link with a spare thread does it, so that
// the frame that takes the message only copies.

#include "protocol/wire/message.h"

namespace mirage {

/// Unpacks a message: planes of a tile become raw, the block of geometry and reference frames is
/// decompressed, colours of an image and a view become RGBA. Other messages stay unchanged, and so
/// does `payload_bytes`. Takes hostile bytes: sizes are checked against limits before anything is
/// allocated. Errors: those of decoding the message.
Result<void> unpack(Message& message);

}  // namespace mirage
