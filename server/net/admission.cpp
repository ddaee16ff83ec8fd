#include "server/net/admission.h"

#include <algorithm>
#include <cctype>

namespace mirage {
namespace {
constexpr std::size_t kMostAddresses = 4096;

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}
}  // namespace

void Admission::forget_old(std::int64_t now_us) {
  for (auto at = failures_us_.begin(); at != failures_us_.end();) {
    std::deque<std::int64_t>& times = at->second;
    while (!times.empty() && now_us - times.front() > kWindowUs) times.pop_front();
    at = times.empty() ? failures_us_.erase(at) : std::next(at);
  }
}

bool Admission::may_connect(const std::string& address, std::int64_t now_us) {
  const auto at = failures_us_.find(address);
  if (at == failures_us_.end()) return true;
  std::deque<std::int64_t>& times = at->second;
  while (!times.empty() && now_us - times.front() > kWindowUs) times.pop_front();
  const bool may = times.size() < kMostFailures;
  if (times.empty()) failures_us_.erase(at);
  return may;
}

void Admission::note_failure(const std::string& address, std::int64_t now_us) {
  if (failures_us_.size() >= kMostAddresses) forget_old(now_us);
  if (failures_us_.size() >= kMostAddresses) failures_us_.erase(failures_us_.begin());
  std::deque<std::int64_t>& times = failures_us_[address];
  times.push_back(now_us);
  if (times.size() > kMostFailures) times.pop_front();
}

bool same_origin(const std::string& origin, const std::string& host, bool tls) {
  const std::string scheme = tls ? "https://" : "http://";
  const std::string port = tls ? ":443" : ":80";
  const std::string from = lower(origin), to = lower(host);
  if (to.empty() || from.compare(0, scheme.size(), scheme) != 0) return false;
  const std::string name = from.substr(scheme.size());
  return name == to || name + port == to || name == to + port;
}

}  // namespace mirage
