#pragma once
// Who may connect: an address whose hellos were wrong too often waits.

#include <cstdint>
#include <deque>
#include <map>
#include <string>

namespace mirage {

class Admission {
 public:
  /// Wrong hellos of an address within a second, before it is sent away.
  static constexpr std::size_t kMostFailures = 10;
  static constexpr std::int64_t kWindowUs = 1'000'000;

  bool may_connect(const std::string& address, std::int64_t now_us);
  /// It said a wrong token, or something that is no hello.
  void note_failure(const std::string& address, std::int64_t now_us);

 private:
  void forget_old(std::int64_t now_us);

  std::map<std::string, std::deque<std::int64_t>> failures_us_;
};

/// Whether a browser's Origin is the host that it asks: `origin` scheme://HOST[:PORT], `host` as in
/// the Host header. What is no Origin of that form is not.
bool same_origin(const std::string& origin, const std::string& host, bool tls);

}  // namespace mirage
