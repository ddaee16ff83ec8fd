#include "client/native/server_url.h"

#include <charconv>
#include <sstream>

#include "protocol/base/limits.h"

namespace mirage {
namespace {

constexpr std::size_t kMaxSocketPath = 107;  // sockaddr_un

bool starts_with(const std::string& text, const std::string& head) {
  return text.rfind(head, 0) == 0;
}

Error no_address(const std::string& url) {
  return make_error(ErrorId::kUsage, "'" + url + "' is no server address",
                    "ws://HOST:PORT or unix:PATH, as the server's ready line prints it, or an "
                    "address as a browser shows it");
}

/// Decodes %XX and '+'. An escape that is none stays as it is.
std::string decoded(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned int byte = 0;
    const char* const digits = text.data() + i + 1;
    const bool escape = text[i] == '%' && i + 2 < text.size() &&
                        std::from_chars(digits, digits + 2, byte, 16).ptr == digits + 2;
    if (escape) i += 2;
    out += escape ? static_cast<char>(byte) : text[i] == '+' ? ' ' : text[i];
  }
  return out;
}

SceneChoice read_choice(const std::string& query) {
  SceneChoice out;
  std::istringstream parts(query);
  for (std::string part; std::getline(parts, part, '&');) {
    if (starts_with(part, "clip=")) out.clip = decoded(part.substr(5));
    if (starts_with(part, "variant=")) out.variant = decoded(part.substr(8));
  }
  for (std::string* const name : {&out.clip, &out.variant}) {
    if (name->size() > limits::kMaxChoiceBytes) name->clear();  // no scene has it
  }
  return out;
}

struct Scheme {
  const char* head;
  bool tls;
  int port;
};
constexpr Scheme kSchemes[] = {{"ws://", false, 9870},
                               {"wss://", true, 9870},
                               {"http://", false, 80},
                               {"https://", true, 443}};

}  // namespace

std::string ServerUrl::host_header() const {
  if (unix_socket) return "localhost";
  const std::string name = host.find(':') == std::string::npos ? host : "[" + host + "]";
  return port == (tls ? 443 : 80) ? name : name + ":" + std::to_string(port);
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
  for (const Scheme& scheme : kSchemes) {
    if (!starts_with(url, scheme.head)) continue;
    rest = url.substr(std::string(scheme.head).size());
    out.tls = scheme.tls;
    out.port = scheme.port;
  }
  rest = rest.substr(0, rest.find('#'));
  if (const std::size_t mark = rest.find('?'); mark != std::string::npos) {
    out.choice = read_choice(rest.substr(mark + 1));
    rest.resize(mark);
  }
  if (rest.find("://") != std::string::npos) return no_address(url);
  if (const std::size_t slash = rest.find('/'); slash != std::string::npos) {
    out.path = rest.substr(slash);
    rest.resize(slash);
  }
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
  if (out.host.empty() || out.port < 1 || out.port > 65535) return no_address(url);
  return out;
}

}  // namespace mirage
