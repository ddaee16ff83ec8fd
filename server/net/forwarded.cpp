#include "server/net/forwarded.h"

#include <arpa/inet.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <string_view>

namespace mirage {
namespace {

using Address = std::array<std::uint8_t, 16>;
constexpr int kMappedBits = 96;  // ::ffff:0:0/96 holds the addresses of IPv4

std::optional<Address> parse_address(const std::string& text) {
  Address out{};
  if (inet_pton(AF_INET6, text.c_str(), out.data()) == 1) return out;
  out.fill(0);
  out[10] = out[11] = 0xff;
  if (inet_pton(AF_INET, text.c_str(), out.data() + 12) == 1) return out;
  return std::nullopt;
}

bool starts_alike(const Address& a, const Address& b, int bits) {
  for (int i = 0; i < bits; ++i) {
    const auto byte = static_cast<std::size_t>(i / 8);
    if (((a[byte] ^ b[byte]) >> (7 - i % 8) & 1) != 0) return false;
  }
  return true;
}

std::string trimmed(std::string_view text) {
  const auto space = [](char c) { return c == ' ' || c == '\t'; };
  while (!text.empty() && space(text.front())) text.remove_prefix(1);
  while (!text.empty() && space(text.back())) text.remove_suffix(1);
  return std::string(text);
}

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> out;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find(at, begin), text.size());
    const std::string part = trimmed(std::string_view(text).substr(begin, end - begin));
    if (!part.empty()) out.push_back(part);
    begin = end + 1;
  }
  return out;
}

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// Returns the address in a node name: 192.0.2.1, 192.0.2.1:80, "[2001:db8::1]:80".
std::string bare_address(std::string node) {
  if (node.size() >= 2 && node.front() == '"' && node.back() == '"') {
    node = node.substr(1, node.size() - 2);
  }
  if (!node.empty() && node.front() == '[') return node.substr(1, node.find(']') - 1);
  const bool one_colon = std::count(node.begin(), node.end(), ':') == 1;
  return one_colon ? node.substr(0, node.find(':')) : node;
}

/// Returns the value of a parameter in an element of Forwarded, such as for=192.0.2.1;proto=https.
std::string parameter(const std::string& element, const std::string& name) {
  for (const std::string& pair : split(element, ';')) {
    const std::size_t equals = pair.find('=');
    if (equals == std::string::npos || lower_case(trimmed(pair.substr(0, equals))) != name)
      continue;
    std::string value = trimmed(pair.substr(equals + 1));
    if (value.size() >= 2 && value.front() == '"') value = value.substr(1, value.size() - 2);
    return value;
  }
  return "";
}

std::string first_of(const std::string& list) {
  const std::vector<std::string> parts = split(list, ',');
  return parts.empty() ? "" : parts.front();
}

/// Each proxy adds the address of its own peer at the end. So the caller is the last one that is no
/// trusted proxy; what is before it may be invented.
std::string caller_of(const std::vector<std::string>& nodes, const std::string& peer,
                      const TrustedProxies& proxies) {
  std::string caller = peer;
  for (auto node = nodes.rbegin(); node != nodes.rend(); ++node) {
    const std::string address = bare_address(*node);
    if (!parse_address(address)) break;
    caller = address;
    if (!proxies.trusts(address)) break;
  }
  return caller;
}

}  // namespace

TrustedProxies::TrustedProxies() {
  for (const char* own : {"127.0.0.0/8", "::1/128"}) {
    if (!add(own)) networks_.clear();
  }
}

Result<void> TrustedProxies::add(const std::string& network) {
  if (network == "none") {
    networks_.clear();
    unix_socket_ = false;
    return {};
  }
  const std::size_t slash = network.find('/');
  const std::string name = network.substr(0, slash);
  const std::optional<Address> address = parse_address(name);
  const bool four = name.find(':') == std::string::npos;
  const int whole = four ? 128 - kMappedBits : 128;
  const std::string text =
      slash == std::string::npos ? std::to_string(whole) : network.substr(slash + 1);
  const bool digits = !text.empty() && text.size() <= 3 &&
                      text.find_first_not_of("0123456789") == std::string::npos;
  const int bits = digits ? std::stoi(text) : whole + 1;
  if (!address || bits > whole) {
    return make_error(ErrorId::kUsage, "--trust-proxy: '" + network + "' is no network",
                      "an address such as 10.0.0.0/8, 192.0.2.7 or 2001:db8::/32, or none");
  }
  networks_.push_back({*address, four ? bits + kMappedBits : bits});
  return {};
}

bool TrustedProxies::trusts(const std::string& address) const {
  if (address == "unix") return unix_socket_;
  const std::optional<Address> number = parse_address(address);
  return number && std::any_of(networks_.begin(), networks_.end(), [&](const Network& network) {
           return starts_alike(*number, network.address, network.bits);
         });
}

Called called_by(const std::string& peer, bool tls, const ForwardingHeaders& headers,
                 const TrustedProxies& proxies) {
  Called out{headers.host, tls, peer};
  if (!proxies.trusts(peer)) return out;
  std::string host = first_of(headers.forwarded_host), proto = first_of(headers.proto);
  std::vector<std::string> nodes = split(headers.for_, ',');
  if (!headers.forwarded.empty()) {
    const std::vector<std::string> elements = split(headers.forwarded, ',');
    if (const std::string told = parameter(elements.front(), "host"); !told.empty()) host = told;
    if (const std::string told = parameter(elements.front(), "proto"); !told.empty()) proto = told;
    nodes.clear();
    for (const std::string& element : elements) nodes.push_back(parameter(element, "for"));
  }
  if (!host.empty()) out.host = host;
  proto = lower_case(proto);
  if (proto == "https" || proto == "wss") out.tls = true;
  if (proto == "http" || proto == "ws") out.tls = false;
  out.address = caller_of(nodes, peer, proxies);
  return out;
}

}  // namespace mirage
