#include "client/host/device_model.h"

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

namespace mirage {
namespace {

std::string known_names() {
  std::string out;
  for (const std::string& name : device_model_names()) out += (out.empty() ? "" : ", ") + name;
  return out;
}

std::string kinds() {
  std::string out;
  for (std::size_t i = 0; i < kWorks; ++i) {
    out += (out.empty() ? "" : ", ") + std::string(work_name(static_cast<Work>(i)));
  }
  return out;
}

Result<double> price_of(const nlohmann::json& prices, const std::string& kind) {
  const auto at = prices.find(kind);
  if (at == prices.end()) return make_error(ErrorId::kUsage, "no price of '" + kind + "'");
  const double ms = at->is_number() ? at->get<double>() : NAN;
  if (std::isfinite(ms) && ms >= 0) return ms;
  return make_error(ErrorId::kUsage, "the price of '" + kind + "' is no time");
}

Result<CostModel> parsed(const nlohmann::json& file) {
  if (!file.is_object() || !file.contains("ms") || !file["ms"].is_object()) {
    return make_error(ErrorId::kUsage, "it is no JSON object with an object 'ms'");
  }
  CostModel model;
  double sum = 0;
  for (std::size_t i = 0; i < kWorks; ++i) {
    const Result<double> ms = price_of(file["ms"], work_name(static_cast<Work>(i)));
    if (!ms) return ms.error();
    model.ms[i] = *ms;
    sum += *ms;
  }
  if (file["ms"].size() != kWorks) {
    return make_error(ErrorId::kUsage, "it has a price of what is no kind of work");
  }
  if (sum > 0) return model;
  return make_error(ErrorId::kUsage, "all its prices are 0");
}

}  // namespace

Result<CostModel> read_device_model(const std::string& name_or_file) {
  if (const std::optional<CostModel> model = device_model(name_or_file)) return *model;
  std::ifstream file(name_or_file);
  if (!file) {
    return make_error(ErrorId::kUsage, "no device model '" + name_or_file + "'",
                      known_names() + ", or a file that can be read");
  }
  const nlohmann::json json = nlohmann::json::parse(file, nullptr, false);
  Result<CostModel> model = parsed(json);
  if (model) return model;
  return make_error(ErrorId::kUsage, "device model '" + name_or_file + "': " + model.error().text,
                    "{\"ms\": {KIND: MILLISECONDS, …}} of " + kinds());
}

}  // namespace mirage
