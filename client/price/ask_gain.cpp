#include "client/price/ask_gain.h"

#include <algorithm>
#include <cmath>

namespace mirage {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kLeastFlip = 1e-3;

}  // namespace

double disc_px(const Camera& camera, double radius_px) {
  const double most = double{1} * camera.width * camera.height;
  const double area = kPi * radius_px * radius_px;
  return area < most ? area : most;  // NaN and infinity: the eye is inside
}

double ask_gain(double area_px, const Wrongs& now, const Wrongs& then, double seconds) {
  const double flip = error_model().flip_of(now) - error_model().flip_of(then);
  return area_px * std::max(flip, kLeastFlip) * seconds;
}

}  // namespace mirage
