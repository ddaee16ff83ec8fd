#pragma once
// Tiles against the mesh by the protocol of the field (FIELD.md), beside the figures published for
// it. Writes fidelity.json and its section of the page.

#include "client/report/context.h"

namespace mirage {

/// An error only where nothing can be measured at all; models that are not there become omissions.
Result<void> report_fidelity(Context& context);

}  // namespace mirage
