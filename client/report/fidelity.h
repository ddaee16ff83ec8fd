#pragma once
// Fidelity: compares tiles with the mesh by the protocol of the field, beside the
// figures published for it. Writes fidelity.json and its section of the page.

#include "client/report/context.h"

namespace mirage {

/// Runs the part. It fails only if nothing can be measured at all; missing models become omissions.
Result<void> report_fidelity(Context& context);

}  // namespace mirage
