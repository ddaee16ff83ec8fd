#include "protocol/wire/wire.h"

#include <algorithm>
#include <string>

namespace mirage {
namespace {

void put_u32(std::uint8_t* out, std::uint32_t v) {
  for (int i = 0; i < 4; ++i) out[i] = static_cast<std::uint8_t>(v >> (8 * i));
}

std::uint32_t get_u32(const std::uint8_t* in) {
  std::uint32_t v = 0;
  for (int i = 0; i < 4; ++i) v |= static_cast<std::uint32_t>(in[i]) << (8 * i);
  return v;
}

}  // namespace

void write_packet_header(const PacketHeader& header, std::uint8_t* out) {
  out[0] = kWireMagic & 0xff;
  out[1] = kWireMagic >> 8;
  out[2] = header.version;
  out[3] = static_cast<std::uint8_t>(header.kind);
  put_u32(out + 4, header.control_bytes);
  put_u32(out + 8, header.payload_bytes);
  put_u32(out + 12, 0);
}

Result<PacketHeader> read_packet_header(const std::uint8_t* bytes, std::size_t size) {
  if (size < kWireHeaderBytes) {
    return make_error(ErrorId::kWireMalformed, "message is shorter than its header");
  }
  if (bytes[0] != (kWireMagic & 0xff) || bytes[1] != (kWireMagic >> 8)) {
    return make_error(ErrorId::kWireMalformed, "message does not start with the Mirage magic");
  }
  PacketHeader header;
  header.version = bytes[2];
  if (header.version != limits::kProtocolVersion) {
    return make_error(ErrorId::kWireVersion,
                      "peer speaks protocol version " + std::to_string(header.version) +
                          ", this program speaks " + std::to_string(limits::kProtocolVersion));
  }
  if (bytes[3] != 1 && bytes[3] != 2) {
    return make_error(ErrorId::kWireMalformed, "unknown frame kind");
  }
  header.kind = static_cast<PacketKind>(bytes[3]);
  header.control_bytes = get_u32(bytes + 4);
  header.payload_bytes = get_u32(bytes + 8);
  const std::uint64_t whole =
      std::uint64_t{kWireHeaderBytes} + header.control_bytes + header.payload_bytes;
  if (whole != size || get_u32(bytes + 12) != 0) {
    return make_error(ErrorId::kWireMalformed, "message length does not agree with its header");
  }
  return header;
}

std::vector<Bytes> split_into_packets(Bytes message, std::uint32_t transfer_id) {
  std::vector<Bytes> packets;
  if (message.size() <= limits::kMaxMessageBytes) {
    packets.push_back(std::move(message));
    return packets;
  }
  for (std::size_t offset = 0; offset < message.size(); offset += limits::kChunkBytes) {
    const std::size_t n = std::min(limits::kChunkBytes, message.size() - offset);
    Bytes packet(kWireHeaderBytes + kChunkPrefixBytes + n);
    PacketHeader header;
    header.kind = PacketKind::kChunk;
    header.payload_bytes = static_cast<std::uint32_t>(kChunkPrefixBytes + n);
    write_packet_header(header, packet.data());
    put_u32(packet.data() + kWireHeaderBytes, transfer_id);
    put_u32(packet.data() + kWireHeaderBytes + 4, static_cast<std::uint32_t>(message.size()));
    put_u32(packet.data() + kWireHeaderBytes + 8, static_cast<std::uint32_t>(offset));
    std::copy_n(message.begin() + static_cast<std::ptrdiff_t>(offset), n,
                packet.begin() + kWireHeaderBytes + kChunkPrefixBytes);
    packets.push_back(std::move(packet));
  }
  return packets;
}

Result<std::optional<Bytes>> PacketAssembler::accept(const std::uint8_t* bytes, std::size_t size) {
  if (size > limits::kMaxMessageBytes) {
    return make_error(ErrorId::kWireLimit, "message is larger than allowed");
  }
  Result<PacketHeader> header = read_packet_header(bytes, size);
  if (!header) return header.error();
  if (header->kind == PacketKind::kChunk) return accept_chunk(bytes, size);
  return std::optional<Bytes>(Bytes(bytes, bytes + size));
}

Result<std::optional<Bytes>> PacketAssembler::accept_chunk(const std::uint8_t* bytes,
                                                           std::size_t size) {
  if (size < kWireHeaderBytes + kChunkPrefixBytes + 1 || get_u32(bytes + 4) != 0) {
    return make_error(ErrorId::kWireMalformed, "chunk without content");
  }
  const std::uint8_t* prefix = bytes + kWireHeaderBytes;
  const std::uint32_t id = get_u32(prefix);
  const std::uint32_t total = get_u32(prefix + 4);
  const std::uint32_t offset = get_u32(prefix + 8);
  const std::uint8_t* data = prefix + kChunkPrefixBytes;
  const std::size_t n = size - kWireHeaderBytes - kChunkPrefixBytes;
  if (total > max_bytes_) {
    return make_error(ErrorId::kWireLimit, "chunked message is larger than allowed");
  }
  if (transfers_.count(id) == 0 && transfers_.size() >= limits::kMaxOpenTransfers) {
    return make_error(ErrorId::kWireLimit, "too many chunked messages at once");
  }
  Transfer& transfer = transfers_[id];
  if (transfer.bytes.empty()) transfer.total = total;
  if (transfer.total != total || offset != transfer.bytes.size() || n > total - offset) {
    return make_error(ErrorId::kWireMalformed, "chunk does not continue its message");
  }
  if (held_bytes_ + n > max_bytes_) {
    return make_error(ErrorId::kWireLimit, "chunked messages together are larger than allowed");
  }
  held_bytes_ += n;
  transfer.bytes.insert(transfer.bytes.end(), data, data + n);
  if (transfer.bytes.size() < total) return std::optional<Bytes>();
  std::optional<Bytes> whole(std::move(transfer.bytes));
  held_bytes_ -= total;
  transfers_.erase(id);
  Result<PacketHeader> inner = read_packet_header(whole->data(), whole->size());
  if (!inner) return inner.error();
  if (inner->kind != PacketKind::kMessage) {
    return make_error(ErrorId::kWireMalformed, "chunks within chunks");
  }
  return whole;
}

}  // namespace mirage
