#include "server/net/download_http.h"

#include <nlohmann/json.hpp>

namespace mirage {
namespace {

const char* const kAgain = "Retry-After: 1\r\nCache-Control: no-store\r\n";

}  // namespace

std::variant<DownloadRequest, HttpAnswer> read_download(const HttpRequest& request,
                                                        const Access& access, std::int64_t now_s) {
  const Result<Grant> grant = grant_of(request, request.path, access, now_s);
  if (!grant) return refusal(401, grant.error().text, "WWW-Authenticate: Bearer\r\n");
  auto values = query_values(request.query);
  std::erase_if(values, [](const auto& one) {  // grant_of() has checked them
    return one.first == "until" || one.first == "signature";
  });
  auto read = read_download_request(values);
  if (const auto* wrong = std::get_if<std::string>(&read)) return refusal(400, *wrong);
  return std::get<DownloadRequest>(read);
}

HttpAnswer downloads_answer(const DownloadDesk* desk) {
  const auto has = [&](const DownloadRequest& one) { return desk && desk->makes(one); };
  const nlohmann::ordered_json out = {{"bake", has(BakeDownload{})},
                                      {"folder", has(FolderDownload{})}};
  return {200, "application/json", "Cache-Control: no-store\r\n", out.dump() + "\n"};
}

HttpAnswer download_answer(const DownloadState& state) {
  switch (state.stage) {
    case DownloadState::Stage::kFull:
      return refusal(503, "too many downloads wait already: come back in a minute",
                     "Retry-After: 60\r\n");
    case DownloadState::Stage::kFailed:
      return refusal(state.error.id == ErrorId::kUsage ? 400 : 500, state.error.text);
    default:
      break;
  }
  nlohmann::ordered_json out = {{"state", "waiting"}, {"ahead", state.ahead}};
  if (state.stage == DownloadState::Stage::kMaking) {
    out = {{"state", "making"}, {"line", state.line}};
  }
  return {202, "application/json", kAgain, out.dump() + "\n"};
}

std::string download_headers(const std::string& name) {
  return "Content-Disposition: attachment; filename=\"" + name +
         "\"\r\nCache-Control: no-store\r\n";
}

}  // namespace mirage
