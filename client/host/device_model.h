#pragma once
// Device models: read by name, or from a file.

#include <string>

#include "client/price/cost_model.h"
#include "protocol/base/result.h"

namespace mirage {

/// Returns the model with a name of device_model_names(), or from a JSON file {"ms": {KIND: NUMBER,
/// …}}. The file has the price in ms of each kind of work (work_name), finite and >= 0, not all 0.
/// Error kUsage: it is neither; it says what is wrong with the file.
Result<CostModel> read_device_model(const std::string& name_or_file);

}  // namespace mirage
