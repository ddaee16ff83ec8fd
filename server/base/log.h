#pragma once
// The server's log on standard error: text, or an object of JSON a line. What peers can cause as
// often as they like may not fill a disk: of a second's lines those beyond the 50th are left out
// and counted; errors never.

#include <cstdint>
#include <string>

namespace mirage {

enum class LogFormat : std::uint8_t { kText, kJson };

void set_up_log(LogFormat format);

/// While there is one, lines of this thread are about this connection: JSON has its id and address.
class LogAbout {
 public:
  LogAbout(std::uint64_t connection, const std::string& address);
  ~LogAbout();
  LogAbout(const LogAbout&) = delete;
  LogAbout& operator=(const LogAbout&) = delete;
};

}  // namespace mirage
