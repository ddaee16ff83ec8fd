#include "protocol/model/view_place.h"

#include <cmath>
#include <cstdio>

namespace mirage {
namespace {

constexpr double kFarthestM = 1e9;

}  // namespace

Result<ViewPlace> parse_view_place(const std::string& text) {
  double v[6];
  char extra = 0;
  bool good = std::sscanf(text.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf%c", &v[0], &v[1], &v[2], &v[3],
                          &v[4], &v[5], &extra) == 6;
  for (int i = 0; good && i < 6; ++i) good = std::abs(v[i]) <= kFarthestM;  // false for NaN
  const ViewPlace out = good ? ViewPlace{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}} : ViewPlace{};
  if (good && glm::length(out.target - out.eye) > 0) return out;
  return make_error(ErrorId::kUsage, "'" + text + "' is no view",
                    "the eye, and another point that it looks at, in metres: 0,1.7,5,0,1.7,0");
}

std::string to_text(const ViewPlace& place) {
  char out[200];
  std::snprintf(out, sizeof out, "%.17g,%.17g,%.17g,%.17g,%.17g,%.17g", place.eye.x, place.eye.y,
                place.eye.z, place.target.x, place.target.y, place.target.z);
  return out;
}

}  // namespace mirage
