#pragma once
// Sessions through ten kinds of weather: links that shake, thin out, lose; slow servers; scenes
// and paths of several kinds; more than one seed. Writes weather.csv and its section of the page.

#include "client/report/context.h"

namespace mirage {

/// Runs that fail become omissions; a pixel beyond its bound is a failed check. Errors as
/// Context::open.
Result<void> report_weather(Context& context);

}  // namespace mirage
