#include "server/tile/proxy_entry.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace mirage {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr float kMissed = std::numeric_limits<float>::quiet_NaN();

// Takes a row of codes into the least and the greatest of each column. Codes count less 1, so that
// nothing counts as 255; in `last` they do not.
void widen(const std::uint8_t* row, std::size_t w, std::uint8_t* first, std::uint8_t* last) {
  for (std::size_t x = 0; x < w; ++x) {
    const auto before = static_cast<std::uint8_t>(row[x] - 1);
    first[x] = before < first[x] ? before : first[x];
    last[x] = row[x] > last[x] ? row[x] : last[x];
  }
}

// std::min() and std::max() choose between addresses, and loops with them do not become vectors.
float least(float a, float b) { return b < a ? b : a; }
float greatest(float a, float b) { return a < b ? b : a; }

// Compares a row of depths with the entries of the row and its neighbours: the least and the
// greatest of each column, of which there is one more on both sides. Raises `most`, and `missed`
// where no ray enters. There are no branches, so that the loop becomes vectors.
void compare(const float* depths, std::size_t w, const float* low, const float* high, float dc,
             float* most, float* missed) {
  for (std::size_t x = 0; x < w; ++x) {
    const float depth = depths[x], scale = dc / depth;
    const float near = least(least(low[x], low[x + 1]), low[x + 2]);
    const float far = greatest(greatest(high[x], high[x + 1]), high[x + 2]);
    const float off_near = std::abs(depth - near) * scale * (dc / near);
    const float off_far = std::abs(depth - far) * scale * (dc / far);
    const float off = greatest(off_near, off_far);
    const float there = depth != 0 ? 1.0f : 0.0f, met = far > 0 ? 1.0f : 0.0f;
    const float counted = there * met > 0 ? off : 0.0f;
    most[x] = greatest(most[x], counted);
    missed[x] += there * (1 - met);
  }
}

}  // namespace

CodedDepths::CodedDepths(const std::vector<std::uint8_t>& of, const TileCrop& crop,
                         const DepthCode& code)
    : codes(of.data()) {
  for (std::size_t i = 1; i < depths.size(); ++i) {
    depths[i] = static_cast<float>(code.decode(static_cast<std::uint8_t>(i)));
  }
  std::vector<std::uint8_t> first(crop.w), last(crop.w);  // by column of a row of blocks
  for (std::uint32_t top = 0; top < crop.h; top += kBlock) {
    std::fill(first.begin(), first.end(), std::uint8_t{255});
    std::fill(last.begin(), last.end(), std::uint8_t{0});
    for (std::uint32_t y = top; y < std::min(top + kBlock, crop.h); ++y) {
      widen(codes + std::size_t{y} * crop.w, crop.w, first.data(), last.data());
    }
    for (std::uint32_t left = 0; left < crop.w; left += kBlock) {
      Range range;
      for (std::size_t x = left; x < std::min(left + kBlock, crop.w); ++x) {
        range.first = std::min(range.first, first[x]);
        range.last = std::max(range.last, last[x]);
      }
      if (range.last > 0) ++range.first;  // it was the code before
      all.first = std::min(all.first, range.first);
      all.last = std::max(all.last, range.last);
      blocks.push_back(range);
    }
  }
}

void ProxyEntry::Lines::add(const Line& line) {
  at_corner.push_back(line.at_corner);
  along_x.push_back(line.along_x);
  along_y.push_back(line.along_y);
  low.push_back(0);
  high.push_back(0);
}

ProxyEntry::ProxyEntry(const std::vector<Plane>& planes, const Capture& capture,
                       const glm::dvec3& center, const TileCrop& crop)
    : crop_(crop) {
  // The ray's direction has length 1 along the axis, so its parameter is the capture depth. 1 /
  // depth of a plane is linear in the texel.
  const glm::dvec3 eye = capture.eye();
  const glm::dvec2 first(crop.x + 0.5, crop.y + 0.5);
  const glm::dvec3 corner = capture.point_from_texel(first, 1.0);
  const glm::dvec3 along_x = capture.point_from_texel(first + glm::dvec2(1, 0), 1.0) - corner;
  const glm::dvec3 along_y = capture.point_from_texel(first + glm::dvec2(0, 1), 1.0) - corner;
  Lines entering, leaving;  // `leaving` is negated: its greatest value counts
  for (const Plane& plane : planes) {
    const glm::dvec3& n = plane.normal;
    double gap = plane.offset - glm::dot(n, center + eye);
    if (gap == 0) gap = std::numeric_limits<double>::min();
    if (gap < 0) {
      entering.add({glm::dot(n, corner - eye) / gap, glm::dot(n, along_x) / gap,
                    glm::dot(n, along_y) / gap});
    } else {
      leaving.add({-glm::dot(n, corner - eye) / gap, -glm::dot(n, along_x) / gap,
                   -glm::dot(n, along_y) / gap});
    }
  }
  for (std::uint32_t y = 0; y < crop.h; y += kBlock) {
    for (std::uint32_t x = 0; x < crop.w; x += kBlock) add_block(x, y, entering, leaving);
  }
}

