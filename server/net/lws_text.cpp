#include "server/net/lws_text.h"

namespace mirage {

HeaderText header(lws* wsi, lws_token_indexes token) {
  HeaderText out;
  const int length = lws_hdr_total_length(wsi, token);
  if (length <= 0) return out;
  out.there = true;
  char text[512] = {};
  const int n = lws_hdr_copy(wsi, text, sizeof(text), token);
  out.whole = n >= 0;
  if (n > 0) out.text.assign(text, static_cast<std::size_t>(n));
  return out;
}

// lws_hdr_copy() would put commas between the parts.
std::string query_of(lws* wsi) {
  std::string out;
  char text[512] = {};
  for (int part = 0;; ++part) {
    const int n = lws_hdr_copy_fragment(wsi, text, sizeof(text), WSI_TOKEN_HTTP_URI_ARGS, part);
    if (n == -1) return out;  // there are no more
    if (n < 0) continue;      // it is too long
    if (!out.empty()) out += '&';
    out.append(text, static_cast<std::size_t>(n));
  }
}

namespace {

/// Returns the value of a header that libwebsockets has no token for; `name` in small letters, with
/// its colon. Empty: there is none, or it is too long.
std::string other_header(lws* wsi, const std::string& name) {
  char text[512] = {};
  const int n =
      lws_hdr_custom_copy(wsi, text, sizeof(text), name.c_str(), static_cast<int>(name.size()));
  return n > 0 ? std::string(text, static_cast<std::size_t>(n)) : "";
}

std::string whole_header(lws* wsi, lws_token_indexes token) {
  const HeaderText found = header(wsi, token);
  return found.whole ? found.text : "";
}

}  // namespace

Called called_of(lws* wsi, bool tls, const TrustedProxies& proxies) {
  ForwardingHeaders headers;
  headers.host = whole_header(wsi, WSI_TOKEN_HOST);
  headers.for_ = whole_header(wsi, WSI_TOKEN_X_FORWARDED_FOR);
  headers.forwarded = other_header(wsi, "forwarded:");
  headers.proto = other_header(wsi, "x-forwarded-proto:");
  headers.forwarded_host = other_header(wsi, "x-forwarded-host:");
  return called_by(peer_of(wsi), tls, headers, proxies);
}

std::string peer_of(lws* wsi) {
  char name[64] = {};
  lws_get_peer_simple(wsi, name, sizeof(name));
  return name[0] != '\0' ? name : "unix";
}

}  // namespace mirage
