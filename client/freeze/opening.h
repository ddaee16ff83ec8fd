#pragma once
// Opening: what a frozen folder tells first, made of what a server told.

#include "client/freeze/budget.h"
#include "protocol/base/result.h"

namespace mirage {

/// Returns the messages of frozen.bin: the catalogue of `kept`, the scene as `part` has it, and the
/// home view. The scene has no full renders, no choices and no ground to walk on, and geometry only
/// where a level of it is kept. Errors: those of decoding a message.
Result<std::vector<Bytes>> opening_of(const FrozenPart& part, const Kept& kept);

}  // namespace mirage
