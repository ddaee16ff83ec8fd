#include "server/net/http_pages.h"

#include <fmt/format.h>
#include <libwebsockets.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <ctime>
#include <vector>

#include "server/base/counters.h"
#include "server/net/admission.h"
#include "server/net/download_http.h"
#include "server/net/endpoint_options.h"
#include "server/net/lws_text.h"
#include "server/net/metrics.h"
#include "server/net/oembed.h"
#include "server/net/picture_http.h"
#include "server/session/session.h"

namespace mirage {
namespace {

constexpr std::size_t kMostHeaderBytes = 4096;
const char* const kMetricsType = "text/plain; version=0.0.4";
constexpr std::size_t kFileChunkBytes = 16 * 1024;
constexpr int kFilePatienceS = 20;  // seconds for a client to take a chunk
const char* const kNoPage =
    "this is a Mirage server, without its page for browsers (scripts/web makes it, --web DIR names "
    "it): connect with mirage-view\n";
constexpr int kTilePatienceS = 15;  // seconds; longer than the hub's deadline
constexpr int kPicturePatienceS = 120;
constexpr std::int64_t kLookForGoneUs = 100'000;
constexpr int kMostPicturesOfOne = 32;  // that an address may wait for
constexpr std::size_t kMostFronts = 16;

// Adds header lines of the form `Name: value`.
bool add_headers(lws* wsi, const std::string& lines, unsigned char** at, unsigned char* end) {
  for (std::size_t from = 0; from < lines.size();) {
    const std::size_t colon = lines.find(": ", from), line = lines.find("\r\n", from);
    const std::string name = lines.substr(from, colon + 1 - from);
    const std::string value = lines.substr(colon + 2, line - colon - 2);
    if (lws_add_http_header_by_name(wsi, reinterpret_cast<const unsigned char*>(name.c_str()),
                                    reinterpret_cast<const unsigned char*>(value.data()),
                                    static_cast<int>(value.size()), at, end)) {
      return false;
    }
    from = line + 2;
  }
  return true;
}

int send(lws* wsi, const HttpAnswer& answer, bool head = false) {
  std::vector<std::uint8_t> buffer(LWS_PRE + std::max(kMostHeaderBytes, answer.body.size()));
  unsigned char* const start = buffer.data() + LWS_PRE;
  unsigned char* at = start;
  unsigned char* const end = start + kMostHeaderBytes;
  if (lws_add_http_common_headers(wsi, answer.status, answer.type.c_str(), answer.body.size(), &at,
                                  end) ||
      !add_headers(wsi, answer.headers, &at, end) ||
      lws_finalize_write_http_header(wsi, start, &at, end)) {
    return -1;
  }
  if (!answer.body.empty() && !head) {
    std::memcpy(start, answer.body.data(), answer.body.size());
    if (lws_write(wsi, start, answer.body.size(), LWS_WRITE_HTTP_FINAL) < 0) return -1;
  }
  return lws_http_transaction_completed(wsi) ? -1 : 0;
}

}  // namespace

void HttpPages::serve(SessionHub& hub, Counters& counters) {
  const HttpAnswer moved = refusal(503, "another scene", "Retry-After: 1\r\n");
  for (auto& [request, one] : std::exchange(waiting_, {})) give(one.wsi, *one.peer, moved);
  for (auto& [request, one] : std::exchange(pictures_, {})) give(one.wsi, *one.peer, moved);
  hub_ = &hub;
  counters_ = &counters;
  if (desk_) desk_->forget();
  fronts_.clear();
  for (auto& [shape, poster] : posters_) {
    poster = {};
    ask_poster(shape);
  }
}

int HttpPages::answer(lws* wsi, HttpPeer& peer, const std::string& path, bool stopping) {
  if (path.rfind(kTilePath, 0) == 0) return get_tile(wsi, peer, path);
  if (path == kPicturePath || path == kImpostorPath) return get_picture(wsi, peer, path);
  if (path == kOembedPath) return get_oembed(wsi);
  if (path == kDownloadsPath || path == kDownloadPath) return get_download(wsi, peer, path);
  const HeaderText accepted = header(wsi, WSI_TOKEN_HTTP_ACCEPT_ENCODING);
  const WebFile* const file = web_.find(path, accepted.text);
  if (!file) return send(wsi, page(path, stopping));
  return get_file(wsi, peer, *file);
}

std::string HttpPages::open_address(lws* wsi) const {
  if (!hub_->access().open() || !hub_->options().pictures) return {};
  return address_of(called_of(wsi, !options_.tls_cert.empty(), options_.proxies));
}

void HttpPages::ask_poster(PosterShape shape) {
  Poster& poster = posters_[shape];
  const bool may = hub_->access().open() && hub_->options().pictures;
  if (poster.request == 0 && may) poster.request = hub_->get(poster_request(shape));
}

int HttpPages::get_front(lws* wsi, const std::string& address, bool head) {
  const PosterShape shape = poster_shape(header(wsi, WSI_TOKEN_HTTP_USER_AGENT).text);
  ask_poster(shape);
  WebFile file = *web_.find("/", "");
  const bool small = accepts_encoding(header(wsi, WSI_TOKEN_HTTP_ACCEPT_ENCODING).text, "gzip");
  if (small) file.encoding = "gzip";
  if (fronts_.size() >= kMostFronts) fronts_.clear();
  std::string& front = fronts_[{address, shape, small}];
  if (front.empty()) {
    front = front_page(*file.body, address, shape, posters_[shape].file);
    if (small) front = gzipped(front);
  }
  const Called called = called_of(wsi, !options_.tls_cert.empty(), options_.proxies);
  const std::string headers = WebPages::headers(file, called.host, options_.embed_origins);
  return send(wsi, {200, file.type, headers, front}, head);
}

int HttpPages::get_oembed(lws* wsi) const {
  if (lws_hdr_total_length(wsi, WSI_TOKEN_GET_URI) <= 0) {
    return send(wsi, refusal(405, "only GET here", "Allow: GET\r\n"));
  }
  const std::string address = open_address(wsi);
  if (address.empty()) return send(wsi, refusal(403, "this server is not open to everybody"));
  return send(wsi, oembed_answer(query_of(wsi), address));
}

int HttpPages::get_file(lws* wsi, HttpPeer& peer, const WebFile& file) {
  const bool head = lws_hdr_total_length(wsi, WSI_TOKEN_HEAD_URI) > 0;
  if (!head && lws_hdr_total_length(wsi, WSI_TOKEN_GET_URI) <= 0) {
    return send(wsi, {405, "text/plain", "Allow: GET, HEAD\r\n", "pages are got\n"});
  }
  const std::string address = file.page ? open_address(wsi) : "";
  if (!address.empty()) return get_front(wsi, address, head);
  const Called called = called_of(wsi, !options_.tls_cert.empty(), options_.proxies);
  const std::string headers = WebPages::headers(file, called.host, options_.embed_origins);
  return send_file(wsi, peer, file.type, headers, *file.body, head);
}

int HttpPages::send_file(lws* wsi, HttpPeer& peer, const std::string& type,
                         const std::string& headers, const std::string& body, bool head) {
  std::vector<std::uint8_t> buffer(LWS_PRE + kMostHeaderBytes);
  unsigned char* const start = buffer.data() + LWS_PRE;
  unsigned char* at = start;
  unsigned char* const end = start + kMostHeaderBytes;
  if (lws_add_http_common_headers(wsi, 200, type.c_str(), body.size(), &at, end) ||
      !add_headers(wsi, headers, &at, end) ||
      lws_finalize_write_http_header(wsi, start, &at, end)) {
    return -1;
  }
  if (head) return lws_http_transaction_completed(wsi) ? -1 : 0;
  peer.file = &body;
  peer.sent = 0;
  lws_callback_on_writable(wsi);
  return 0;
}

int HttpPages::get_download(lws* wsi, HttpPeer& peer, const std::string& path) {
  const std::string address = called_of(wsi, !options_.tls_cert.empty(), options_.proxies).address;
  const auto request = read(wsi, path, address);
  if (const auto* refused = std::get_if<HttpAnswer>(&request)) return send(wsi, *refused);
  if (path == kDownloadsPath) return send(wsi, downloads_answer(desk_ ? &*desk_ : nullptr));
  if (!desk_) return send(wsi, refusal(403, "this server makes no downloads (--downloads)"));
  const auto wanted =
      read_download(std::get<HttpRequest>(request), hub_->access(), std::time(nullptr));
  if (const auto* no = std::get_if<HttpAnswer>(&wanted)) return refuse(wsi, *no, address);
  const auto& download = std::get<DownloadRequest>(wanted);
  const DownloadState state = desk_->ask(download);
  if (state.stage != DownloadState::Stage::kDone) return send(wsi, download_answer(state));
  delete peer.held;  // of an earlier request of this connection
  peer.held = new std::shared_ptr<const std::string>(state.file);
  return send_file(wsi, peer, "application/zip",
                   download_headers(download_name(download, desk_->scene())), **peer.held, false);
}

// Writes as much as the socket takes. A slow reader holds a pointer to the file, not a copy.
int HttpPages::write_file(lws* wsi, HttpPeer& peer) {
  std::array<std::uint8_t, LWS_PRE + kFileChunkBytes> buffer;
  const std::size_t n = std::min(kFileChunkBytes, peer.file->size() - peer.sent);
  const bool last = peer.sent + n == peer.file->size();
  std::memcpy(buffer.data() + LWS_PRE, peer.file->data() + peer.sent, n);
  lws_set_timeout(wsi, PENDING_TIMEOUT_HTTP_CONTENT, kFilePatienceS);
  if (lws_write(wsi, buffer.data() + LWS_PRE, n, last ? LWS_WRITE_HTTP_FINAL : LWS_WRITE_HTTP) <
      0) {
    return -1;
  }
  peer.sent += n;
  if (last) {
    peer.file = nullptr;
    return lws_http_transaction_completed(wsi) ? -1 : 0;
  }
  lws_callback_on_writable(wsi);
  return 0;
}

HttpAnswer HttpPages::page(const std::string& path, bool stopping) const {
  if (path == "/healthz") return {200, "text/plain", "", "ok\n"};
  if (path == "/readyz") {
    return {stopping ? 503u : 200u, "application/json", "", hub_->identity(stopping)};
  }
  if (path == "/metrics" && options_.metrics) {
    return {200, kMetricsType, "", metrics()};
  }
  return {404, "text/plain", "",
          path == "/" ? kNoPage : "there is nothing here; the page for browsers is at /\n"};
}

std::string HttpPages::metrics() const {
  return metrics_text(*counters_, hub_->state(),
                      {hub_->revision(), hub_->options().profile, hub_->options().renderer});
}

int HttpPages::answer_operator(lws* wsi, const std::string& path, bool stopping) const {
  if (path == "/metrics") return send(wsi, {200, kMetricsType, "", metrics()});
  return send(wsi, page(path, stopping));
}

std::variant<HttpRequest, HttpAnswer> HttpPages::read(lws* wsi, const std::string& path,
                                                      const std::string& address) const {
  if (lws_hdr_total_length(wsi, WSI_TOKEN_GET_URI) <= 0) {
    return refusal(405, "only GET here", "Allow: GET\r\n");
  }
  if (!admission_.may_connect(address, clock_.now_us())) {
    ++counters_->addresses_refused;
    return refusal(429, "too many wrong tokens", "Retry-After: 1\r\n");
  }
  return HttpRequest{path, query_of(wsi), header(wsi, WSI_TOKEN_HTTP_AUTHORIZATION).text};
}

int HttpPages::refuse(lws* wsi, const HttpAnswer& answer, const std::string& address) {
  if (answer.status == 401) {
    admission_.note_failure(address, clock_.now_us());
    ++counters_->authentication_failures;
  }
  return send(wsi, answer);
}

void HttpPages::wait(lws* wsi, HttpPeer& peer, std::uint32_t request, int patience_s) {
  peer.request = request;
  lws_set_timeout(wsi, PENDING_TIMEOUT_HTTP_CONTENT, patience_s);
  hand_out();
}

int HttpPages::get_tile(lws* wsi, HttpPeer& peer, const std::string& path) {
  const std::string address = called_of(wsi, !options_.tls_cert.empty(), options_.proxies).address;
  const auto request = read(wsi, path, address);
  if (const auto* refused = std::get_if<HttpAnswer>(&request)) return send(wsi, *refused);
  const auto wanted = read_tile_request(std::get<HttpRequest>(request), hub_->revision(),
                                        hub_->access(), std::time(nullptr));
  if (const auto* no = std::get_if<HttpAnswer>(&wanted)) return refuse(wsi, *no, address);
  const TileAddress& tile = std::get<TileAddress>(wanted);
  const std::uint32_t number = hub_->get(tile);
  waiting_[number] = {wsi, &peer, tile.codec, header(wsi, WSI_TOKEN_HTTP_IF_NONE_MATCH).text};
  wait(wsi, peer, number, kTilePatienceS);
  return 0;
}

int HttpPages::get_picture(lws* wsi, HttpPeer& peer, const std::string& path) {
  const std::string address = called_of(wsi, !options_.tls_cert.empty(), options_.proxies).address;
  const auto request = read(wsi, path, address);
  if (const auto* refused = std::get_if<HttpAnswer>(&request)) return send(wsi, *refused);
  const auto wanted =
      read_picture_request(std::get<HttpRequest>(request), hub_->access(), std::time(nullptr));
  if (const auto* no = std::get_if<HttpAnswer>(&wanted)) return refuse(wsi, *no, address);
  const auto& picture = std::get<PictureRequest>(wanted);
  const std::string tag = picture_tag(picture, hub_->revision());
  if (header(wsi, WSI_TOKEN_HTTP_IF_NONE_MATCH).text == tag) {
    return send(wsi, picture_unchanged(tag, hub_->access().open()));
  }
  const auto same = std::count_if(pictures_.begin(), pictures_.end(), [&](const auto& other) {
    return other.second.address == address;
  });
  if (same >= kMostPicturesOfOne) {
    return send(wsi, refusal(429,
                             fmt::format("this address waits for {} pictures already: come back "
                                         "when they are there",
                                         kMostPicturesOfOne),
                             "Retry-After: 1\r\n"));
  }
  const std::uint32_t number = hub_->get(picture);
  pictures_[number] = {wsi, &peer, picture.format, tag, address};
  wait(wsi, peer, number, kPicturePatienceS);
  return 0;
}

void HttpPages::give(lws* wsi, HttpPeer& peer, HttpAnswer answer) {
  peer.request = 0;
  peer.answer = new HttpAnswer(std::move(answer));
  lws_callback_on_writable(wsi);
}

// libwebsockets does not read from a connection whose request it has yet to answer, so it does not
// see it end.
void HttpPages::drop_gone() {
  const std::int64_t now_us = clock_.now_us();
  if (now_us - looked_us_ < kLookForGoneUs) return;
  looked_us_ = now_us;
  for (auto at = pictures_.begin(); at != pictures_.end();) {
    pollfd socket{lws_get_socket_fd(at->second.wsi), POLLRDHUP, 0};
    if (poll(&socket, 1, 0) <= 0) {
      ++at;
      continue;
    }
    hub_->cancel_get(at->first);
    at->second.peer->request = 0;
    lws_set_timeout(at->second.wsi, PENDING_TIMEOUT_HTTP_CONTENT, LWS_TO_KILL_ASYNC);
    at = pictures_.erase(at);
  }
}

void HttpPages::hand_out() {
  drop_gone();
  const bool open = hub_->access().open();
  for (GotTile& tile : hub_->take_got()) {
    const auto waits = waiting_.extract(tile.request);
    if (waits.empty()) continue;
    const Waiting& one = waits.mapped();
    give(one.wsi, *one.peer, tile_answer(std::move(tile), one.codec, open, one.if_none_match));
  }
  for (const GotPicture& picture : hub_->take_pictures()) {
    const auto poster = std::find_if(posters_.begin(), posters_.end(), [&](const auto& one) {
      return one.second.request == picture.request;
    });
    if (poster != posters_.end()) {
      const bool again = picture.reason == wire::RefusalReason::Busy;
      poster->second = {again ? 0 : picture.request, picture.file};
      fronts_.clear();
      continue;
    }
    const auto waits = pictures_.extract(picture.request);
    if (waits.empty()) continue;
    const WaitingForPicture& one = waits.mapped();
    give(one.wsi, *one.peer, picture_answer(picture, one.format, one.tag, open));
  }
}

int HttpPages::write(lws* wsi, HttpPeer& peer) {
  if (peer.file) return write_file(wsi, peer);
  if (!peer.answer) return 0;
  const std::unique_ptr<HttpAnswer> answer(std::exchange(peer.answer, nullptr));
  return send(wsi, *answer);
}

void HttpPages::gone(HttpPeer& peer) {
  if (peer.request != 0) {
    hub_->cancel_get(peer.request);
    waiting_.erase(peer.request);
    pictures_.erase(peer.request);
  }
  delete std::exchange(peer.answer, nullptr);
  delete std::exchange(peer.held, nullptr);
  peer.request = 0;
}

}  // namespace mirage
