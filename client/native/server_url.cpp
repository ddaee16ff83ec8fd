#include "client/native/server_url.h"

namespace mirage {
namespace {

constexpr std::size_t kMaxSocketPath = 107;  // sockaddr_un

bool starts_with(const std::string& text, const std::string& head) {
  return text.rfind(head, 0) == 0;
}

Error no_address(const std::string& url) {
  return make_error(ErrorId::kUsage, "'" + url + "' is no server address",
                    "ws://HOST:PORT or unix:PATH, as the server's ready line prints it");
}

}  // namespace

std::string ServerUrl::host_header() const {
  if (unix_socket) return "localhost";
  return host.find(':') == std::string::npos ? host : "[" + host + "]";
}

Result<ServerUrl> parse_url(const std::string& url) {
  ServerUrl out;
  std::string rest = url;
  if (starts_with(rest, "unix:")) {
    out.unix_socket = true;
    out.host = rest.substr(5);
    if (out.host.empty() || out.host.size() > kMaxSocketPath) return no_address(url);
    return out;
  }
  if (starts_with(rest, "ws://")) {
    rest = rest.substr(5);
  } else if (starts_with(rest, "wss://")) {
    rest = rest.substr(6);
    out.tls = true;
  } else if (rest.find("://") != std::string::npos) {
    return no_address(url);
  }
  if (!rest.empty() && rest.back() == '/') rest.pop_back();
  const bool bracketed = starts_with(rest, "[");
  const std::size_t end = bracketed ? rest.find(']') : rest.find(':');
  if (bracketed && end == std::string::npos) return no_address(url);
  out.host = bracketed ? rest.substr(1, end - 1) : rest.substr(0, end);
  const std::string tail = end == std::string::npos ? "" : rest.substr(bracketed ? end + 1 : end);
  if (!tail.empty()) {
    const std::string port = tail.substr(1);
    const bool digits = tail[0] == ':' && !port.empty() && port.size() <= 5 &&
                        port.find_first_not_of("0123456789") == std::string::npos;
    out.port = digits ? std::stoi(port) : 0;
  }
  if (out.host.empty() || out.port < 1 || out.port > 65535 ||
      out.host.find('/') != std::string::npos) {
    return no_address(url);
  }
  return out;
}

}  // namespace mirage
