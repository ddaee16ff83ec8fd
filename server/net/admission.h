#pragma once
// Admission of connections: an address with too many wrong hellos must wait.

#include <cstdint>
#include <deque>
#include <map>
#include <string>

namespace mirage {

class Admission {
 public:
  /// Wrong hellos within a second after which an address is refused.
  static constexpr std::size_t kMostFailures = 10;
  static constexpr std::int64_t kWindowUs = 1'000'000;

  bool may_connect(const std::string& address, std::int64_t now_us);
  /// Notes a wrong token, or a first message that is no hello.
  void note_failure(const std::string& address, std::int64_t now_us);

 private:
  void forget_old(std::int64_t now_us);

  std::map<std::string, std::deque<std::int64_t>> failures_us_;
};

/// True if a browser's Origin is the host that it connects to. `origin`: scheme://HOST[:PORT];
/// `host`: as in the Host header. A malformed Origin gives false.
bool same_origin(const std::string& origin, const std::string& host, bool tls);

}  // namespace mirage
