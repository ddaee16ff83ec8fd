#include "client/price/server_work.h"

#include <algorithm>

#include "protocol/impostor/tile_key.h"

namespace mirage {
namespace {

// First guess: a fixed time, and that of 128 x 128 texels. The fit finds factors of both.
constexpr double kFixedUs = 2000, kTexelsUs = 2000, kTexels = 128 * 128;
constexpr std::int64_t kLongestUs = 10'000'000;

RunningFit<2>::Row row_of(std::uint8_t size_class) {
  const double edge = tile_edge(size_class);
  return {kFixedUs, kTexelsUs * edge * edge / kTexels};
}

}  // namespace

void ServerWork::arrived(std::uint8_t size_class, std::int64_t us) {
  const auto took = static_cast<double>(std::clamp<std::int64_t>(us, 1, kLongestUs));
  RunningFit<2>::Row row = row_of(size_class);
  for (double& part : row) part /= took;
  fit_.add(row, 1, 1);
}

double ServerWork::expected_us(std::uint8_t size_class) const {
  const RunningFit<2>::Row row = row_of(size_class);
  return row[0] * fit_.factors()[0] + row[1] * fit_.factors()[1];
}

}  // namespace mirage
