#include "server/net/endpoint.h"

#include <libwebsockets.h>
#include <spdlog/spdlog.h>

#include <atomic>
#include <cstring>
#include <map>

#include "protocol/base/bytes.h"
#include "protocol/base/clock.h"
#include "server/net/endpoint_options.h"
#include "server/net/listen_address.h"
#include "server/net/metrics.h"
#include "server/session/scene_pages.h"
#include "server/session/session.h"
#include "server/tile/stage_queues.h"
#include "server/tile/tile_job.h"

namespace mirage {
namespace {

constexpr int kMaxWritesPerCallback = 8;
constexpr std::int64_t kDrainUs = 2'000'000;
constexpr lws_usec_t kFetchCheckUs = 5'000;  // how often it is looked whether a disk is too slow

struct Connection {
  SessionId session = 0;
  Bytes* inbound = nullptr;  // fragments of the message under way
};

int on_websocket(lws* wsi, lws_callback_reasons reason, void* user, void* in, size_t length);
int on_http(lws* wsi, lws_callback_reasons reason, void* user, void* in, size_t length);

const lws_protocols kProtocols[] = {
    {"http", on_http, 0, 4096, 0, nullptr, 0},
    {"mirage", on_websocket, sizeof(Connection), 64 * 1024, 0, nullptr, 0},
    {nullptr, nullptr, 0, 0, 0, nullptr, 0},
};

void forward_log(int level, const char* line) {
  std::string text(line);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  if (level & LLL_ERR) spdlog::debug("lws: {}", text);
}

}  // namespace

struct Endpoint::Impl {
  Impl(SessionHub& h, StageQueues& q) : hub(h), completions(q.completions), counters(q.counters) {}

  SessionHub& hub;
  BoundedQueue<Completion>& completions;
  Counters& counters;
  EndpointOptions options;
  lws_context* context = nullptr;
  lws_vhost* vhost = nullptr;
  std::atomic<bool> stopping{false};
  std::map<SessionId, lws*> sockets;

  struct FetchTimer {
    lws_sorted_usec_list_t timer{};  // first member: the callback gets its address
    Impl* impl = nullptr;
    bool set = false;
  };
  FetchTimer fetch_timer;

  /// While somebody waits for the tile cache's directory.
  void watch_fetches() {
    if (fetch_timer.set || !hub.waits_for_directory()) return;
    fetch_timer.impl = this;
    fetch_timer.set = true;
    lws_sul_schedule(context, 0, &fetch_timer.timer, on_fetch_timer, kFetchCheckUs);
  }

  static void on_fetch_timer(lws_sorted_usec_list_t* timer) {
    auto* const fetch = reinterpret_cast<FetchTimer*>(timer);
    fetch->set = false;
    fetch->impl->hub.give_up_fetches();
    fetch->impl->ask_to_write();
    fetch->impl->watch_fetches();
    // A timer served before the poll does not end the poll: make it look again.
    lws_cancel_service(fetch->impl->context);
  }

  void drain_completions() {
    while (std::optional<Completion> c = completions.try_pop()) hub.complete(std::move(*c));
    hub.refuse_late();
    ask_to_write();
  }

  void ask_to_write() {
    for (const SessionId id : hub.take_writable()) {
      const auto at = sockets.find(id);
      if (at != sockets.end()) lws_callback_on_writable(at->second);
    }
  }

  /// Logs why, tells the peer, and makes libwebsockets close (the return value of a callback).
  int close_with(lws* wsi, SessionId id, const Error& error) {
    if (error.id != ErrorId::kNetworkClosed) {
      ++counters.clients_closed_for_error;
      spdlog::warn("client {}: closed: {}", id, error.line());
    }
    std::string text = error.text.substr(0, 120);
    lws_close_reason(wsi, static_cast<lws_close_status>(close_code(error.id)),
                     reinterpret_cast<unsigned char*>(text.data()), text.size());
    return -1;
  }

  int write_some(lws* wsi, Connection& connection) {
    static thread_local std::vector<std::uint8_t> buffer;
    for (int i = 0; i < kMaxWritesPerCallback; ++i) {
      const FramePtr frame = hub.next_frame(connection.session);
      if (!frame) return 0;
      buffer.resize(LWS_PRE + frame->size());
      std::memcpy(buffer.data() + LWS_PRE, frame->data(), frame->size());
      const int n = lws_write(wsi, buffer.data() + LWS_PRE, frame->size(), LWS_WRITE_BINARY);
      if (n < static_cast<int>(frame->size())) return -1;
      if (lws_send_pipe_choked(wsi)) break;
    }
    lws_callback_on_writable(wsi);
    return 0;
  }

