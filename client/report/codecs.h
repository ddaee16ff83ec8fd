#pragma once
#include "client/report/context.h"

namespace mirage {

/// What every tile codec makes of real tiles: bytes against the error of their colours, time to
/// encode and decode. A heading of the fidelity part; rows in codecs.csv.
Result<void> report_codecs(Context& context);

}  // namespace mirage
