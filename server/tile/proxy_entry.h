#pragma once
// Where the rays of a tile's texels enter a convex proxy, and how much those depths differ from the
// content's.

#include <array>
#include <cstdint>
#include <vector>

#include "protocol/impostor/capture.h"
#include "protocol/impostor/object_proxy.h"

namespace mirage {

/// Capture depths of a crop's texels, as codes: 0 for nothing.
struct CodedDepths {
  /// Texels along an edge of the blocks into which a crop is cut, from its upper left corner.
  static constexpr std::uint32_t kBlock = 14;
  /// The least and the greatest code of something; `last` is 0 if there is nothing.
  struct Range {
    std::uint8_t first = 255, last = 0;
  };

  /// `of` holds the codes of all texels from the top, and must outlive this.
  CodedDepths(const std::vector<std::uint8_t>& of, const TileCrop& crop, const DepthCode& code);

  const std::uint8_t* codes;
  std::array<float, 256> depths{};  ///< of each code; 0 of code 0
  std::vector<Range> blocks;        ///< row by row
  Range all;
};

class ProxyEntry {
 public:
  /// `center` is the object's, in the space of `planes`.
  ProxyEntry(const std::vector<Plane>& planes, const Capture& capture, const glm::dvec3& center,
             const TileCrop& crop);

  /// Returns the depth at which the ray of each texel enters, NaN if it misses.
  std::vector<float> depths() const;

  /// Returns the largest dc^2 |1/z - 1/entry| over the content. The entry depth also takes the 3x3
  /// neighbourhood, which covers what happens between texel centres; in it, the nearest or the
  /// farthest entry differs most. Returns `unusable` if content lies where all these rays miss.
  ///
  /// Most of the crop needs no look at its texels: a bound shows that they differ less than others.
  float difference(const CodedDepths& content, float dc, float unusable) const;

 private:
  /// 1 / depth of a plane, which is linear in the texel.
  struct Line {
    double at_corner, along_x, along_y;
    double at_row(std::uint32_t y) const { return at_corner + along_y * y; }
    double at(std::uint32_t x, std::uint32_t y) const { return at_row(y) + along_x * x; }
  };
  /// Lines by coordinate, so that loops over them become vectors.
  struct Lines {
    std::vector<double> at_corner, along_x, along_y;
    std::vector<double> low, high;  ///< least and greatest value over a window
    void add(const Line& line);
  };
  /// A block of texels, and a margin of one texel that its neighbourhoods reach.
  static constexpr std::uint32_t kBlock = CodedDepths::kBlock, kWindow = kBlock + 2;
  struct Block {
    std::uint32_t x, y, w, h;  ///< without margin, in the crop
    /// Lines that matter somewhere in the block and its margin, in picked_: entering, then leaving.
    std::uint32_t first, leaving, end;
    double least, most;  ///< 1 / depth at which rays enter, over the block and its margin
  };
  using Row = std::array<float, kWindow>;
  using Window = std::array<Row, kWindow>;

  void add_block(std::uint32_t x, std::uint32_t y, Lines& entering, Lines& leaving);
  /// Picks the lines that no other line is below over the whole of a window. Returns the least
  /// value of any line, and the least that all lines reach.
  std::pair<double, double> pick_least(Lines& lines, const Block& window);
  /// True if the ray of a block's texel surely meets the proxy. Between two texels of a row that
  /// do, all do: where rays enter and leave is linear, or bends inwards.
  bool meets(const Block& block, std::uint32_t x, std::uint32_t y) const;
  /// True if the rays of all content of a block surely meet the proxy.
  bool meets_content(const Block& block, const CodedDepths& content) const;
  using Lows = std::array<double, kWindow>;
  /// Lowers `least` to the minimum of the lines from `first` to `end` at a row of texels from
  /// `left` on.
  void take_least(std::uint32_t first, std::uint32_t end, std::int64_t left, std::uint32_t y,
                  Lows& least) const;
  /// Returns the entry depths of a row of texels from `left` on; NaN: missed.
  Row entry_row(const Block& block, std::int64_t left, std::uint32_t y) const;
  /// Raises `worst` by the differences within a block; false: content lies where rays miss.
  bool look_closely(const Block& block, const CodedDepths& content, float dc, float& worst) const;
  /// Returns what the differences of a block do not exceed, per dc^2; 0: it is empty.
  double bound(std::size_t block, const CodedDepths& content) const;

  TileCrop crop_;
  std::vector<Line> picked_;
  std::vector<Block> blocks_;
};

}  // namespace mirage
