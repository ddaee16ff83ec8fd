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

enum class FrameKind : std::uint8_t { kMessage = 1, kChunk = 2 };

struct FrameHeader {
  std::uint8_t version = limits::kProtocolVersion;
  FrameKind kind = FrameKind::kMessage;
  std::uint32_t control_bytes = 0;
  std::uint32_t payload_bytes = 0;
};

/// Writes the header into `out[0..16)`.
void write_frame_header(const FrameHeader& header, std::uint8_t* out);
/// Reads and checks a header against the number of bytes that are there. Errors: kWireMalformed,
/// kWireVersion.
Result<FrameHeader> read_frame_header(const std::uint8_t* bytes, std::size_t size);

/// A whole message's bytes -> the WebSocket messages to send: itself, or chunks of it.
std::vector<Bytes> split_into_frames(Bytes message, std::uint32_t transfer_id);

/// Puts chunks together again; one per connection and direction.
class FrameAssembler {
 public:
  /// Of one transfer, and of all that are under way together.
  explicit FrameAssembler(std::size_t max_transfer_bytes) : max_bytes_(max_transfer_bytes) {}

  /// Takes one WebSocket message; gives a whole message when one is complete. Memory is taken as
  /// chunks arrive, never on the word of a header. Errors: kWireMalformed, kWireLimit.
  Result<std::optional<Bytes>> accept(const std::uint8_t* bytes, std::size_t size);

 private:
  struct Transfer {
    std::uint32_t total = 0;
    Bytes bytes;
  };
  Result<std::optional<Bytes>> accept_chunk(const std::uint8_t* bytes, std::size_t size);

  std::size_t max_bytes_;
  std::size_t held_bytes_ = 0;  ///< of all transfers
  std::map<std::uint32_t, Transfer> transfers_;
};

}  // namespace mirage
