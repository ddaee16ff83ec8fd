#include "client/host/client_host.h"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "client/door/client.h"
#include "client/host/folder_link.h"
#include "client/link/link.h"
#include "client/link/modelled_link.h"
#include "client/native/native_link.h"
#include "client/native/no_answer.h"
#include "client/native/server_url.h"
#include "client/scene/scene_view.h"
#include "client/session/client_session.h"

namespace mirage {
namespace {

// Afterwards, a viewer asks why nobody answers: what TLS refuses now, it refuses later as well.
constexpr int kFirstTriesMs = 500;
constexpr int kReferenceTimeoutMs = 120'000;
constexpr int kReplyTimeoutMs = 30'000;
constexpr std::int64_t kScenePatienceUs = 20'000'000;
// A server that has said welcome may still be making levels of detail.
constexpr std::int64_t kLevelsPatienceUs = 900'000'000;

}  // namespace

ClientHost::ClientHost(HostOptions options, Client& client)
    : options_(std::move(options)), client_(client) {
  if (options_.virtual_time) {
    auto clock = std::make_unique<VirtualClock>();
    virtual_clock_ = clock.get();
    clock_ = std::move(clock);
  } else {
    clock_ = std::make_unique<SteadyClock>();
  }
}

ClientHost::~ClientHost() { client_.close(); }

ClientSession& ClientHost::session() { return client_.session(); }
const ClientSession& ClientHost::session() const { return client_.session(); }

Result<void> ClientHost::open() {
  const bool frozen = is_frozen_folder(options_.url);
  if (Result<void> open = frozen ? open_folder() : open_server(); !open) return open;
  ClientOptions session = options_.session;
  if (session.trace && !virtual_clock_) session.trace_clock = [this] { return now_us(); };
  Link* link = native_ ? static_cast<Link*>(native_.get()) : folder_.get();
  if (modelled_) link = modelled_.get();
  client_.open(*link, std::move(session),
               [](const Error& error) { spdlog::error("{}", error.line()); });
  return {};
}

Result<void> ClientHost::open_folder() {
  Result<std::unique_ptr<FolderLink>> folder = FolderLink::open(options_.url);
  if (!folder) return folder.error();
  folder_ = folder.take();
  if (options_.net || options_.virtual_time) {
    modelled_ = std::make_unique<ModelledLink>(*folder_, *clock_, options_.net.value_or(NetModel{}),
                                               options_.virtual_time, [] { return true; });
  }
  return {};
}

Result<void> ClientHost::open_server() {
  Result<ServerUrl> url = parse_url(options_.url);
  if (!url) return url.error();
  url->ca_file = options_.ca_file;
  native_ = std::make_unique<NativeLink>(*url, options_.wake);
  if (options_.net || options_.virtual_time) {
    const auto wait = [this] {
      native_->wait_message(kReplyTimeoutMs);
      return native_->connected();
    };
    modelled_ = std::make_unique<ModelledLink>(*native_, *clock_, options_.net.value_or(NetModel{}),
                                               options_.virtual_time, wait);
  }
  return wait_connected(*url);
}

Result<void> ClientHost::wait_connected(const ServerUrl& url) {
  const SteadyClock patience;
  const auto left_ms = [&] {
    const double ms =
        options_.connect_timeout_s * 1e3 - static_cast<double>(patience.now_us()) * 1e-3;
    return static_cast<int>(std::max(ms, 0.0));
  };
  if (native_->wait_connected(std::min(left_ms(), kFirstTriesMs))) return {};
  if (!native_->last_problem().empty()) {
    if (std::optional<Error> wrong = wrong_tls(url, options_.url)) return *wrong;
  }
  if (native_->wait_connected(left_ms())) return {};
  return no_answer(url, options_.url, native_->last_problem());
}

Result<void> ClientHost::wait_for_scene() {
  return wait_until([this] { return session().scene().complete(); });
}

Result<void> ClientHost::wait_for_picture() {
  return wait_until([this] { return session().drawable(); });
}

std::optional<Error> ClientHost::hopeless(std::int64_t waited_us) const {
  if (!native_) return std::nullopt;
  if (native_->last_close_code() == close_code(ErrorId::kAuth)) {
    return make_error(ErrorId::kAuth, "the server refused the token", "--token-file FILE");
  }
  if (const std::optional<Error> refused = native_->refusal()) {
    return make_error(refused->id, "the server's scene was refused: " + refused->text,
                      "are server and viewer of one version?");
  }
  // On virtual time, what has come may still be under way in the modelled link.
  const bool greeted = session().welcomes() > 0 || native_->traffic().bytes_down > 0;
  const auto limit = static_cast<std::int64_t>(options_.connect_timeout_s * 1e6) + kScenePatienceUs;
  const bool late = waited_us > (greeted ? kLevelsPatienceUs : limit);
  if (!late && (native_->connected() || native_->last_close_code() == 0)) return std::nullopt;
  return make_error(ErrorId::kNetworkClosed,
                    "the server did not describe its scene: " + native_->last_problem());
}

Result<void> ClientHost::wait_until(const std::function<bool()>& there) {
  const SteadyClock patience;
  while (!there()) {
    if (Result<void> received = session().receive(now_us()); !received) return received;
    if (there()) break;
    if (const std::optional<Error> why = hopeless(patience.now_us())) return *why;
    if (virtual_clock_) virtual_clock_->advance_to_us(virtual_clock_->now_us() + 1000);
    if (!virtual_clock_ && native_) native_->wait_message(20);
  }
  return {};
}

Result<ReferenceFrame> ClientHost::reference(const Camera& camera, std::uint32_t supersample) {
  if (!limits::reference_within_limits(camera.width, camera.height, supersample)) {
    return make_error(ErrorId::kComparison,
                      fmt::format("a full render of {}x{} pixels with {} samples an axis is more "
                                  "than a server draws",
                                  camera.width, camera.height, supersample),
                      "at most 8192 pixels an edge and 33 million samples");
  }
  session().ask_reference(camera, supersample);
  const SteadyClock patience;
  std::optional<ReferenceFrame> reference;
  while (!(reference = session().take_reference())) {
    if (session().reference_refused()) {
      return make_error(ErrorId::kComparison, "the server renders no references",
                        "it was started with --no-reference, or the frame is too large");
    }
    if (!link_up() || patience.now_us() > kReferenceTimeoutMs * 1000ll) {
      return make_error(ErrorId::kNetworkTimeout, "no reference frame came");
    }
    if (!modelled_ && native_) native_->wait_message(100);
    if (Result<void> received = session().receive(now_us()); !received) return received.error();
  }
  return std::move(*reference);
}

LinkTraffic ClientHost::traffic() const {
  if (modelled_) return modelled_->traffic();
  return native_ ? native_->traffic() : folder_->traffic();
}

void ClientHost::reconnect() {
  if (native_) native_->reconnect();
}

void ClientHost::wait_message(int timeout_ms) const {
  if (native_) native_->wait_message(timeout_ms);
}

bool ClientHost::link_up() const { return !native_ || native_->connected(); }

std::optional<LinkUse> ClientHost::link_use() {
  return virtual_clock_ ? std::optional(modelled_->use()) : std::nullopt;
}

}  // namespace mirage
