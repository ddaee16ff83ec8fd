#pragma once
#include "client/report/context.h"

namespace mirage {

/// Measures every tile codec on real tiles: bytes against the error of their colours, and the time
/// to encode and decode. Adds a heading to the fidelity part, and writes codecs.csv.
Result<void> report_codecs(Context& context);

}  // namespace mirage
