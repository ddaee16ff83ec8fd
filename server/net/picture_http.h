#pragma once
// Pictures by HTTP, without sockets: parses requests and builds answers.
//
//   GET /v1/picture[?eye=X,Y,Z&look=X,Y,Z][&size=WxH][&format=webp|png|jpeg][&samples=N]
//                  [&light=AZIMUTH,ELEVATION][&fov=DEGREES][&until=SECONDS&signature=HEX]
//   GET /v1/impostor, with the same values but the format: the picture with coarse depth, as
//                  server/tile/impostor_file.h describes it
//
// The picture is the full render; it tells no more of the geometry than view tiles do, whose depth
// is finer than that of an impostor. Without a camera it is seen from the scene's home view.

#include <cstdint>
#include <string>
#include <variant>

#include "server/net/http_answer.h"
#include "server/session/picture_request.h"

namespace mirage {

inline constexpr const char* kPicturePath = "/v1/picture";
inline constexpr const char* kImpostorPath = "/v1/impostor";

/// Returns the wanted picture, or impostor by the request's path, or the answer that refuses: 400
/// for a value that is not usable, which it names; 401 without a valid token or signature.
std::variant<PictureRequest, HttpAnswer> read_picture_request(const HttpRequest& request,
                                                              const Access& access,
                                                              std::int64_t now_s);
/// Returns the tag of a picture: equal ones have equal tags, on every server of this revision.
std::string picture_tag(const PictureRequest& picture, std::uint64_t revision);
/// Returns the answer for a picture. `open`: no token is needed.
HttpAnswer picture_answer(const GotPicture& got, PictureFormat format, const std::string& tag,
                          bool open);
/// Returns the answer to whoever has the picture already.
HttpAnswer picture_unchanged(const std::string& tag, bool open);

}  // namespace mirage