void ProxyEntry::add_block(std::uint32_t x, std::uint32_t y, Lines& entering, Lines& leaving) {
  Block block{x, y, std::min(kBlock, crop_.w - x), std::min(kBlock, crop_.h - y), 0, 0, 0, 0, 0};
  Block window = block;
  window.x -= x > 0 ? 1 : 0;
  window.y -= y > 0 ? 1 : 0;
  window.w = std::min(block.x + block.w + 1, crop_.w) - window.x;
  window.h = std::min(block.y + block.h + 1, crop_.h) - window.y;
  block.first = static_cast<std::uint32_t>(picked_.size());
  const auto [enter_least, enter_most] = pick_least(entering, window);
  block.leaving = static_cast<std::uint32_t>(picked_.size());
  const double leave_most = pick_least(leaving, window).second;
  block.end = static_cast<std::uint32_t>(picked_.size());
  block.least = std::max(enter_least, -leave_most);  // where a ray meets the proxy, it enters first
  block.most = enter_most;
  blocks_.push_back(block);
}

std::pair<double, double> ProxyEntry::pick_least(Lines& lines, const Block& window) {
  const double across = window.w - 1, down = window.h - 1;
  const double x = window.x + 0.5 * across, y = window.y + 0.5 * down;
  const std::size_t count = lines.at_corner.size();
  const double *corner = lines.at_corner.data(), *along_x = lines.along_x.data(),
               *along_y = lines.along_y.data();
  double *low = lines.low.data(), *high = lines.high.data();
  for (std::size_t i = 0; i < count; ++i) {
    const double middle = corner[i] + along_y[i] * y + along_x[i] * x;
    const double swing = 0.5 * (std::abs(along_x[i]) * across + std::abs(along_y[i]) * down);
    low[i] = middle - swing;
    high[i] = middle + swing;
  }
  double least = kInfinity, most = kInfinity;
  for (std::size_t i = 0; i < count; ++i) {
    least = std::min(least, low[i]);
    most = std::min(most, high[i]);
  }
  const double limit = most + 1e-12 * std::abs(most);
  for (std::size_t i = 0; i < count; ++i) {
    // The margin exceeds rounding errors, and the comparison is false for NaN.
    if (low[i] - 1e-12 * std::abs(low[i]) > limit) continue;
    picked_.push_back({corner[i], along_x[i], along_y[i]});
  }
  return {least, most};
}

bool ProxyEntry::meets(const Block& block, std::uint32_t x, std::uint32_t y) const {
  double enter = kInfinity, leave = kInfinity;
  for (std::uint32_t i = block.first; i < block.leaving; ++i) {
    enter = std::min(enter, picked_[i].at(x, y));
  }
  for (std::uint32_t i = block.leaving; i < block.end; ++i) {
    leave = std::min(leave, picked_[i].at(x, y));
  }
  constexpr double kMargin = 1e-9, kMost = 1e30;  // exceeds rounding; is far from overflow
  return enter > 0 && enter < kMost && enter * (1 - kMargin) > -leave;
}

bool ProxyEntry::meets_content(const Block& block, const CodedDepths& content) const {
  const std::uint32_t right = block.x + block.w - 1, bottom = block.y + block.h - 1;
  if (meets(block, block.x, block.y) && meets(block, right, block.y) &&
      meets(block, block.x, bottom) && meets(block, right, bottom)) {
    return true;
  }
  for (std::uint32_t y = block.y; y <= bottom; ++y) {
    const std::uint8_t* const row = content.codes + std::size_t{y} * crop_.w;
    std::uint32_t first = block.x, last = right;
    while (first <= right && row[first] == 0) ++first;
    if (first > right) continue;
    while (row[last] == 0) --last;
    if (!meets(block, first, y) || !meets(block, last, y)) return false;
  }
  return true;
}

