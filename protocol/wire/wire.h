#pragma once
// Framing: a fixed 16-byte little-endian header, the FlatBuffers control part, then raw payload.
// Messages above kMaxMessageBytes travel as chunks and are reassembled under a cap.

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "protocol/base/bytes.h"
#include "protocol/base/limits.h"
#include "protocol/base/result.h"

namespace mirage {

inline constexpr std::uint16_t kWireMagic = 0x524d;  // "MR"
inline constexpr std::size_t kWireHeaderBytes = 16;
inline constexpr std::size_t kChunkPrefixBytes = 12;

enum class PacketKind : std::uint8_t { kMessage = 1, kChunk = 2 };

struct PacketHeader {
  std::uint8_t version = limits::kProtocolVersion;
  PacketKind kind = PacketKind::kMessage;
  std::uint32_t control_bytes = 0;
  std::uint32_t payload_bytes = 0;
};

/// Writes the header into `out[0..16)`.
void write_packet_header(const PacketHeader& header, std::uint8_t* out);
/// Reads a header and checks it against the number of bytes present. Errors: kWireMalformed,
/// kWireVersion.
Result<PacketHeader> read_packet_header(const std::uint8_t* bytes, std::size_t size);

/// Splits a whole message's bytes into WebSocket packets: the message itself, or chunks of it.
std::vector<Bytes> split_into_packets(Bytes message, std::uint32_t transfer_id);

/// Joins chunks into messages; one assembler per connection and direction.
class PacketAssembler {
 public:
  /// The limit holds for one transfer, and for all transfers under way together.
  explicit PacketAssembler(std::size_t max_transfer_bytes) : max_bytes_(max_transfer_bytes) {}

  /// Takes one packet and returns a whole message when one is complete. Memory grows as chunks
  /// arrive, never on the word of a header. Errors: kWireMalformed, kWireLimit.
  Result<std::optional<Bytes>> accept(const std::uint8_t* bytes, std::size_t size);

 private:
  struct Transfer {
    std::uint32_t total = 0;
    Bytes bytes;
  };
  Result<std::optional<Bytes>> accept_chunk(const std::uint8_t* bytes, std::size_t size);

  std::size_t max_bytes_;
  std::size_t held_bytes_ = 0;  ///< bytes held for all transfers
  std::map<std::uint32_t, Transfer> transfers_;
};

}  // namespace mirage
