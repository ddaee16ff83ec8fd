#include "client/link/net_model.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>

namespace mirage {
namespace {

constexpr double kRetransmission = 1.5;  // round trips a lost message costs

}  // namespace

Result<NetModel> parse_net_model(const std::string& text) {
  NetModel model;
  std::istringstream in(text);
  std::string part;
  while (std::getline(in, part, ',')) {
    const std::size_t equals = part.find('=');
    const std::string key = part.substr(0, equals);
    const std::string value = equals == std::string::npos ? "" : part.substr(equals + 1);
    if (key == "server-ms" && value == "auto") {
      model.server_ms = -1;
      continue;
    }
    char* end = nullptr;
    const double number = std::strtod(value.c_str(), &end);
    const bool good = !value.empty() && *end == '\0' && number >= 0 && number <= 1e7;
    double* target = key == "rtt"         ? &model.rtt_ms
                     : key == "jitter"    ? &model.jitter_ms
                     : key == "rate"      ? &model.rate_mbps
                     : key == "loss"      ? &model.loss_percent
                     : key == "server-ms" ? &model.server_ms
                                          : nullptr;
    if (good && key == "seed") {
      model.seed = static_cast<std::uint64_t>(number);
    } else if (good && target && !(key == "loss" && number > 90)) {
      *target = number;
    } else {
      return make_error(ErrorId::kUsage, "--net: '" + part + "' is not understood",
                        "rtt=100,jitter=20,rate=20,loss=0.5,server-ms=auto|5,seed=1 "
                        "(ms, ms, Mbit/s, %, ms)");
    }
  }
  return model;
}

NetDelays::NetDelays(const NetModel& model)
    : model_(model), random_(model.seed * 0x9e3779b97f4a7c15ull + 1) {}

double NetDelays::uniform() {  // splitmix64
  random_ += 0x9e3779b97f4a7c15ull;
  std::uint64_t z = random_;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1.0p-53;
}

std::int64_t NetDelays::one_way_us() {
  double ms = 0.5 * model_.rtt_ms;
  if (model_.jitter_ms > 0) {  // the sum of four uniform values is close enough to a normal one
    const double z = (uniform() + uniform() + uniform() + uniform() - 2.0) * 1.7320508;
    ms = std::max(0.0, ms + z * model_.jitter_ms);
  }
  if (model_.loss_percent > 0) {
    while (uniform() * 100.0 < model_.loss_percent) ms += kRetransmission * model_.rtt_ms;
  }
  return static_cast<std::int64_t>(std::llround(ms * 1000.0));
}

std::int64_t NetDelays::transmission_us(std::size_t bytes) const {
  if (model_.rate_mbps <= 0) return 0;
  return std::llround(static_cast<double>(bytes) * 8.0 / model_.rate_mbps);
}

}  // namespace mirage
