#pragma once
// Message view: a message read in place. It makes the checks of decode_message() without copying
// payload or tables.

#include "protocol/wire/message.h"

namespace mirage {

class MessageView {
 public:
  /// Reads a message. `bytes` must outlive the view. The control part is copied into `scratch` for
  /// its alignment; that must outlive the view as well. Errors: kWireMalformed, kWireVersion,
  /// kWireLimit, kWireValue.
  static Result<MessageView> create(const std::uint8_t* bytes, std::size_t size,
                                    std::vector<std::uint64_t>& scratch);

  const wire::Control& control() const { return *control_; }
  wire::Body type() const { return control_->body_type(); }
  const std::uint8_t* payload() const { return payload_; }
  std::size_t payload_bytes() const { return payload_bytes_; }

 private:
  const wire::Control* control_ = nullptr;
  const std::uint8_t* payload_ = nullptr;
  std::size_t payload_bytes_ = 0;
};

}  // namespace mirage
