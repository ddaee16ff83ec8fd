#include "protocol/base/order.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mirage {

std::vector<std::size_t> ascending(const std::vector<double>& keys) {
  // A NaN compares with nothing, which no sorting bears. Places are part of what is compared, so
  // equal keys keep their order.
  std::vector<std::pair<double, std::size_t>> ranked(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i) {
    ranked[i] = {std::isnan(keys[i]) ? std::numeric_limits<double>::infinity() : keys[i], i};
  }
  std::sort(ranked.begin(), ranked.end());
  std::vector<std::size_t> out(keys.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = ranked[i].second;
  return out;
}

}  // namespace mirage
