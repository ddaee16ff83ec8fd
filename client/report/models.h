#pragma once
#include "client/report/context.h"

namespace mirage {

/// Opens each glTF file of a folder with a server of its own. It looks at the model from its home
/// view at rest and around it, with all that a viewer uses and with impostors only. Writes a
/// section with the pictures, and `models.csv`. A file that is refused is a row, not an error.
/// Errors: kIo, kGraphics….
Result<void> report_models(Context& context);

}  // namespace mirage
