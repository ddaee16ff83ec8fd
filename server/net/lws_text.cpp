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

std::string peer_of(lws* wsi) {
  char name[64] = {};
  lws_get_peer_simple(wsi, name, sizeof(name));
  return name[0] != '\0' ? name : "unix";
}

}  // namespace mirage
