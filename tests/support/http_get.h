#pragma once
// Requests by HTTP, written and read as they are on the wire.

#include <cstdlib>
#include <string>

#include "tests/support/process.h"
#include "tests/support/raw_peer.h"

namespace mirage::test {

struct Answer {
  int status = 0;
  std::string head, body;
};

/// Waits up to a minute between two parts: a picture takes its time where others are made before
/// it.
inline Answer read_answer(RawPeer& peer) {
  constexpr int kSeconds = 60;
  peer.wait_at_most(kSeconds);
  std::string text;
  for (std::string part = peer.hear(); !part.empty(); part = peer.hear()) text += part;
  const std::size_t end = text.find("\r\n\r\n");
  if (end == std::string::npos) return {};
  return {std::atoi(text.c_str() + 9), text.substr(0, end), text.substr(end + 4)};
}

/// Sends a request. `headers`: whole lines.
inline void ask(RawPeer& peer, const std::string& path, const std::string& headers = "",
                const std::string& host = "x") {
  peer.say("GET " + path + " HTTP/1.1\r\nHost: " + host + "\r\n" + headers +
           "Connection: close\r\n\r\n");
}

inline Answer get(const Server& server, const std::string& path, const std::string& headers = "",
                  const std::string& host = "x") {
  RawPeer peer(server.port());
  ask(peer, path, headers, host);
  return read_answer(peer);
}

/// Returns the value of an answer's ETag; empty: it has none.
inline std::string tag_of(const Answer& answer) {
  const std::size_t name = answer.head.find("ETag: \"");
  if (name == std::string::npos) return "";
  const std::size_t from = name + 6;
  return answer.head.substr(from, answer.head.find('"', from + 1) + 1 - from);
}

}  // namespace mirage::test
