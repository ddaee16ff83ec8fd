#pragma once
// oEmbed (oembed.com), without sockets: tells other sites how to show a link to the viewer.
//
//   GET /v1/oembed?url=ADDRESS[&maxwidth=PX][&maxheight=PX][&format=json]

#include <string>

#include "server/net/http_answer.h"

namespace mirage {

inline constexpr const char* kOembedPath = "/v1/oembed";
inline constexpr const char* kPageTitle = "Mirage";

/// Returns where the answer for the page of this server is.
std::string oembed_address(const std::string& address);
/// Returns the answer. `address`: of this server. 400 for a value that is not usable, 404 for a
/// link to elsewhere, 501 for another format than JSON.
HttpAnswer oembed_answer(const std::string& query, const std::string& address);

}  // namespace mirage
