#pragma once
// Forwarded: what a browser or viewer called, and from where, if a proxy stands between. Only
// proxies that are trusted are believed.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "protocol/base/result.h"

namespace mirage {

class TrustedProxies {
 public:
  /// Trusts proxies on this machine.
  TrustedProxies();
  /// Adds a network, ADDRESS or ADDRESS/LEN, IPv4 or IPv6. `none` removes all, those of this
  /// machine included. Error kUsage.
  Result<void> add(const std::string& network);
  /// `address`: as numbers, or "unix" for the peer at a unix socket.
  bool trusts(const std::string& address) const;

 private:
  struct Network {
    std::array<std::uint8_t, 16> address{};  ///< IPv4 as in ::ffff:0:0/96
    int bits = 128;
  };
  bool unix_socket_ = true;
  std::vector<Network> networks_;
};

/// Headers of a request, empty if it has none.
struct ForwardingHeaders {
  std::string host;                         ///< Host
  std::string forwarded;                    ///< Forwarded (RFC 7239)
  std::string for_, proto, forwarded_host;  ///< X-Forwarded-For, -Proto, -Host
};

/// Called: what the browser or viewer named to reach the server.
struct Called {
  std::string host;  ///< HOST[:PORT]
  bool tls = false;
  std::string address;  ///< of the one who called, as numbers
};

/// Returns what was called: the Host header and the peer, or what a trusted peer tells. `tls`: this
/// server's own.
Called called_by(const std::string& peer, bool tls, const ForwardingHeaders& headers,
                 const TrustedProxies& proxies);

}  // namespace mirage
