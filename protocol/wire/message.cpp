#include "protocol/wire/message.h"

#include <cstring>

#include "protocol/base/limits.h"
#include "protocol/wire/message_check.h"

namespace mirage {

Bytes encode_body(const wire::BodyUnion& body, const Bytes& payload) {
  flatbuffers::FlatBufferBuilder builder(256);
  const flatbuffers::Offset<void> packed = body.Pack(builder);
  builder.Finish(wire::CreateControl(builder, body.type, packed));
  PacketHeader header;
  header.control_bytes = builder.GetSize();
  header.payload_bytes = static_cast<std::uint32_t>(payload.size());
  Bytes out(kWireHeaderBytes + builder.GetSize() + payload.size());
  write_packet_header(header, out.data());
  std::memcpy(out.data() + kWireHeaderBytes, builder.GetBufferPointer(), builder.GetSize());
  if (!payload.empty()) {
    std::memcpy(out.data() + kWireHeaderBytes + builder.GetSize(), payload.data(), payload.size());
  }
  return out;
}

Result<Message> decode_message(const std::uint8_t* bytes, std::size_t size) {
  Result<PacketHeader> header = read_packet_header(bytes, size);
  if (!header) return header.error();
  if (header->kind != PacketKind::kMessage || header->control_bytes == 0) {
    return make_error(ErrorId::kWireMalformed, "message has no control part");
  }
  if (header->control_bytes > limits::kMaxControlBytes) {
    return make_error(ErrorId::kWireLimit, "control part is larger than allowed");
  }
  // FlatBuffers needs an aligned buffer; after the 16-byte header the control part has the caller's
  // alignment.
  const Bytes aligned(bytes + kWireHeaderBytes, bytes + kWireHeaderBytes + header->control_bytes);
  flatbuffers::Verifier verifier(aligned.data(), aligned.size(), 8, 4096);
  if (!wire::VerifyControlBuffer(verifier)) {
    return make_error(ErrorId::kWireMalformed, "control part does not verify");
  }
  const wire::Control* control = wire::GetControl(aligned.data());
  if (const Result<void> checked = check_body(*control); !checked) return checked.error();
  Message message;
  message.wire_bytes = size;
  message.body.type = control->body_type();
  message.body.value = wire::BodyUnion::UnPack(control->body(), control->body_type(), nullptr);
  const std::uint8_t* payload = bytes + kWireHeaderBytes + header->control_bytes;
  message.payload.assign(payload, payload + header->payload_bytes);
  message.payload_bytes = message.payload.size();
  return message;
}

}  // namespace mirage
