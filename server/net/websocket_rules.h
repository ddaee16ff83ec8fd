#pragma once
// What RFC 6455 says and the library leaves to us.

#include <cstddef>
#include <cstdint>
#include <string>

namespace mirage {

/// A handshake's key: 16 bytes as base64 (4.2.1).
bool is_upgrade_key(const std::string& key);

/// Body of a close frame: nothing, or a code that may be sent (7.4) and a reason.
bool is_close_body(const std::uint8_t* body, std::size_t bytes);

}  // namespace mirage
