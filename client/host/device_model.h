#pragma once
// Device models by name or from a file.

#include <string>

#include "client/price/cost_model.h"
#include "protocol/base/result.h"

namespace mirage {

/// One of device_model_names(), or a JSON file {"ms": {KIND: NUMBER, …}} with the price of each
/// kind of work (work_name) in ms, finite and >= 0, not all 0. Error kUsage: it is neither; says
/// what is wrong with the file.
Result<CostModel> read_device_model(const std::string& name_or_file);

}  // namespace mirage
