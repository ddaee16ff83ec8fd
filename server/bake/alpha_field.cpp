#include "server/bake/alpha_field.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace mirage {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();

// Returns for each texel the row of the nearest chosen one in its own column, or -1.
std::vector<int> nearest_rows(const TexelMask& chosen, int size) {
  std::vector<int> row(chosen.size(), -1);
  for (int x = 0; x < size; ++x) {
    int seen = -1;
    for (int y = 0; y < size; ++y) {
      if (chosen[std::size_t(y) * size + x]) seen = y;
      row[std::size_t(y) * size + x] = seen;
    }
    seen = -1;
    for (int y = size - 1; y >= 0; --y) {
      const std::size_t at = std::size_t(y) * size + x;
      if (chosen[at]) seen = y;
      if (seen >= 0 && (row[at] < 0 || seen - y < y - row[at])) row[at] = seen;
    }
  }
  return row;
}

// The lower envelope of the parabolas (x - column)^2 + height along one row.
class Envelope {
 public:
  explicit Envelope(int size) : column_(size), begin_(size), height_(size) {}

  void clear() { count_ = 0; }

  void add(int column, float height) {
    float from = -kFar;
    while (count_ > 0) {
      from = meeting(column, height, count_ - 1);
      if (from > begin_[count_ - 1]) break;
      --count_;
      from = -kFar;
    }
    column_[count_] = column;
    begin_[count_] = from;
    height_[count_++] = height;
  }

  /// Calls `take(x, column, squared distance)` for each texel of the row.
  template <typename Take>
  void walk(int size, Take take) const {
    for (int x = 0, k = 0; x < size && count_ > 0; ++x) {
      while (k + 1 < count_ && begin_[k + 1] < float(x)) ++k;
      const float dx = float(x - column_[k]);
      take(x, column_[k], dx * dx + height_[k]);
    }
  }

 private:
  // Returns where the parabola `column` begins to lie below number k.
  float meeting(int column, float height, int k) const {
    const float a = float(column_[k]), b = float(column);
    return (height + b * b - height_[k] - a * a) / (2 * (b - a));
  }

  std::vector<int> column_;
  std::vector<float> begin_, height_;
  int count_ = 0;
};

TexelMask others(const TexelMask& mask) {
  TexelMask out(mask.size());
  std::transform(mask.begin(), mask.end(), out.begin(), [](auto m) { return m ? 0 : 1; });
  return out;
}

}  // namespace

NearestTexels nearest_texels(const TexelMask& chosen, int size) {
  const std::vector<int> rows = nearest_rows(chosen, size);
  NearestTexels out{std::vector<int>(chosen.size(), -1), std::vector<float>(chosen.size(), kFar)};
  Envelope envelope(size);
  for (int y = 0; y < size; ++y) {
    const std::size_t first = std::size_t(y) * size;
    envelope.clear();
    for (int x = 0; x < size; ++x) {
      const int row = rows[first + x];
      if (row >= 0) envelope.add(x, float(row - y) * float(row - y));
    }
    envelope.walk(size, [&](int x, int column, float squared) {
      out.texel[first + x] = rows[first + column] * size + column;
      out.distance[first + x] = std::sqrt(squared);
    });
  }
  return out;
}

std::vector<float> inner_field(const TexelMask& inside, int size, float reach) {
  std::vector<float> field = nearest_texels(others(inside), size).distance;
  for (auto& d : field) d = std::min(d / reach, 1.0f);
  return field;
}

std::vector<float> signed_field(const TexelMask& inside, int size, float reach) {
  const std::vector<float> in = nearest_texels(others(inside), size).distance;
  const std::vector<float> out = nearest_texels(inside, size).distance;
  std::vector<float> field(inside.size());
  for (std::size_t i = 0; i < field.size(); ++i) {
    const float d = (inside[i] ? in[i] : out[i]) - .5f;
    const float share = std::min(d / (reach - .5f), 1.0f);
    field[i] = ((inside[i] ? share : -share) + 1) / 2;
  }
  return field;
}

}  // namespace mirage
