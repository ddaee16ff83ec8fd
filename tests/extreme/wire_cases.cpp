// R1 to R5, R7, R8: how decoders treat hostile bytes. R6 is in wire_server_cases.cpp.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>
#include <random>

#include "protocol/codec/image_codec.h"
#include "protocol/codec/tile_codec.h"
#include "tests/extreme/peak_memory.h"
#include "tests/extreme/registry.h"
#include "tests/extreme/wire_samples.h"
#include "tests/extreme/wire_server_cases.h"
#include "tests/support/protocol_samples.h"

namespace mirage::extreme {
namespace {

constexpr double kMegabyte = 1024.0 * 1024.0;

void put_word(Bytes& bytes, std::size_t at, std::uint64_t v, int n) {
  for (int i = 0; i < n; ++i) bytes[at + static_cast<std::size_t>(i)] = (v >> (8 * i)) & 0xff;
}

/// 0, 1 and every power of two with its neighbours, up to 2^(bits-1) + 1 and the largest.
std::vector<std::uint64_t> lengths(int bits) {
  std::vector<std::uint64_t> out = {0, 1};
  for (int i = 1; i < bits; ++i) {
    for (const std::uint64_t off : {-1, 0, 1}) out.push_back((std::uint64_t{1} << i) + off);
  }
  out.push_back(bits == 64 ? UINT64_MAX : (std::uint64_t{1} << bits) - 1);
  return out;
}

/// A zstd frame that claims to hold `content` bytes.
Bytes zstd_frame(std::uint64_t content, const Bytes& blocks) {
  constexpr std::uint8_t kHead[] = {0x28, 0xb5, 0x2f, 0xfd, 0xe0};  // eight bytes of size follow
  Bytes out(std::size(kHead) + 8 + blocks.size());
  std::copy(std::begin(kHead), std::end(kHead), out.begin());
  put_word(out, std::size(kHead), content, 8);
  std::copy(blocks.begin(), blocks.end(), out.end() - static_cast<std::ptrdiff_t>(blocks.size()));
  return out;
}

/// True for an error that is not one of this program's own making.
template <typename T>
bool refused(const Result<T>& result) {
  return !result && result.error().id != ErrorId::kInternal;
}

// R1: every length word of packets, chunks, compressed blocks and geometry, with every power of
// two.
Outcome any_wire_length(const Conditions& conditions) {
  int accepted = 0, tried = 0;
  const std::size_t before = peak_bytes();
  for (const Bytes& whole : test::sample_messages()) {
    for (const std::size_t at : {4, 8, 12}) {
      for (const std::uint64_t v : lengths(32)) {
        Bytes bytes = whole;
        put_word(bytes, at, v, 4);
        if (bytes == whole) continue;
        ++tried;
        accepted += refused(decode_message(bytes.data(), bytes.size())) ? 0 : 1;
        // Pieces are held until they are complete, which these never are.
        PacketAssembler assembler(limits::kMaxTransferBytes);
        const auto frame = assembler.accept(bytes.data(), bytes.size());
        accepted += !frame ? 0 : 1;
      }
    }
  }
  for (const std::uint64_t v : lengths(32)) {  // total of a chunked transfer, and its offset
    Bytes chunk(kWireHeaderBytes + kChunkPrefixBytes + 8);
    PacketHeader header;
    header.kind = PacketKind::kChunk;
    header.payload_bytes = kChunkPrefixBytes + 8;
    write_packet_header(header, chunk.data());
    put_word(chunk, kWireHeaderBytes + 4, v, 4);
    PacketAssembler assembler(limits::kMaxTransferBytes);
    const auto first = assembler.accept(chunk.data(), chunk.size());
    ++tried;
    const bool too_long = v > limits::kMaxTransferBytes || v < 8;
    accepted += too_long && !refused(first) ? 1 : 0;
    accepted += first && first->has_value() ? 1 : 0;  // eight bytes are no message
    put_word(chunk, kWireHeaderBytes + 4, 1000, 4);
    put_word(chunk, kWireHeaderBytes + 8, v, 4);
    PacketAssembler fresh(limits::kMaxTransferBytes);
    accepted += v != 0 && !refused(fresh.accept(chunk.data(), chunk.size())) ? 1 : 0;
  }
  for (const std::uint64_t v : lengths(64)) {  // size that a compressed block claims
    const Bytes bytes = zstd_frame(v, {1, 0, 0});
    Tile tile;
    tile.edge = 64;
    tile.crop = {0, 0, 62, 62};
    tried += 2;
    accepted +=
        refused(decode_tile_planes(bytes.data(), bytes.size(), TileCodec::kZstd, tile)) ? 0 : 1;
    accepted += refused(decompress_block(bytes.data(), bytes.size(), 1000)) ? 0 : 1;
  }
  for (const char* file : {"model/everything", "model/sheet"}) {
    const Bytes whole = corpus(conditions.data, file);
    for (std::size_t word = 0; word < 9; ++word) {
      for (const std::uint64_t v : lengths(32)) {
        Bytes bytes = whole;
        put_word(bytes, word * 4, v, 4);
        if (bytes == whole || v == 0) continue;  // no lines, for example, may be a shorter model
        ++tried;
        const auto model = decode_model(bytes.data(), bytes.size(), 4);
        const bool larger = model && (model->mesh.vertices.size() > bytes.size() * 6 ||
                                      model->mesh.indices.size() > bytes.size() * 3);
        accepted += larger ? 1 : 0;
      }
    }
  }
  Checks checks;
  const double grown = static_cast<double>(peak_bytes() - before) / kMegabyte;
  checks.equal("accepted", accepted, 0);
  checks.at_least("lengths tried", tried, 4000);
  checks.at_most("memory grown by, MB", grown, 4);
  websocket_lengths(checks);
  return checks.outcome();
}

// R2
Outcome cuts(const Conditions& conditions) {
  Checks checks;
  int accepted = 0, count = 0, not_finite = 0;
  for (const WireSample& sample : wire_samples(conditions.data)) {
    if (!sample.accepts(sample.bytes, not_finite)) checks.failed("whole refused: " + sample.name);
    for (std::size_t n = 0; n < sample.bytes.size(); ++n) {
      const Bytes cut(sample.bytes.begin(), sample.bytes.begin() + static_cast<std::ptrdiff_t>(n));
      accepted += sample.accepts(cut, not_finite) ? 1 : 0;
      ++count;
    }
  }
  checks.equal("cut ones accepted", accepted, 0);
  checks.at_least("cuts", count, 4000);
  return checks.outcome();
}

// R3
Outcome flips(const Conditions& conditions) {
  std::mt19937_64 random(conditions.seed);
  const std::vector<WireSample> samples = wire_samples(conditions.data);
  const int count = conditions.count(1'000'000);
  int not_finite = 0, refused_ones = 0;
  const std::size_t before = peak_bytes();
  for (int i = 0; i < count; ++i) {
    const WireSample& sample = samples[static_cast<std::size_t>(i) % samples.size()];
    Bytes bytes = sample.bytes;
    for (std::uint64_t n = 1 + random() % 3; n > 0; --n) {
      const std::uint64_t bit = random() % (bytes.size() * 8);
      bytes[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
    }
    refused_ones += sample.accepts(bytes, not_finite) ? 0 : 1;
  }
  Checks checks;
  checks.equal("floats that are not finite", not_finite, 0);
  checks.at_least("of them refused, share", static_cast<double>(refused_ones) / count, 0.3);
  checks.at_most("memory grown by, MB", static_cast<double>(peak_bytes() - before) / kMegabyte, 64);
  return checks.outcome();
}

// R4
Outcome versions(const Conditions&) {
  int accepted = 0, other_error = 0;
  for (const Bytes& whole : test::sample_messages()) {
    for (int version = 0; version < 256; ++version) {
      if (version == limits::kProtocolVersion) continue;
      Bytes bytes = whole;
      bytes[2] = static_cast<std::uint8_t>(version);
      const auto message = decode_message(bytes.data(), bytes.size());
      accepted += message ? 1 : 0;
      other_error += !message && message.error().id == ErrorId::kWireVersion ? 0 : 1;
    }
  }
  Checks checks;
  checks.equal("accepted", accepted, 0);
  checks.equal("refused for another reason than the version", other_error, 0);
  versions_to_server(checks);
  return checks.outcome();
}

// R5: a few bytes that claim, or really hold, a million times as many.
Outcome bombs(const Conditions&) {
  int accepted = 0;
  const std::size_t before = peak_bytes();
  // Honest runs of one byte, which zstd packs best. Their size is declared right, but not as asked
  // for.
  const Bytes zeros(200u << 20);
  const Bytes bomb = compress_block(zeros.data(), zeros.size());
  const std::size_t with_zeros = peak_bytes();
  for (const std::uint32_t edge : {4u, 64u, 1024u, limits::kMaxTileEdge}) {
    for (const std::uint8_t channels : {kLitTile, kRelitTile, kShadowTile, kCasterTile}) {
      Tile tile;
      tile.edge = edge;
      tile.crop = {0, 0, edge, edge};
      tile.channels = channels;
      const auto planes = [&](const Bytes& b) {
        return refused(decode_tile_planes(b.data(), b.size(), TileCodec::kZstd, tile));
      };
      accepted += planes(bomb) ? 0 : 1;
      // The declared size is that of the crop, but the data are missing: 20 bytes for up to 36 MB,
      // 1 : 1.8e6.
      const std::uint64_t bytes = tile.crop.area() * (channels == kLitTile     ? 5u
                                                      : channels == kRelitTile ? 9u
                                                                               : 1u);
      accepted += planes(zstd_frame(bytes, {1, 0, 0})) ? 0 : 1;
      accepted += planes(zstd_frame(bytes, {3, 0, 0, 0})) ? 0 : 1;
    }
  }
  for (const std::uint64_t claim :
       {std::uint64_t{20'000'000}, std::uint64_t{1} << 40, UINT64_MAX}) {
    const Bytes b = zstd_frame(claim, {1, 0, 0});
    accepted += refused(decompress_block(b.data(), b.size(), 1000)) ? 0 : 1;
  }
  // An image larger than what was asked for.
  Image image;
  image.width = image.height = 4096;
  image.rgba.assign(std::size_t{4096} * 4096 * 4, 0);
  const Result<Bytes> large = encode_image(image);
  const std::size_t with_image = peak_bytes();
  accepted += large && refused(decode_image(large->data(), large->size(), {64, 64}, true)) ? 0 : 1;
  // Many small parts that add up: all transfers together have a limit.
  PacketAssembler assembler(limits::kMaxInboundTransferBytes);
  std::uint32_t id = 0;
  bool stopped = false;
  while (!stopped && id < 100) {
    Bytes message(limits::kMaxInboundTransferBytes - 100);
    const Bytes first = split_into_packets(std::move(message), id++)[0];
    stopped = refused(assembler.accept(first.data(), first.size()));
  }
  accepted += stopped && id <= limits::kMaxOpenTransfers + 1 ? 0 : 1;
  Checks checks;
  checks.equal("accepted", accepted, 0);
  checks.at_least("ratio of the honest bomb",
                  static_cast<double>(zeros.size()) / static_cast<double>(bomb.size()), 10'000);
  // Apart from the test's own 200 MB and 64 MB, at most a tile of the largest size with its planes.
  const double grown = static_cast<double>(peak_bytes() - with_image) / kMegabyte +
                       std::max(0.0, static_cast<double>(with_zeros - before) / kMegabyte - 450);
  checks.at_most("memory grown by, MB", grown, 80);
  return checks.outcome();
}

// R7: NaN and infinities of both signs in the place of every float and double.
Outcome not_numbers(const Conditions& conditions) {
  int not_finite = 0, refused_ones = 0, tried = 0;
  const float inf = std::numeric_limits<float>::infinity();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const WireSample& sample : wire_samples(conditions.data)) {
    const auto feed = [&](std::size_t at, const void* value, std::size_t n) {
      Bytes bytes = sample.bytes;
      if (at + n > bytes.size()) return;
      std::memcpy(&bytes[at], value, n);
      refused_ones += sample.accepts(bytes, not_finite) ? 0 : 1;
      ++tried;
    };
    for (std::size_t at = 0; at < sample.bytes.size(); ++at) {
      for (const float v : {nan, -nan, inf, -inf}) {
        feed(at, &v, sizeof v);
        const double d = v;
        feed(at, &d, sizeof d);
      }
    }
  }
  Checks checks;
  checks.equal("floats that got through", not_finite, 0);
  checks.at_least("places tried", tried, 20'000);
  checks.at_least("refused", refused_ones, 10'000);
  return checks.outcome();
}

// R8: bytes as this version of the protocol writes them, and files of it that must stay readable.
struct Golden {
  const char* name;
  std::uint64_t hash;
};
#include "tests/extreme/golden_bytes.inc"

Outcome golden_bytes(const Conditions& conditions) {
  int differing = 0, unreadable = 0, missing = 0;
  for (const WireSample& sample : wire_samples(conditions.data)) {
    int not_finite = 0;
    unreadable += sample.accepts(sample.bytes, not_finite) ? 0 : 1;
    const Golden* golden = nullptr;
    for (const Golden& g : kGolden) {
      if (sample.name == g.name) golden = &g;
    }
    missing += golden ? 0 : 1;
    const bool same = golden && hash_of(sample.bytes) == golden->hash;
    differing += same ? 0 : 1;
    if (!same) {
      std::fprintf(stderr, "    {\"%s\", 0x%016llxull},\n", sample.name.c_str(),
                   static_cast<unsigned long long>(hash_of(sample.bytes)));
    }
  }
  // The first bytes in clear: magic, version, kind, lengths.
  const Bytes bye = encode_message(test::sample_bye());
  const Bytes head = {'M', 'R', 5, 1, 0x4c, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  differing += Bytes(bye.begin(), bye.begin() + kWireHeaderBytes) == head ? 0 : 1;
  Checks checks;
  checks.equal("that differ", differing, 0);
  checks.equal("without a golden value", missing, 0);
  checks.equal("no longer readable", unreadable, 0);
  return checks.outcome();
}

}  // namespace

std::vector<Case> wire_cases() {
  return {
      {"R1", "lengths 0 to 2^63 in every length field", "refused before allocation",
       any_wire_length},
      {"R2", "messages, tiles, geometry and images cut at every byte", "refused", cuts},
      {"R3", "1e6 bit flips", "no crash, nothing not finite, memory bounded", flips},
      {"R4", "unknown protocol versions", "refused, and named as such", versions},
      {"R5", "decompression bombs of 1:1e6", "refused, memory bounded", bombs},
      slow_loris_case(),
      {"R7", "NaN and Inf in every float field", "refused or replaced: none gets through",
       not_numbers},
      {"R8", "golden bytes", "written and read as ever", golden_bytes},
  };
}

}  // namespace mirage::extreme
