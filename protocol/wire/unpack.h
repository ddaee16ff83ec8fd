#pragma once
// What takes long of taking a message in, done beforehand: by a link that has a thread to spare, so
// that the frame that takes the message only copies.

#include "protocol/wire/message.h"

namespace mirage {

/// Of a tile the planes become raw, of geometry and reference frames the block is decompressed, of
/// an image and a view the colours become RGBA; other messages stay as they are. `payload_bytes`
/// stays what it was. Takes hostile bytes: sizes are held against limits before anything is
/// allocated. Errors: those of taking the message in.
Result<void> unpack(Message& message);

}  // namespace mirage
