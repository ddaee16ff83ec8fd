#pragma once
// What libwebsockets knows of a connection, as text.

#include <libwebsockets.h>

#include <string>

namespace mirage {

/// What does not fit is given as such, never cut: what is read as none would be let pass.
struct HeaderText {
  std::string text;
  bool there = false, whole = true;
};
HeaderText header(lws* wsi, lws_token_indexes token);

/// The peer's address, or `unix`.
std::string peer_of(lws* wsi);

}  // namespace mirage