  int receive(lws* wsi, Connection& connection, const std::uint8_t* bytes, std::size_t n) {
    if (!lws_frame_is_binary(wsi)) {
      return close_with(wsi, connection.session,
                        make_error(ErrorId::kWireMalformed, "text frames are not spoken here"));
    }
    Bytes& inbound = *connection.inbound;
    if (inbound.size() + n > limits::kMaxMessageBytes) {
      return close_with(wsi, connection.session,
                        make_error(ErrorId::kWireLimit, "message is larger than allowed"));
    }
    inbound.insert(inbound.end(), bytes, bytes + n);
    if (!lws_is_final_fragment(wsi) || lws_remaining_packet_payload(wsi) > 0) return 0;
    const Bytes whole = std::exchange(inbound, {});
    const Result<void> done = hub.receive(connection.session, whole.data(), whole.size());
    if (!done) return close_with(wsi, connection.session, done.error());
    ask_to_write();
    watch_fetches();
    return 0;
  }
};

namespace {

Endpoint::Impl* impl_of(lws* wsi) {
  return static_cast<Endpoint::Impl*>(lws_context_user(lws_get_context(wsi)));
}

std::string header(lws* wsi, lws_token_indexes token) {
  char text[256] = {};
  const int n = lws_hdr_copy(wsi, text, sizeof(text), token);
  return n > 0 ? std::string(text, static_cast<std::size_t>(n)) : std::string();
}

// libwebsockets accepts POST, other versions and short keys here: check for ourselves.
bool acceptable_upgrade(lws* wsi, const EndpointOptions& options) {
  if (lws_hdr_total_length(wsi, WSI_TOKEN_GET_URI) <= 0) return false;
  if (header(wsi, WSI_TOKEN_VERSION) != "13") return false;
  if (header(wsi, WSI_TOKEN_KEY).size() != 24) return false;
  const std::string origin = header(wsi, WSI_TOKEN_ORIGIN);
  return options.allow_origin.empty() || origin.empty() || origin == options.allow_origin;
}

int on_websocket(lws* wsi, lws_callback_reasons reason, void* user, void* in, size_t length) {
  auto* connection = static_cast<Connection*>(user);
  switch (reason) {
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION: {
      const Endpoint::Impl* impl = impl_of(wsi);
      return acceptable_upgrade(wsi, impl->options) && !impl->stopping ? 0 : -1;
    }
    case LWS_CALLBACK_ESTABLISHED: {
      Endpoint::Impl* impl = impl_of(wsi);
      *connection = Connection{};
      connection->inbound = new Bytes;  // freed on CLOSED: lws zero-fills and frees `user` itself
      Result<SessionId> id = impl->hub.open();
      if (!id) return impl->close_with(wsi, 0, id.error());
      connection->session = *id;
      impl->sockets[*id] = wsi;
      return 0;
    }
    case LWS_CALLBACK_RECEIVE:
      return impl_of(wsi)->receive(wsi, *connection, static_cast<std::uint8_t*>(in), length);
    case LWS_CALLBACK_SERVER_WRITEABLE:
      if (connection->session == 0) return -1;
      return impl_of(wsi)->write_some(wsi, *connection);
    case LWS_CALLBACK_CLOSED: {
      Endpoint::Impl* impl = impl_of(wsi);
      if (connection->session != 0) {
        impl->sockets.erase(connection->session);
        impl->hub.close(connection->session);
      }
      delete connection->inbound;
      connection->inbound = nullptr;
      return 0;
    }
    case LWS_CALLBACK_EVENT_WAIT_CANCELLED:
      impl_of(wsi)->drain_completions();
      return 0;
    default:
      return 0;
  }
}

int send_text(lws* wsi, unsigned int status, const std::string& body) {
  std::vector<std::uint8_t> buffer(LWS_PRE + 1024 + body.size());
  unsigned char* const start = buffer.data() + LWS_PRE;
  unsigned char* at = start;
  unsigned char* const end = buffer.data() + LWS_PRE + 1024;
  if (lws_add_http_common_headers(wsi, status, "text/plain; version=0.0.4", body.size(), &at,
                                  end) ||
      lws_finalize_write_http_header(wsi, start, &at, end)) {
    return 1;
  }
  std::memcpy(start, body.data(), body.size());
  if (lws_write(wsi, start, body.size(), LWS_WRITE_HTTP_FINAL) < 0) return 1;
  return lws_http_transaction_completed(wsi) ? -1 : 0;
}

int on_http(lws* wsi, lws_callback_reasons reason, void* user, void* in, size_t length) {
  switch (reason) {
    case LWS_CALLBACK_HTTP: {
      Endpoint::Impl* impl = impl_of(wsi);
      const std::string path = in ? static_cast<const char*>(in) : "";
      if (path == "/healthz") return send_text(wsi, 200, "ok\n");
      if (path == "/metrics" && impl->options.metrics) {
        return send_text(wsi, 200, metrics_text(impl->counters, impl->hub.clients()));
      }
      return send_text(wsi, 404, "this is a Mirage server: connect with mirage-view\n");
    }
    case LWS_CALLBACK_EVENT_WAIT_CANCELLED:
      return 0;
    default:
      return lws_callback_http_dummy(wsi, reason, user, in, length);
  }
}

}  // namespace

Endpoint::Endpoint(SessionHub& hub, StageQueues& queues)
    : impl_(std::make_unique<Impl>(hub, queues)) {}

Endpoint::~Endpoint() {
  if (!impl_->context) return;
  lws_sul_schedule(impl_->context, 0, &impl_->fetch_timer.timer, nullptr,
                   LWS_SET_TIMER_USEC_CANCEL);
  lws_context_destroy(impl_->context);
}

Result<void> Endpoint::listen(const EndpointOptions& options) {
  impl_->options = options;
  lws_set_log_level(LLL_ERR, forward_log);
  lws_context_creation_info info{};
  info.options = LWS_SERVER_OPTION_EXPLICIT_VHOSTS;
  if (!options.tls_cert.empty()) info.options |= LWS_SERVER_OPTION_DO_SSL_GLOBAL_INIT;
  info.port = CONTEXT_PORT_NO_LISTEN;
  info.user = impl_.get();
  info.gid = static_cast<gid_t>(-1);
  info.uid = static_cast<uid_t>(-1);
  impl_->context = lws_create_context(&info);
  if (!impl_->context) return make_error(ErrorId::kNetworkListen, "libwebsockets does not start");
  info.options |= LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND;
  const ListenAddress& at = options.address;
  std::string interface = at.socket_path;
  if (at.socket_path.empty()) {
    Result<std::string> numeric = numeric_address(at.host);
    if (!numeric) return numeric.error();
    interface = numeric.take();
    if (interface.find(':') == std::string::npos) info.options |= LWS_SERVER_OPTION_DISABLE_IPV6;
    info.port = at.port;
  } else {
    if (Result<void> free = free_socket_path(at.socket_path); !free) return free.error();
    info.options |= LWS_SERVER_OPTION_UNIX_SOCK;
    info.port = 0;
  }
  info.iface = interface.c_str();
  info.protocols = kProtocols;
  info.timeout_secs = 10;
  info.ka_time = 30;
  info.ka_probes = 3;
  info.ka_interval = 10;
  info.vhost_name = "mirage";
  if (!options.tls_cert.empty()) {
    info.ssl_cert_filepath = options.tls_cert.c_str();
    info.ssl_private_key_filepath = options.tls_key.c_str();
  }
  impl_->vhost = lws_create_vhost(impl_->context, &info);
  if (!impl_->vhost) {
    return make_error(ErrorId::kNetworkListen,
                      "cannot listen on " + at.url(!options.tls_cert.empty(), at.port),
                      "is the port taken, or the certificate unreadable? --listen HOST:0 takes any "
                      "free port");
  }
  return {};
}

int Endpoint::port() const {
  const bool has_port = impl_->options.address.socket_path.empty();
  return has_port ? lws_get_vhost_listen_port(impl_->vhost) : 0;
}

Result<void> Endpoint::run() {
  const SteadyClock clock;
  std::int64_t next_sweep_us = 0;
  std::int64_t drain_until_us = 0;
  for (;;) {
    if (lws_service(impl_->context, 0) < 0) break;
    const std::int64_t now = clock.now_us();
    if (now >= next_sweep_us) {
      next_sweep_us = now + 500'000;
      for (const auto& [id, error] : impl_->hub.overdue()) {
        const auto at = impl_->sockets.find(id);
        if (at == impl_->sockets.end()) continue;
        impl_->close_with(at->second, id, error);
        lws_set_timeout(at->second, PENDING_TIMEOUT_USER_REASON_BASE, LWS_TO_KILL_ASYNC);
      }
    }
    const std::optional<Error>& failure = impl_->hub.failure();
    if (failure) impl_->stopping = true;
    if (!impl_->stopping) continue;
    if (drain_until_us == 0) {
      drain_until_us = now + kDrainUs;
      impl_->hub.say_goodbye_to_all(failure ? "the server's graphics have failed"
                                            : "server is shutting down");
      impl_->ask_to_write();
    }
    if (impl_->hub.all_written() || now > drain_until_us) break;
  }
  if (impl_->hub.failure()) return *impl_->hub.failure();
  return {};
}

void Endpoint::stop() {
  impl_->stopping = true;
  wake();
}

void Endpoint::wake() {
  if (impl_->context) lws_cancel_service(impl_->context);
}

}  // namespace mirage