void ProxyEntry::take_least(std::uint32_t first, std::uint32_t end, std::int64_t left,
                            std::uint32_t y, Lows& least) const {
  const auto from = static_cast<double>(left);
  Lows low = least;
  for (std::uint32_t i = first; i < end; ++i) {
    const double start = picked_[i].at_row(y), along_x = picked_[i].along_x;
    for (int k = 0; k < static_cast<int>(kWindow); ++k) {
      const auto at = static_cast<std::size_t>(k);
      low[at] = std::min(low[at], start + along_x * (from + k));
    }
  }
  least = low;
}

ProxyEntry::Row ProxyEntry::entry_row(const Block& block, std::int64_t left,
                                      std::uint32_t y) const {
  Lows enter, leave;
  enter.fill(kInfinity);
  leave.fill(0.0);
  take_least(block.first, block.leaving, left, y, enter);
  take_least(block.leaving, block.end, left, y, leave);
  Row row;
  for (std::size_t k = 0; k < kWindow; ++k) row[k] = static_cast<float>(1 / enter[k]);
  for (std::size_t k = 0; k < kWindow; ++k) {
    const bool met = (enter[k] > 0) & (enter[k] >= -leave[k]);
    row[k] = met ? row[k] : kMissed;
  }
  return row;
}

std::vector<float> ProxyEntry::depths() const {
  std::vector<float> out(crop_.area());
  for (const Block& block : blocks_) {
    for (std::uint32_t y = block.y; y < block.y + block.h; ++y) {
      const Row row = entry_row(block, block.x, y);
      std::copy_n(row.begin(), block.w,
                  out.begin() + static_cast<std::ptrdiff_t>(std::size_t{y} * crop_.w + block.x));
    }
  }
  return out;
}

double ProxyEntry::bound(std::size_t at, const CodedDepths& content) const {
  const CodedDepths::Range codes = content.blocks[at];
  if (codes.last == 0) return 0;
  const Block& block = blocks_[at];
  if (!(block.least > 0) || !meets_content(block, content)) return kInfinity;
  const double nearest = 1.0 / content.depths[codes.first];
  const double farthest = 1.0 / content.depths[codes.last];
  const double differs = std::max(nearest - block.least, block.most - farthest);
  // The margins exceed the rounding errors of look_closely() in float.
  return differs * (1 + 1e-5) + 1e-6 * std::max(block.most, nearest);
}

bool ProxyEntry::look_closely(const Block& block, const CodedDepths& content, float dc,
                              float& worst) const {
  constexpr float kNone = std::numeric_limits<float>::infinity();
  Window entry;
  const std::int64_t left = std::int64_t{block.x} - 1, top = std::int64_t{block.y} - 1;
  for (std::uint32_t y = 0; y < block.h + 2; ++y) {
    const std::int64_t at = top + y;
    if (at < 0 || at >= crop_.h) {
      entry[y].fill(kMissed);
      continue;
    }
    entry[y] = entry_row(block, left, static_cast<std::uint32_t>(at));
    if (left < 0) entry[y][0] = kMissed;
    if (block.x + block.w == crop_.w) entry[y][block.w + 1] = kMissed;
  }
  std::array<float, kBlock> most{}, missed{};
  for (std::uint32_t y = 0; y < block.h; ++y) {
    Row low, high;
    for (std::size_t x = 0; x < kWindow; ++x) {  // comparisons with NaN are false
      float l = kNone, h = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const float e = entry[y + k][x];
        l = e < l ? e : l;
        h = e > h ? e : h;
      }
      low[x] = l;
      high[x] = h;
    }
    std::array<float, kBlock> depths{};
    const std::uint8_t* const codes = content.codes + std::size_t{block.y + y} * crop_.w + block.x;
    for (std::size_t x = 0; x < block.w; ++x) depths[x] = content.depths[codes[x]];
    compare(depths.data(), block.w, low.data(), high.data(), dc, most.data(), missed.data());
  }
  worst = std::max(worst, *std::max_element(most.begin(), most.end()));
  return *std::max_element(missed.begin(), missed.end()) == 0;
}

float ProxyEntry::difference(const CodedDepths& content, float dc, float unusable) const {
  struct Candidate {
    double most;
    const Block* block;
  };
  std::vector<Candidate> candidates;
  candidates.reserve(blocks_.size());
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    const double most = bound(i, content);
    if (most > 0) candidates.push_back({most * dc * dc, &blocks_[i]});
  }
  std::sort(candidates.begin(), candidates.end(),
            [](const Candidate& a, const Candidate& b) { return a.most > b.most; });
  float worst = 0;
  for (const Candidate& candidate : candidates) {
    if (candidate.most <= worst) break;
    if (!look_closely(*candidate.block, content, dc, worst)) return unusable;
  }
  return worst;
}

}  // namespace mirage
