#pragma once
// Downloads by HTTP, without sockets: parses requests and builds answers.
//
//   GET /v1/downloads                      what may be had: {"bake":true,"folder":true}
//   GET /v1/download?kind=bake[&object=NUMBER][&target=NAME][&grid=N][&size=TEXELS]
//   GET /v1/download?kind=folder[&eye=X,Y,Z&look=X,Y,Z][&reach=METRES][&mb=N]
//
// A download takes seconds to minutes. Until it is made, the answer is 202 with what is being done,
// as JSON; the same address is asked again, and answers with the zip archive in the end.

#include <string>
#include <variant>

#include "server/download/download_desk.h"
#include "server/net/http_answer.h"

namespace mirage {

inline constexpr const char* kDownloadsPath = "/v1/downloads";
inline constexpr const char* kDownloadPath = "/v1/download";

/// Returns the wanted download, or the answer that refuses: 400 for a value that is not usable,
/// which it names; 401 without a valid token.
std::variant<DownloadRequest, HttpAnswer> read_download(const HttpRequest& request,
                                                        const Access& access, std::int64_t now_s);
/// Returns the answer to whoever asks what may be had. `desk` null: nothing.
HttpAnswer downloads_answer(const DownloadDesk* desk);
/// Returns the answer for a download that is not made yet, or could not be made.
HttpAnswer download_answer(const DownloadState& state);
/// Returns the header lines of a finished one.
std::string download_headers(const std::string& name);

}  // namespace mirage
