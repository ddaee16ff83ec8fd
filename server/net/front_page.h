#pragma once
// Front page: index.html with what only the running server knows, without sockets: a picture of the
// scene's home view, and what other sites show of a link to it.
//
// The page's file has two places for it, which are comments: <!--head--> and <!--poster-->.

#include <cstdint>
#include <memory>
#include <string>

#include "protocol/base/bytes.h"
#include "server/session/picture_request.h"

namespace mirage {

/// Shape of a poster: phones are held upright.
enum class PosterShape : std::uint8_t { kWide, kTall };
/// Returns the shape for a browser, from its User-Agent header.
PosterShape poster_shape(const std::string& user_agent);
/// Returns the home view as the page carries it: an impostor of few bytes, made when the server is
/// idle.
PictureRequest poster_request(PosterShape shape);

/// Returns the page with what is told of it to other sites, and its poster. `address`: of this
/// server, empty if unknown; `poster`: null if there is none.
std::string front_page(const std::string& page, const std::string& address, PosterShape shape,
                       const std::shared_ptr<const Bytes>& poster);
/// Returns the text as a gzip file.
std::string gzipped(const std::string& text);

}  // namespace mirage
