#pragma once
// Framing table: what peers say in WebSocket packets, right and wrong, and the result (RFC 6455,
// section 5).

#include <string>
#include <vector>

namespace mirage::test {

/// A conversation with a client that has said hello.
struct FramingCase {
  std::string name;
  /// Bytes that are sent, each piece in a TCP packet of its own.
  std::vector<std::string> said;
  /// "open", after the answers: "pong N" of N bytes, "stats" to a request. "closed CODE", or
  /// "dropped" without a close packet, which the standard allows (7.1.7). "waits" for more.
  std::string comes_of_it;
  std::string why = "";  ///< set where the standard says something else
  bool complete = true;  ///< false: more would have to follow
};

std::vector<FramingCase> opcode_cases();
std::vector<FramingCase> control_cases();
std::vector<FramingCase> close_cases();
std::vector<FramingCase> length_cases();
std::vector<FramingCase> fragment_cases();
std::vector<FramingCase> chopped_cases();
std::vector<FramingCase> message_cases();

}  // namespace mirage::test
