#include "server/net/http_answer.h"

#include <algorithm>
#include <charconv>

namespace mirage {

HttpAnswer refusal(unsigned int status, const std::string& text, const std::string& headers) {
  return {status, "text/plain", headers, text + "\n"};
}

HttpAnswer busy() { return refusal(503, "busy: come back in a second", "Retry-After: 1\r\n"); }

std::vector<std::pair<std::string, std::string>> query_values(const std::string& query) {
  std::vector<std::pair<std::string, std::string>> out;
  for (std::size_t from = 0; from < query.size();) {
    const std::size_t end = std::min(query.find('&', from), query.size());
    const std::string part = query.substr(from, end - from);
    const std::size_t equals = std::min(part.find('='), part.size());
    const std::string value = equals < part.size() ? part.substr(equals + 1) : "";
    if (!part.empty()) out.emplace_back(part.substr(0, equals), value);
    from = end + 1;
  }
  return out;
}

std::string query_value(const std::string& query, const std::string& name) {
  for (const auto& [key, value] : query_values(query)) {
    if (key == name) return value;
  }
  return "";
}

Result<Grant> grant_of(const HttpRequest& request, const std::string& path, const Access& access,
                       std::int64_t now_s) {
  const std::string bearer = "Bearer ";
  if (access.open()) return Grant{};
  if (request.authorization.rfind(bearer, 0) == 0) {
    return access.check(request.authorization.substr(bearer.size()), now_s);
  }
  const std::string until = query_value(request.query, "until");
  std::int64_t until_s = 0;
  std::from_chars(until.data(), until.data() + until.size(), until_s);
  const Result<void> signed_well =
      access.check_path(path, until_s, query_value(request.query, "signature"), now_s);
  if (!signed_well) return signed_well.error();
  return Grant{};
}

}  // namespace mirage
