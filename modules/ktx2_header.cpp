#include "modules/ktx2_header.h"

#include <algorithm>
#include <array>
#include <bit>
#include <string>

namespace mirage {
namespace {

constexpr std::array<std::uint8_t, 12> kIdentifier = {0xab, 'K',  'T',  'X',  ' ',  '2',
                                                      '0',  0xbb, '\r', '\n', 0x1a, '\n'};

// Byte offsets of the fields in the file.
enum : std::size_t {
  kVkFormat = 12,
  kWidth = 20,
  kHeight = 24,
  kDepth = 28,
  kLayers = 32,
  kFaces = 36,
  kLevels = 40,
  kScheme = 44,
  kDescriptor = 48,      // offset and length of the data format descriptor, 32 bits each
  kKeyValues = 56,       // the same of the key/value data
  kGlobal = 64,          // offset and length of the codec's tables, 64 bits each
  kLevelIndex = 80,      // three numbers of 64 bits a level: offset, length, length when expanded
  kLevelEntry = 24,      // bytes of one entry
  kColourModel = 12,     // in the descriptor
  kDescriptorBytes = 44  // a descriptor with one sample
};

enum : std::uint32_t { kNoScheme = 0, kBasisLz = 1, kZstandard = 2 };
enum : std::uint8_t { kModelEtc1s = 163, kModelUastc = 166 };
constexpr std::uint64_t kUastcBlockBytes = 16;

Error damaged(std::string why) { return make_error(ErrorId::kSceneFormat, std::move(why)); }

/// Reads a little-endian number. The caller has checked that it lies inside `bytes`.
std::uint64_t number(std::span<const std::uint8_t> bytes, std::size_t at, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t i = size; i-- > 0;) value = value << 8 | bytes[at + i];
  return value;
}
std::uint32_t word32(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint32_t>(number(bytes, at, 4));
}
std::uint64_t word64(std::span<const std::uint8_t> bytes, std::size_t at) {
  return number(bytes, at, 8);
}

bool inside(std::span<const std::uint8_t> bytes, std::uint64_t offset, std::uint64_t length) {
  return offset <= bytes.size() && length <= bytes.size() - offset;
}

/// Checks the shape: one 2D picture with at most as many levels as its size has.
Result<Ktx2Header> read_shape(std::span<const std::uint8_t> bytes) {
  Ktx2Header header{word32(bytes, kWidth), word32(bytes, kHeight), word32(bytes, kLevels)};
  const std::uint32_t longest = std::max(header.width, header.height);
  if (header.width < 1 || header.height < 1 || longest > kMaxKtx2Size) {
    return damaged("a KTX2 file of " + std::to_string(header.width) + "x" +
                   std::to_string(header.height) + " pixels; an edge may have 1 to " +
                   std::to_string(kMaxKtx2Size));
  }
  if (word32(bytes, kDepth) != 0 || word32(bytes, kLayers) > 1 || word32(bytes, kFaces) != 1) {
    return damaged("a KTX2 file that is no single 2D picture, but a volume, an array or a cube");
  }
  if (header.levels < 1 || header.levels > static_cast<std::uint32_t>(std::bit_width(longest))) {
    return damaged("a KTX2 file with " + std::to_string(header.levels) +
                   " mip levels; its size allows 1 to " + std::to_string(std::bit_width(longest)));
  }
  return header;
}

/// Checks the codec and returns true for UASTC, false for ETC1S.
Result<bool> read_codec(std::span<const std::uint8_t> bytes) {
  const std::uint32_t offset = word32(bytes, kDescriptor), length = word32(bytes, kDescriptor + 4);
  if (!inside(bytes, offset, length) || length < kDescriptorBytes) {
    return damaged("a KTX2 file whose data format descriptor lies outside of it");
  }
  const std::uint8_t model = bytes[offset + kColourModel];
  const std::uint32_t scheme = word32(bytes, kScheme);
  const bool etc1s = model == kModelEtc1s && scheme == kBasisLz;
  const bool uastc = model == kModelUastc && (scheme == kNoScheme || scheme == kZstandard);
  if (word32(bytes, kVkFormat) != 0 || !(etc1s || uastc)) {
    return damaged("a KTX2 file that is not Basis Universal (ETC1S or UASTC)");
  }
  return uastc;
}

/// Checks that each level lies inside the file, and that UASTC expands to its number of blocks.
Result<void> check_levels(std::span<const std::uint8_t> bytes, const Ktx2Header& header,
                          bool uastc) {
  for (std::uint32_t level = 0; level < header.levels; ++level) {
    const std::size_t entry = kLevelIndex + level * kLevelEntry;
    const std::uint64_t length = word64(bytes, entry + 8), expanded = word64(bytes, entry + 16);
    if (length == 0 || !inside(bytes, word64(bytes, entry), length)) {
      return damaged("a KTX2 file whose mip level " + std::to_string(level) +
                     " lies outside of it");
    }
    const std::uint64_t blocks =
        std::uint64_t{(header.width_of(level) + 3) / 4} * ((header.height_of(level) + 3) / 4);
    const bool plain = word32(bytes, kScheme) == kNoScheme;
    if (uastc && (expanded != blocks * kUastcBlockBytes || (plain && length != expanded))) {
      return damaged("a KTX2 file whose mip level " + std::to_string(level) +
                     " has another number of bytes than its size needs");
    }
  }
  return {};
}

}  // namespace

Result<Ktx2Header> read_ktx2_header(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kLevelIndex ||
      !std::equal(kIdentifier.begin(), kIdentifier.end(), bytes.begin())) {
    return damaged("not a KTX2 file");
  }
  const Result<Ktx2Header> header = read_shape(bytes);
  if (!header) return header;
  if (bytes.size() < kLevelIndex + header->levels * kLevelEntry) {
    return damaged("a KTX2 file that ends inside its level index");
  }
  if (!inside(bytes, word32(bytes, kKeyValues), word32(bytes, kKeyValues + 4)) ||
      !inside(bytes, word64(bytes, kGlobal), word64(bytes, kGlobal + 8))) {
    return damaged("a KTX2 file whose key/value or global data lies outside of it");
  }
  const Result<bool> uastc = read_codec(bytes);
  if (!uastc) return uastc.error();
  if (const Result<void> levels = check_levels(bytes, *header, *uastc); !levels) {
    return levels.error();
  }
  return header;
}

}  // namespace mirage
