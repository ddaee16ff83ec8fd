#pragma once
// The server's log on standard error: text, or one JSON object per line. Peers can cause some
// messages at will and must not fill a disk with them. Lines beyond the 50th of a second are left
// out and counted; errors are always written.

#include <cstdint>
#include <string>

namespace mirage {

enum class LogFormat : std::uint8_t { kText, kJson };

void set_up_log(LogFormat format);

/// While it exists, log lines of this thread belong to this connection: JSON lines carry its id and
/// address.
class LogAbout {
 public:
  LogAbout(std::uint64_t connection, const std::string& address);
  ~LogAbout();
  LogAbout(const LogAbout&) = delete;
  LogAbout& operator=(const LogAbout&) = delete;
};

}  // namespace mirage
