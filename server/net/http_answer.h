#pragma once
// Requests and answers by HTTP as text, without sockets; and who may get what.

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "server/session/access.h"

namespace mirage {

struct HttpRequest {
  std::string path;           ///< from its first slash, without the query
  std::string query;          ///< part after the question mark
  std::string authorization;  ///< the header's value
};

struct HttpAnswer {
  unsigned int status = 200;
  std::string type = "text/plain";
  std::string headers;  ///< whole header lines
  std::string body;
};

/// Returns an answer that says why there is nothing.
HttpAnswer refusal(unsigned int status, const std::string& text, const std::string& headers = "");
/// Returns the answer to whoever has to come back in a second.
HttpAnswer busy();

/// Returns names and values of `a=1&b=2`, in their order.
std::vector<std::pair<std::string, std::string>> query_values(const std::string& query);
/// Returns the value of `name`; empty: it is absent.
std::string query_value(const std::string& query, const std::string& name);

/// Returns the rights of a request: by a token (Authorization: Bearer TOKEN), or because what lies
/// below `path` is signed in its query. Error kAuth.
Result<Grant> grant_of(const HttpRequest& request, const std::string& path, const Access& access,
                       std::int64_t now_s);

}  // namespace mirage
