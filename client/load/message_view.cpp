#include "client/load/message_view.h"

#include <cstring>

#include "protocol/wire/message_check.h"

namespace mirage {

Result<MessageView> MessageView::create(const std::uint8_t* bytes, std::size_t size,
                                        std::vector<std::uint64_t>& scratch) {
  Result<PacketHeader> header = read_packet_header(bytes, size);
  if (!header) return header.error();
  if (header->kind != PacketKind::kMessage || header->control_bytes == 0) {
    return make_error(ErrorId::kWireMalformed, "message has no control part");
  }
  const std::size_t control_bytes = header->control_bytes;
  if (control_bytes > limits::kMaxControlBytes) {
    return make_error(ErrorId::kWireLimit, "control part is larger than allowed");
  }
  scratch.resize(control_bytes / sizeof(std::uint64_t) + 1);
  std::memcpy(scratch.data(), bytes + kWireHeaderBytes, control_bytes);
  const auto* aligned = reinterpret_cast<const std::uint8_t*>(scratch.data());
  flatbuffers::Verifier verifier(aligned, control_bytes, 8, 4096);
  if (!wire::VerifyControlBuffer(verifier)) {
    return make_error(ErrorId::kWireMalformed, "control part does not verify");
  }
  MessageView view;
  view.control_ = wire::GetControl(aligned);
  if (const Result<void> checked = check_body(*view.control_); !checked) return checked.error();
  view.payload_ = bytes + kWireHeaderBytes + control_bytes;
  view.payload_bytes_ = header->payload_bytes;
  return view;
}

}  // namespace mirage
