#pragma once
// What peers say in frames, right and wrong, and what comes of it (RFC 6455, section 5).

#include <string>
#include <vector>

namespace mirage::test {

/// One conversation with a client that has said its hello.
struct FramingCase {
  std::string name;
  /// What is said, each piece in a packet of its own.
  std::vector<std::string> said;
  /// "open", after what was answered: "pong N" of N bytes, "stats" to a request. "closed CODE", or
  /// "dropped" without a close frame, which the standard allows (7.1.7). "waits" for more.
  std::string comes_of_it;
  std::string why = "";  ///< where that is not what the standard says
  bool complete = true;  ///< false: more of it would have to come
};

std::vector<FramingCase> opcode_cases();
std::vector<FramingCase> control_cases();
std::vector<FramingCase> close_cases();
std::vector<FramingCase> length_cases();
std::vector<FramingCase> fragment_cases();
std::vector<FramingCase> chopped_cases();
std::vector<FramingCase> message_cases();

}  // namespace mirage::test
