#include "server/net/listen_address.h"

#include <ifaddrs.h>
#include <net/if.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>
#include <memory>

namespace mirage {
namespace {

Error no_address(const std::string& text) {
  return make_error(ErrorId::kUsage,
                    "--listen takes HOST:PORT, [IPv6]:PORT or unix:PATH, not '" + text + "'",
                    "for example 127.0.0.1:9870, or :0 for any free port after a host");
}

// Returns the first address of this family; empty: the name has none.
std::string first_address(const std::string& host, int family) {
  addrinfo hints{};
  hints.ai_family = family;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (getaddrinfo(host.c_str(), nullptr, &hints, &found) != 0) return "";
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> owner(found, freeaddrinfo);
  char text[NI_MAXHOST] = {};
  const int failed = getnameinfo(found->ai_addr, found->ai_addrlen, text, sizeof(text), nullptr, 0,
                                 NI_NUMERICHOST);
  return failed ? "" : text;
}

constexpr std::size_t kMostShown = 8;  // addresses of a machine

// Returns the numeric addresses of the interfaces that are up, without loopback and link-local
// ones, which other machines cannot open.
std::vector<std::string> interface_addresses(int family) {
  ifaddrs* all = nullptr;
  if (getifaddrs(&all) != 0) return {};
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(all, freeifaddrs);
  std::vector<std::string> out;
  for (const ifaddrs* one = all; one != nullptr; one = one->ifa_next) {
    const bool up = (one->ifa_flags & IFF_UP) != 0 && (one->ifa_flags & IFF_LOOPBACK) == 0;
    if (!up || one->ifa_addr == nullptr || one->ifa_addr->sa_family != family) continue;
    const socklen_t size = family == AF_INET ? sizeof(sockaddr_in) : sizeof(sockaddr_in6);
    char text[NI_MAXHOST] = {};
    if (getnameinfo(one->ifa_addr, size, text, sizeof(text), nullptr, 0, NI_NUMERICHOST) != 0) {
      continue;
    }
    const std::string host = text;
    if (host.rfind("fe80:", 0) != 0 && host.rfind("169.254.", 0) != 0) out.push_back(host);
  }
  return out;
}

bool somebody_answers(const sockaddr_un& address) {
  const int probe = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const bool answers =
      connect(probe, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  ::close(probe);
  return answers;
}

}  // namespace

std::string ListenAddress::url(bool tls, int taken_port) const {
  if (!socket_path.empty()) return "unix:" + socket_path;
  const bool v6 = host.find(':') != std::string::npos;
  return std::string(tls ? "wss://" : "ws://") + (v6 ? "[" + host + "]" : host) + ":" +
         std::to_string(taken_port);
}

std::vector<std::string> page_urls(const ListenAddress& address, bool tls, int taken_port) {
  if (!address.socket_path.empty()) return {};
  std::vector<std::string> hosts;
  const bool v4 = address.host == "0.0.0.0", both = address.host == "::";
  if (v4 || both) {
    hosts = interface_addresses(AF_INET);
    if (both) {
      for (std::string& host : interface_addresses(AF_INET6)) hosts.push_back(std::move(host));
    }
    if (hosts.empty()) hosts = {"127.0.0.1"};
  } else {
    hosts = {address.host};
  }
  std::vector<std::string> out;
  for (const std::string& host : hosts) {
    if (out.size() == kMostShown) break;
    const std::string name = host.find(':') == std::string::npos ? host : "[" + host + "]";
    out.push_back(std::string(tls ? "https://" : "http://") + name + ":" +
                  std::to_string(taken_port) + "/");
  }
  return out;
}

Result<ListenAddress> parse_listen(const std::string& text) {
  ListenAddress out;
  if (text.rfind("unix:", 0) == 0) {
    out.socket_path = text.substr(5);
    if (out.socket_path.empty() || out.socket_path.size() >= sizeof(sockaddr_un::sun_path)) {
      return no_address(text);
    }
    return out;
  }
  const std::size_t colon = text.rfind(':');
  const std::string port = colon == std::string::npos ? "" : text.substr(colon + 1);
  const bool digits = !port.empty() && port.size() <= 5 &&
                      port.find_first_not_of("0123456789") == std::string::npos;
  if (!digits || std::stoi(port) > 65535) return no_address(text);
  out.port = std::stoi(port);
  out.host = text.substr(0, colon);
  const bool bracketed = out.host.size() > 2 && out.host.front() == '[' && out.host.back() == ']';
  if (bracketed) out.host = out.host.substr(1, out.host.size() - 2);
  const bool has_colon = out.host.find(':') != std::string::npos;
  if (out.host.empty() || has_colon != bracketed || out.host.find('/') != std::string::npos) {
    return no_address(text);
  }
  return out;
}

Result<std::string> numeric_address(const std::string& host) {
  for (const int family : {AF_INET, AF_INET6}) {
    std::string address = first_address(host, family);
    if (!address.empty()) return address;
  }
  return make_error(ErrorId::kNetworkListen, "nobody knows the host '" + host + "'",
                    "--listen takes a name or an address of this machine");
}

Result<void> free_socket_path(const std::string& path) {
  struct stat about {};
  if (lstat(path.c_str(), &about) != 0) return {};
  if (!S_ISSOCK(about.st_mode)) {
    return make_error(ErrorId::kNetworkListen, "'" + path + "' is there and is no socket");
  }
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, path.c_str(), sizeof(address.sun_path) - 1);
  if (somebody_answers(address)) {
    return make_error(ErrorId::kNetworkListen, "a server listens on unix:" + path + " already");
  }
  unlink(path.c_str());
  return {};
}

bool is_loopback(const ListenAddress& address) {
  if (!address.socket_path.empty()) return true;
  return address.host == "::1" || address.host == "localhost" ||
         address.host.compare(0, 4, "127.") == 0;
}

}  // namespace mirage
