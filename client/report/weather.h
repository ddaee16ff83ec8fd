#pragma once
// Weather: sessions through ten kinds of weather: links that jitter, get thin or lose messages;
// slow servers; several kinds of scenes and paths; more than one seed. Writes weather.csv and its
// section of the page.

#include "client/report/context.h"

namespace mirage {

/// Runs the part. Runs that fail become omissions; a pixel beyond its bound is a failed check.
/// Errors as Context::open.
Result<void> report_weather(Context& context);

}  // namespace mirage
