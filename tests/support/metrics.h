#pragma once
// Metrics: the counters of a server that was started with --metrics.

#include <map>
#include <sstream>
#include <string>

#include "tests/support/process.h"
#include "tests/support/raw_peer.h"

namespace mirage::test {

/// Returns the server's counters by name, without the prefix.
inline std::map<std::string, double> metrics(const Server& server) {
  RawPeer peer(server.port());
  peer.say("GET /metrics HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n");
  std::string text;
  for (std::string part = peer.hear(); !part.empty(); part = peer.hear()) text += part;
  std::map<std::string, double> out;
  std::istringstream lines(text);
  const std::string prefix = "mirage_";
  for (std::string line; std::getline(lines, line);) {
    const std::size_t space = line.rfind(' ');
    if (line.rfind(prefix, 0) != 0 || space == std::string::npos) continue;
    out[line.substr(prefix.size(), space - prefix.size())] = std::stod(line.substr(space + 1));
  }
  return out;
}

}  // namespace mirage::test
