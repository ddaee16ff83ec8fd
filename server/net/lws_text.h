#pragma once
// Facts that libwebsockets knows about a connection, as text.

#include <libwebsockets.h>

#include <string>

#include "server/net/forwarded.h"

namespace mirage {

/// A header's text. A text too long for the buffer sets `whole` to false and is not cut. It still
/// counts as present, because a missing header could pass checks.
struct HeaderText {
  std::string text;
  bool there = false, whole = true;
};
HeaderText header(lws* wsi, lws_token_indexes token);

/// Returns the part of the address after the question mark, as it was sent but for what was
/// percent-encoded. Parts too long for any known name and value are left out.
std::string query_of(lws* wsi);

/// Returns the peer's address, or `unix`.
std::string peer_of(lws* wsi);

/// Returns what a request called, and who called, as far as trusted proxies tell. `tls`: this
/// server's own.
Called called_of(lws* wsi, bool tls, const TrustedProxies& proxies);

}  // namespace mirage
