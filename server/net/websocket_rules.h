#pragma once
// Rules of RFC 6455 that the library leaves to its user.

#include <cstddef>
#include <cstdint>
#include <string>

namespace mirage {

/// True if `key` is a handshake's key: 16 bytes as base64 (4.2.1).
bool is_upgrade_key(const std::string& key);

/// True for a valid body of a close packet: empty, or a sendable code (7.4) and a reason.
bool is_close_body(const std::uint8_t* body, std::size_t bytes);

}  // namespace mirage
