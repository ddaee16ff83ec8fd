#include "tests/server/bake/consumers.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace mirage::consumer {
namespace {

using Raw = std::map<std::string, glm::dvec4>;
using glm::dvec3;

double linear(double v) { return v <= .04045 ? v / 12.92 : std::pow((v + .055) / 1.055, 2.4); }
dvec3 linear(const glm::dvec4& c) { return {linear(c.r), linear(c.g), linear(c.b)}; }
dvec3 signed_of(const glm::dvec4& c) { return dvec3(c) * 2.0 - 1.0; }
double sign(double v) { return v < 0 ? -1 : 1; }

// right = Y x n, up = n x right; near the pole another axis takes the place of Y.
std::function<Axes(const dvec3&)> y_up(double polar_from, const dvec3& polar, bool below = true) {
  return [=](const dvec3& n) {
    const bool at_pole = (below ? std::abs(n.y) : n.y) > polar_from;
    const dvec3 right = normalize(cross(at_pole ? polar : dvec3(0, 1, 0), n));
    return Axes{right, cross(n, right)};
  };
}

Axes imp_axes(const dvec3& n) {
  const dvec3 right = normalize(dvec3(-n.z, 0, n.x));
  return {right, cross(right, n)};
}

Axes unreal_axes(const dvec3& n) {
  if (n.z > 1 - 1e-9) return {{0, 1, 0}, {1, 0, 0}};
  const dvec3 right = normalize(dvec3(n.y, -n.x, 0)), down = cross(n, right);
  return {right, -down};
}

Sample generic(const Raw& raw, const Axes&, const dvec3&) {
  const glm::dvec4 c = raw.at("color"), n = raw.at("normal"), orm = raw.at("orm");
  Sample s{c.a > .5, linear(c) / std::max(c.a, 1e-9), n.a * 2 - 1, signed_of(n)};
  s.roughness = orm.g, s.metallic = orm.b;
  return s;
}

Sample three(const Raw& raw, const Axes& axes, const dvec3& toward) {
  const glm::dvec4 c = raw.at("color"), n = raw.at("normal");
  const dvec3 view = signed_of(n);
  return {c.a > .5, linear(c) / std::max(c.a, 1e-9), (n.a - .5) * 2,
          axes.right * view.x + axes.up * view.y + toward * view.z};
}

Sample three_tsl(const Raw& raw, const Axes&, const dvec3&) {
  const glm::dvec4 c = raw.at("color");
  return {c.a > .3, linear(c), 0, dvec3(0)};
}

Sample godot(const Raw& raw, const Axes& axes, const dvec3& toward) {
  const glm::dvec4 c = raw.at("color"), n = raw.at("normal"), orm = raw.at("orm");
  const double x = (.5 - n.r) * 2, y = (n.g - .5) * 2;
  const double z = std::sqrt(std::max(0.0, 1 - x * x - y * y));
  Sample s{c.a > .5, linear(c), (.5 - raw.at("depth").r) * 2,
           axes.right * x + axes.up * y + toward * z};
  s.roughness = orm.g, s.metallic = orm.b;
  return s;
}

Sample imp(const Raw& raw, const Axes&, const dvec3&) {
  const glm::dvec4 c = raw.at("color"), n = raw.at("normal");
  return {std::pow(c.a, .3) > .3, linear(c), (n.a - .5) * 2, signed_of(n)};
}

Sample unreal(const Raw& raw, const Axes&, const dvec3&) {
  const glm::dvec4 c = raw.at("color"), n = raw.at("normal"), orm = raw.at("orm");
  Sample s{c.a > .5, linear(c), (n.a - .5) * 2, signed_of(n)};
  s.metallic = orm.r, s.roughness = orm.g;
  return s;
}

// "word 0" and "word 1" hold the four bytes of a word each, the lowest first.
Sample boimp(const Raw& raw, const Axes&, const dvec3&) {
  const auto word = [&](const char* name) {
    std::uint32_t out = 0;
    for (int b = 3; b >= 0; --b) out = out << 8 | std::uint32_t(raw.at(name)[b] * 255 + .5);
    return out;
  };
  const std::uint32_t a = word("word 0"), b = word("word 1");
  const auto field = [](std::uint32_t w, int shift, int count) {
    return double(w >> shift & ((1u << count) - 1)) / ((1u << count) - 1);
  };
  const double x = field(b, 0, 12) * 2 - 1, z = field(b, 12, 12) * 2 - 1;
  dvec3 n(x, 1 - std::abs(x) - std::abs(z), z);
  if (n.y < 0) n = {sign(x) * (1 - std::abs(z)), n.y, sign(z) * (1 - std::abs(x))};
  Sample s{field(a, 15, 5) > 0,
           {field(a, 0, 5), field(a, 5, 5), field(a, 10, 5)},
           field(b, 24, 8) * 2 - 1,
           normalize(n)};
  s.roughness = field(a, 20, 4), s.metallic = field(a, 24, 4);
  return s;
}

glm::dmat3 columns(const dvec3& a, const dvec3& b, const dvec3& c) { return {a, b, c}; }

}  // namespace

glm::dvec4 Picture::at(int x, int y) const {
  glm::dvec4 out(0, 0, 0, 1);
  const std::size_t first = (std::size_t(y) * width + x) * channels;
  for (int c = 0; c < channels; ++c) out[c] = bytes.at(first + c) / 255.0;
  return out;
}

dvec3 Consumer::direction(Lattice lattice, int grid, int i, int j) const {
  if (lattice == Lattice::kRing) {
    const double angle = 2 * M_PI * (j * grid + i) / (grid * grid);
    return {std::sin(angle), 0, std::cos(angle)};
  }
  const double u = double(i) / (grid - 1), v = double(j) / (grid - 1);
  double first, second;
  if (lattice == Lattice::kWhole) {
    first = 2 * u - 1, second = 2 * v - 1;
  } else if (hemi_swapped) {
    const double g = 2 * u - 1, h = 2 * v - 1;
    first = (g + h) / 2, second = (g - h) / 2;
  } else {
    first = u - v, second = u + v - 1;
  }
  const double up = 1 - std::abs(first) - std::abs(second);
  if (up < 0 && lattice == Lattice::kWhole) {
    const double p = first, q = second;
    first = sign(p) * (1 - std::abs(q)), second = sign(q) * (1 - std::abs(p));
  }
  dvec3 n(0);
  n[right_axis] = first, n[forward_axis] = second, n[up_axis] = up;
  return normalize(n);
}

glm::dvec2 Consumer::place(Lattice lattice, int grid, const dvec3& direction) const {
  const dvec3 n =
      direction / (std::abs(direction.x) + std::abs(direction.y) + std::abs(direction.z));
  double first = n[right_axis], second = n[forward_axis];
  glm::dvec2 at;
  if (lattice == Lattice::kWhole) {
    if (n[up_axis] < 0) {
      const double p = first, q = second;
      first = sign(p) * (1 - std::abs(q)), second = sign(q) * (1 - std::abs(p));
    }
    at = {(first + 1) / 2, (second + 1) / 2};
  } else if (hemi_swapped) {
    at = {(first + second + 1) / 2, (first - second + 1) / 2};
  } else {
    at = {(first + second + 1) / 2, (second - first + 1) / 2};
  }
  return at * double(grid - 1);
}

glm::ivec2 Consumer::pixel(int grid, int tile, int i, int j, int x, int y) const {
  const int row = row_0_at_bottom ? grid - 1 - j : j;
  return {i * tile + x, row * tile + (tiles_upside_down ? tile - 1 - y : y)};
}

Blend blend(const glm::dvec2& place, int grid) {
  const glm::ivec2 base = glm::min(glm::ivec2(place), grid - 2);
  const glm::dvec2 f = place - glm::dvec2(base);
  const glm::ivec2 second = f.x > f.y ? glm::ivec2(1, 0) : glm::ivec2(0, 1);
  return {{base, base + second, base + 1},
          {std::min(1 - f.x, 1 - f.y), std::abs(f.x - f.y), std::min(f.x, f.y)}};
}

const std::vector<Consumer>& all() {
  const glm::dmat3 same(1), mirrored = columns({-1, 0, 0}, {0, 1, 0}, {0, 0, 1}),
                            z_up = columns({1, 0, 0}, {0, 0, 1}, {0, 1, 0});
  const double exact = 1 - 1e-9;
  static const std::vector<Consumer> list{
      {"generic", same, false, 0, 2, 1, y_up(exact, {0, 0, -1}), false, false, true, generic},
      {"three", same, false, 0, 2, 1, y_up(.999, {-1, 0, 0}, false), true, false, true, three},
      {"three-tsl", same, false, 0, 2, 1, y_up(exact, {0, 0, -1}), false, true, false, three_tsl},
      {"godot4", same, false, 0, 2, 1, y_up(.999, {0, 0, 1}), false, false, true, godot},
      {"godot3", same, false, 0, 2, 1, y_up(.999, {0, 0, 1}), false, false, true, godot},
      {"unity-imp", mirrored, true, 0, 2, 1, imp_axes, true, false, true, imp},
      {"unreal", z_up, true, 0, 1, 2, unreal_axes, false, false, true, unreal},
      {"boimp", same, false, 0, 2, 1, y_up(.99, {0, 0, 1}), false, false, true, boimp},
  };
  return list;
}

const Consumer& named(const std::string& name) {
  for (const auto& consumer : all()) {
    if (consumer.name == name) return consumer;
  }
  throw std::out_of_range(name);
}

}  // namespace mirage::consumer
