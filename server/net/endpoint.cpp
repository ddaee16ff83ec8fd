#include "server/net/endpoint.h"

#include <libwebsockets.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <new>

#include "protocol/base/bytes.h"
#include "protocol/base/clock.h"
#include "server/base/log.h"
#include "server/net/admission.h"
#include "server/net/certificate.h"
#include "server/net/endpoint_options.h"
#include "server/net/http_pages.h"
#include "server/net/listen_address.h"
#include "server/net/lws_text.h"
#include "server/net/web_pages.h"
#include "server/net/websocket_rules.h"
#include "server/session/hub_state.h"
#include "server/session/scene_pages.h"
#include "server/session/session.h"
#include "server/tile/stage_queues.h"
#include "server/tile/tile_job.h"

namespace mirage {
namespace {

constexpr int kMaxWritesPerCallback = 8;
// Largest piece in which libwebsockets delivers data; each connection has a buffer of this size.
constexpr std::size_t kReceiveBytes = 2048;
// Largest piece that libwebsockets passes to the system at a time. Its default is kReceiveBytes: a
// tile would take six calls, each with a copy of all that is left.
constexpr std::size_t kSendBytes = 256 * 1024;
constexpr std::int64_t kFarewellUs = 1'000'000;  // time for goodbyes, once all is sent
constexpr lws_usec_t kSweepUs = 250'000;
// Descriptors reserved for files.
constexpr std::size_t kSpareDescriptors = 16;

// Limit of sockets. libwebsockets then stops accepting in time; at the process' own limit, accept()
// would fail again and again.
unsigned int most_sockets() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return 0;
  std::error_code none;
  const auto open = std::distance(std::filesystem::directory_iterator("/proc/self/fd", none),
                                  std::filesystem::directory_iterator());
  const std::size_t taken = static_cast<std::size_t>(open) + kSpareDescriptors;
  constexpr rlim_t kMost = 1u << 20;
  const auto all = static_cast<std::size_t>(std::min(limit.rlim_cur, kMost));
  return static_cast<unsigned int>(std::max<std::size_t>(all > taken ? all - taken : 0, 8));
}
constexpr lws_usec_t kFetchCheckUs = 5'000;  // interval of checks for slow sources

// Proxies close connections that are silent, some after a few seconds. A peer that answers no ping
// for a minute is gone.
const lws_retry_bo_t kPings = {.retry_ms_table = nullptr,
                               .retry_ms_table_count = 0,
                               .conceal_count = 0,
                               .secs_since_valid_ping = 5,
                               .secs_since_valid_hangup = 60,
                               .jitter_percent = 0};

struct Connection {
  SessionHub* hub = nullptr;
  SessionId session = 0;
  std::string* address = nullptr;
  Bytes* inbound = nullptr;  // fragments of the message being received
  Bytes* hello = nullptr;    // of a client that waits for another hub
  // Session 0 means no session: the connection is closed when it is next writable.
};

int on_websocket(lws* wsi, lws_callback_reasons reason, void* user, void* in, size_t length);
int on_http(lws* wsi, lws_callback_reasons reason, void* user, void* in, size_t length);
int on_operator(lws* wsi, lws_callback_reasons reason, void* user, void* in, size_t length);

const lws_protocols kProtocols[] = {
    {"http", on_http, sizeof(HttpPeer), 4096, 0, nullptr, 0},
    {"mirage", on_websocket, sizeof(Connection), kReceiveBytes, 0, nullptr, kSendBytes},
    {nullptr, nullptr, 0, 0, 0, nullptr, 0},
};

const lws_protocols kOperatorProtocols[] = {
    {"http", on_operator, sizeof(HttpPeer), 4096, 0, nullptr, 0},
    {nullptr, nullptr, 0, 0, 0, nullptr, 0},
};

void forward_log(int level, const char* line) {
  std::string text(line);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  if (level & LLL_ERR) spdlog::debug("lws: {}", text);
}

}  // namespace

struct Endpoint::Impl {
  Impl(SessionHub& h, StageQueues& q) : http(options, admission) { serve(h, q); }

  /// The sessions of one choice of the scene, and where its stages put what they have done.
  struct Served {
    SessionHub* hub;
    BoundedQueue<Completion>* completions;
  };

  void serve(SessionHub& h, StageQueues& q) {
    hub = &h;
    served = {{&h, &q.completions}};
    counters = &q.counters;
    http.serve(h, q.counters);
  }

  SessionHub* hub = nullptr;   // of the scene as it is served: it takes every hello
  std::vector<Served> served;  // that one, and those of other choices
  Counters* counters = nullptr;
  EndpointOptions options;
  EndpointHooks hooks;
  lws_context* context = nullptr;
  lws_vhost* vhost = nullptr;
  std::atomic<bool> stopping{false}, reloading{false};
  std::map<std::pair<SessionHub*, SessionId>, lws*> sockets;

  Admission admission;
  HttpPages http;
  const SteadyClock clock;
  std::size_t connections = 0;  // open connections of any protocol
  std::size_t most = 0;         // limit of connections
  bool crowded = false;         // the log has said so
  bool farewell = false;        // goodbyes are sent: a client that read everything is closed

  struct Timer {
    lws_sorted_usec_list_t timer{};  // must be the first member: the callback gets its address
    Impl* impl = nullptr;
    bool set = false;
  };
  Timer fetch_timer, sweep_timer;

  Result<lws_vhost*> listen_at(const ListenAddress& at, const char* name,
                               const lws_protocols* protocols, bool tls);

  /// Reads certificate and key again. A wrong pair changes nothing; open connections are
  /// unaffected.
  void read_certificate_anew() const {
    if (options.tls_cert.empty()) return;
    Result<void> right = check_certificate(options.tls_cert, options.tls_key);
    if (right && lws_tls_cert_updated(context, options.tls_cert.c_str(), options.tls_key.c_str(),
                                      nullptr, 0, nullptr, 0) != 0) {
      right = make_error(ErrorId::kIo, "cannot use the certificate '" + options.tls_cert + "'");
    }
    if (right) return spdlog::info("the certificate is read anew from '{}'", options.tls_cert);
    spdlog::error("{}; the certificate stays as it is", right.error().line());
  }

  /// Returns what a connection called, while its headers are there.
  Called called(lws* wsi) const {
    return called_of(wsi, !options.tls_cert.empty(), options.proxies);
  }

  /// A timer closes clients that say or read nothing, even if there is no traffic.
  void sweep_later() {
    sweep_timer.impl = this;
    lws_sul_schedule(context, 0, &sweep_timer.timer, on_sweep_timer, kSweepUs);
  }

  void note_crowd() {
    const bool full = connections + 1 >= most;
    if (full && !crowded) {
      spdlog::warn(
          "{} connections are open: no more are accepted until some close; 'ulimit -n' "
          "sets how many there may be",
          connections);
    }
    crowded = full;
  }

  static void on_sweep_timer(lws_sorted_usec_list_t* timer) {
    Impl* const impl = reinterpret_cast<Timer*>(timer)->impl;
    std::size_t elsewhere = 0;
    for (const Served& one : impl->served) {
      for (const auto& [id, error] : one.hub->overdue()) {
        const auto at = impl->sockets.find({one.hub, id});
        if (at == impl->sockets.end()) continue;
        impl->close_with(at->second, id, error);
        lws_set_timeout(at->second, PENDING_TIMEOUT_USER_REASON_BASE, LWS_TO_KILL_ASYNC);
      }
      if (one.hub != impl->hub) elsewhere += one.hub->state().clients;
    }
    impl->hub->set_clients_elsewhere(elsewhere);
    impl->note_crowd();
    if (impl->hooks.tick) impl->hooks.tick();
    impl->sweep_later();
    // A timer that runs before poll() does not end poll(), so this wakes the loop to look again.
    lws_cancel_service(impl->context);
  }

  /// Checks the tile sources as long as an ask waits for them.
  void watch_fetches() {
    const bool waits = std::any_of(served.begin(), served.end(),
                                   [](const Served& one) { return one.hub->waits_for_sources(); });
    if (fetch_timer.set || !waits) return;
    fetch_timer.impl = this;
    fetch_timer.set = true;
    lws_sul_schedule(context, 0, &fetch_timer.timer, on_fetch_timer, kFetchCheckUs);
  }

  static void on_fetch_timer(lws_sorted_usec_list_t* timer) {
    auto* const fetch = reinterpret_cast<Timer*>(timer);
    fetch->set = false;
    for (const Served& one : fetch->impl->served) one.hub->give_up_fetches();
    fetch->impl->ask_to_write();
    fetch->impl->watch_fetches();
    // A timer that runs before poll() does not end poll(), so this wakes the loop to look again.
    lws_cancel_service(fetch->impl->context);
  }

  void drain_completions() {
    for (const Served& one : served) {
      while (std::optional<Completion> c = one.completions->try_pop()) {
        one.hub->complete(std::move(*c));
      }
      one.hub->refuse_late();
    }
    ask_to_write();
  }

  void ask_to_write() {
    http.hand_out();
    for (const Served& one : served) {
      for (const SessionId id : one.hub->take_writable()) {
        const auto at = sockets.find({one.hub, id});
        if (at != sockets.end()) lws_callback_on_writable(at->second);
      }
    }
  }

  /// Gives a connection a session of this hub, in place of the one it has.
  void enter(lws* wsi, Connection& connection, SessionHub& into) {
    leave(connection);
    connection.hub = &into;
    connection.session = into.open();
    sockets[{&into, connection.session}] = wsi;
  }

  void leave(Connection& connection) {
    if (connection.session == 0) return;
    sockets.erase({connection.hub, connection.session});
    connection.hub->close(connection.session);
    connection.session = 0;
  }

  /// Hands an admitted client to the hub that shows the choice of its hello, or has it wait.
  Result<void> send_elsewhere(lws* wsi, Connection& connection, const Bytes& hello) {
    const SceneChoice choice = *connection.hub->wants_elsewhere(connection.session);
    Result<SessionHub*> there = hooks.choose(choice);
    if (!there) return there.error();
    if (*there == nullptr) {
      *connection.hello = hello;
      return {};
    }
    enter(wsi, connection, **there);
    return connection.hub->receive(connection.session, hello.data(), hello.size());
  }

  /// Returns the connections that wait for a choice.
  std::vector<lws*> waiting_for(const SceneChoice& choice) const {
    std::vector<lws*> out;
    for (const auto& [of, wsi] : sockets) {
      const auto& wanted = of.first->wants_elsewhere(of.second);
      if (wanted && *wanted == choice) out.push_back(wsi);
    }
    return out;
  }

  /// Closes a connection, outside of its callbacks.
  void close_soon(lws* wsi, const Error& error) {
    auto& connection = *static_cast<Connection*>(lws_wsi_user(wsi));
    close_with(wsi, connection.session, error);
    leave(connection);
    lws_callback_on_writable(wsi);  // closes connections without a session
  }

  std::optional<Error> failure() const {
    for (const Served& one : served) {
      if (one.hub->failure()) return one.hub->failure();
    }
    return std::nullopt;
  }

  bool drained() const {
    return !http.waiting() && std::all_of(served.begin(), served.end(),
                                          [](const Served& one) { return one.hub->drained(); });
  }

  /// Logs the error, tells the peer, and returns the value that makes a libwebsockets callback
  /// close.
  int close_with(lws* wsi, SessionId id, const Error& error) {
    if (error.id != ErrorId::kNetworkClosed) {
      ++counters->clients_closed_for_error;
      const auto* connection = static_cast<const Connection*>(lws_wsi_user(wsi));
      const bool known = connection != nullptr && connection->address != nullptr;
      const std::string address = known ? *connection->address : peer_of(wsi);
      const LogAbout about(id, address);
      spdlog::warn("client {} ({}): closed: {}", id, address, error.line());
    }
    std::string text = error.text.substr(0, 120);
    lws_close_reason(wsi, static_cast<lws_close_status>(close_code(error.id)),
                     reinterpret_cast<unsigned char*>(text.data()), text.size());
    return -1;
  }

  static int say_goodbye(lws* wsi) {
    lws_close_reason(wsi, LWS_CLOSE_STATUS_GOINGAWAY, nullptr, 0);
    return -1;
  }

  int write_some(lws* wsi, Connection& connection) {
    static thread_local std::vector<std::uint8_t> buffer;
    for (int i = 0; i < kMaxWritesPerCallback; ++i) {
      const PacketPtr packet = connection.hub->next_packet(connection.session);
      if (!packet && farewell) return say_goodbye(wsi);
      if (!packet) return 0;
      buffer.resize(LWS_PRE + packet->size());
      std::memcpy(buffer.data() + LWS_PRE, packet->data(), packet->size());
      const int n = lws_write(wsi, buffer.data() + LWS_PRE, packet->size(), LWS_WRITE_BINARY);
      if (n < static_cast<int>(packet->size())) return -1;
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
    // The length that a packet declares counts before its bytes arrive.
    const std::size_t to_come = lws_remaining_packet_payload(wsi);
    if (to_come > limits::kMaxMessageBytes ||
        inbound.size() + n + to_come > limits::kMaxMessageBytes) {
      return close_with(wsi, connection.session,
                        make_error(ErrorId::kWireLimit, "message is larger than allowed"));
    }
    inbound.insert(inbound.end(), bytes, bytes + n);
    if (!lws_is_final_fragment(wsi) || to_come > 0) return 0;
    const Bytes whole = std::exchange(inbound, {});
    Result<void> done;
    try {
      done = connection.hub->receive(connection.session, whole.data(), whole.size());
      if (done && connection.hub->wants_elsewhere(connection.session)) {
        done = send_elsewhere(wsi, connection, whole);
      }
    } catch (const std::bad_alloc&) {
      done = make_error(ErrorId::kBusy, "there is no memory for what is asked");
    }
    if (!done) {
      const bool stranger = !connection.hub->greeted(connection.session) &&
                            !connection.hub->wants_elsewhere(connection.session);
      if (stranger) admission.note_failure(*connection.address, clock.now_us());
      return close_with(wsi, connection.session, done.error());
    }
    ask_to_write();
    watch_fetches();
    return 0;
  }
};

namespace {

Endpoint::Impl* impl_of(lws* wsi) {
  return static_cast<Endpoint::Impl*>(lws_context_user(lws_get_context(wsi)));
}

// libwebsockets accepts POST, HTTP/1.0, other versions and any key here, so this checks them.
bool acceptable_upgrade(lws* wsi) {
  if (header(wsi, WSI_TOKEN_HTTP).text != "HTTP/1.1") return false;
  if (lws_hdr_total_length(wsi, WSI_TOKEN_GET_URI) <= 0) return false;
  if (header(wsi, WSI_TOKEN_VERSION).text != "13") return false;
  return is_upgrade_key(header(wsi, WSI_TOKEN_KEY).text);
}

// True if the page that a browser shows may connect.
bool acceptable_origin(const HeaderText& origin, const Called& called,
                       const EndpointOptions& options) {
  if (!origin.there) return true;  // not a browser
  if (!origin.whole) return false;
  const std::vector<std::string>& allowed = options.allow_origins;
  return std::find(allowed.begin(), allowed.end(), origin.text) != allowed.end() ||
         same_origin(origin.text, called.host, called.tls);
}

// Text of a peer, in one line and cut, for the log and an answer.
std::string shown(const std::string& text) {
  std::string out = text.substr(0, 100);
  std::replace_if(
      out.begin(), out.end(), [](unsigned char c) { return c < 0x20 || c > 0x7e; }, '?');
  return out;
}

// Answers an upgrade that is refused. Returns the value for the callback to return.
int refuse_upgrade(lws* wsi, unsigned int status, const std::string& text) {
  std::vector<unsigned char> buffer(LWS_PRE + 1024 + text.size());
  unsigned char* at = buffer.data() + LWS_PRE;
  unsigned char* const begin = at;
  unsigned char* const end = buffer.data() + buffer.size();
  if (lws_add_http_common_headers(wsi, status, "text/plain", text.size(), &at, end) != 0 ||
      lws_finalize_http_header(wsi, &at, end) != 0) {
    return -1;
  }
  at = std::copy(text.begin(), text.end(), at);
  lws_write(wsi, begin, static_cast<std::size_t>(at - begin), LWS_WRITE_HTTP_HEADERS);
  return -1;
}

// Decides on an upgrade while its headers are there.
int confirm_upgrade(lws* wsi) {
  Endpoint::Impl* impl = impl_of(wsi);
  const Called called = impl->called(wsi);
  if (!impl->admission.may_connect(called.address, impl->clock.now_us())) {
    ++impl->counters->addresses_refused;
    return refuse_upgrade(wsi, 429, "too many wrong tokens from this address\n");
  }
  const HeaderText origin = header(wsi, WSI_TOKEN_ORIGIN);
  if (acceptable_origin(origin, called, impl->options)) return 0;
  ++impl->counters->upgrades_refused;
  const std::string from = shown(origin.text), to = shown(called.host);
  const std::string text =
      "a page of " + from + " may not connect to " + (called.tls ? "https://" : "http://") + to;
  spdlog::warn(
      "{} refused: {} (hint: --allow-origin {} lets it in; behind a proxy that rewrites "
      "Host, let it send X-Forwarded-Host and -Proto)",
      called.address, text, from);
  return refuse_upgrade(wsi, 403, text + "\n");
}

int on_websocket(lws* wsi, lws_callback_reasons reason, void* user, void* in, size_t length) {
  auto* connection = static_cast<Connection*>(user);
  switch (reason) {
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION: {
      Endpoint::Impl* impl = impl_of(wsi);
      if (impl->stopping) return -1;
      if (acceptable_upgrade(wsi)) return 0;
      ++impl->counters->upgrades_refused;
      return -1;
    }
    case LWS_CALLBACK_ESTABLISHED: {
      Endpoint::Impl* impl = impl_of(wsi);
      *connection = Connection{};
      connection->inbound = new Bytes;  // freed on CLOSED: lws zero-fills and frees `user` itself
      connection->hello = new Bytes;
      connection->address = new std::string(impl->called(wsi).address);
      impl->enter(wsi, *connection, *impl->hub);
      return 0;
    }
    case LWS_CALLBACK_RECEIVE:
      if (connection->session == 0) return -1;
      return impl_of(wsi)->receive(wsi, *connection, static_cast<std::uint8_t*>(in), length);
    case LWS_CALLBACK_WS_PEER_INITIATED_CLOSE: {
      if (is_close_body(static_cast<std::uint8_t*>(in), length)) return 0;
      const Error wrong = make_error(ErrorId::kWireMalformed, "a close frame that is none");
      return impl_of(wsi)->close_with(wsi, connection->session, wrong);
    }
    case LWS_CALLBACK_SERVER_WRITEABLE:
      if (connection->session == 0) return -1;
      return impl_of(wsi)->write_some(wsi, *connection);
    case LWS_CALLBACK_CLOSED: {
      impl_of(wsi)->leave(*connection);
      delete std::exchange(connection->inbound, nullptr);
      delete std::exchange(connection->hello, nullptr);
      delete std::exchange(connection->address, nullptr);
      return 0;
    }
    case LWS_CALLBACK_EVENT_WAIT_CANCELLED:
      impl_of(wsi)->drain_completions();
      return 0;
    default:
      return 0;
  }
}

int on_http(lws* wsi, lws_callback_reasons reason, void* user, void* in, size_t length) {
  switch (reason) {
    case LWS_CALLBACK_HTTP: {
      Endpoint::Impl* impl = impl_of(wsi);
      const int done = impl->http.answer(wsi, *static_cast<HttpPeer*>(user),
                                         in ? static_cast<const char*>(in) : "", impl->stopping);
      impl->watch_fetches();
      return done;
    }
    case LWS_CALLBACK_HTTP_WRITEABLE:
      return impl_of(wsi)->http.write(wsi, *static_cast<HttpPeer*>(user));
    case LWS_CALLBACK_CLOSED_HTTP:
    case LWS_CALLBACK_HTTP_DROP_PROTOCOL:
      if (user) impl_of(wsi)->http.gone(*static_cast<HttpPeer*>(user));
      return 0;
    case LWS_CALLBACK_SERVER_NEW_CLIENT_INSTANTIATED:
      ++impl_of(wsi)->connections;
      return 0;
    case LWS_CALLBACK_WSI_DESTROY:
      if (Endpoint::Impl* impl = impl_of(wsi); impl->connections > 0) --impl->connections;
      return 0;
    case LWS_CALLBACK_HTTP_CONFIRM_UPGRADE:
      return confirm_upgrade(wsi);
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:
      return -1;  // an upgrade without a known protocol arrives here
    case LWS_CALLBACK_EVENT_WAIT_CANCELLED:
      return 0;
    default:
      return lws_callback_http_dummy(wsi, reason, user, in, length);
  }
}

int on_operator(lws* wsi, lws_callback_reasons reason, void* user, void* in, size_t length) {
  if (reason != LWS_CALLBACK_HTTP) return on_http(wsi, reason, user, in, length);
  const Endpoint::Impl* impl = impl_of(wsi);
  return impl->http.answer_operator(wsi, in ? static_cast<const char*>(in) : "", impl->stopping);
}

}  // namespace

Endpoint::Endpoint(SessionHub& hub, StageQueues& queues)
    : impl_(std::make_unique<Impl>(hub, queues)) {}

Endpoint::~Endpoint() {
  if (!impl_->context) return;
  for (Impl::Timer* timer : {&impl_->fetch_timer, &impl_->sweep_timer}) {
    lws_sul_schedule(impl_->context, 0, &timer->timer, nullptr, LWS_SET_TIMER_USEC_CANCEL);
  }
  lws_context_destroy(impl_->context);
}

Result<lws_vhost*> Endpoint::Impl::listen_at(const ListenAddress& at, const char* name,
                                             const lws_protocols* protocols, bool tls) {
  lws_context_creation_info info{};
  info.options = LWS_SERVER_OPTION_VALIDATE_UTF8 |  // checks the reason of a close packet
                 LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND;
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
  info.protocols = protocols;
  info.timeout_secs = 10;
  info.ka_time = 30;
  info.ka_probes = 3;
  info.ka_interval = 10;
  info.retry_and_idle_policy = &kPings;
  info.vhost_name = name;
  if (tls) {
    info.options |= LWS_SERVER_OPTION_DO_SSL_GLOBAL_INIT;
    info.ssl_cert_filepath = options.tls_cert.c_str();
    info.ssl_private_key_filepath = options.tls_key.c_str();
    info.alpn = "http/1.1";
    // for TLS 1.2; the suites of 1.3 are all AEAD
    info.ssl_cipher_list = "ECDHE+AESGCM:ECDHE+CHACHA20";
  }
  lws_vhost* const made = lws_create_vhost(context, &info);
  if (made) return made;
  return make_error(ErrorId::kNetworkListen, "cannot listen on " + at.url(tls, at.port),
                    "is the port taken, or the certificate unreadable? --listen HOST:0 takes any "
                    "free port");
}

Result<void> Endpoint::listen(const EndpointOptions& options) {
  impl_->options = options;
  if (!options.web.empty()) {
    Result<WebPages> web = WebPages::read(options.web);
    if (!web) return web.error();
    impl_->http.serve(web.take());
  }
  if (options.downloads) impl_->http.serve(*options.downloads);
  const bool tls = !options.tls_cert.empty();
  lws_set_log_level(LLL_ERR, forward_log);
  lws_context_creation_info info{};
  info.options = LWS_SERVER_OPTION_EXPLICIT_VHOSTS | LWS_SERVER_OPTION_VALIDATE_UTF8;
  if (tls) info.options |= LWS_SERVER_OPTION_DO_SSL_GLOBAL_INIT;
  info.port = CONTEXT_PORT_NO_LISTEN;
  impl_->most = info.fd_limit_per_thread = most_sockets();
  info.user = impl_.get();
  info.gid = static_cast<gid_t>(-1);
  info.uid = static_cast<uid_t>(-1);
  impl_->context = lws_create_context(&info);
  if (!impl_->context) return make_error(ErrorId::kNetworkListen, "libwebsockets does not start");
  Result<lws_vhost*> served = impl_->listen_at(options.address, "mirage", kProtocols, tls);
  if (!served) return served.error();
  impl_->vhost = *served;
  if (!options.admin) return {};
  Result<lws_vhost*> admin = impl_->listen_at(*options.admin, "admin", kOperatorProtocols, false);
  if (!admin) return admin.error();
  const bool has_port = options.admin->socket_path.empty();
  const int taken = has_port ? lws_get_vhost_listen_port(*admin) : 0;
  spdlog::info("metrics and health are at {}", options.admin->url(false, taken));
  return {};
}

int Endpoint::port() const {
  const bool has_port = impl_->options.address.socket_path.empty();
  return has_port ? lws_get_vhost_listen_port(impl_->vhost) : 0;
}

Result<void> Endpoint::run(EndpointHooks hooks) {
  Impl& impl = *impl_;
  impl.hooks = std::move(hooks);
  std::int64_t drain_until_us = 0, gone_by_us = 0;
  impl.sweep_later();
  while (lws_service(impl.context, 0) >= 0) {
    if (impl.reloading.exchange(false)) {
      impl.read_certificate_anew();
      if (impl.hooks.reload) impl.hooks.reload();
    }
    const std::optional<Error> failure = impl.failure();
    if (failure) impl.stopping = true;
    if (!impl.stopping) continue;
    const std::int64_t now = impl.clock.now_us();
    if (drain_until_us == 0) {
      if (impl.hooks.stopping) impl.hooks.stopping();
      for (const Impl::Served& one : impl.served) one.hub->drain();
      drain_until_us = now + (failure ? 0 : std::llround(impl.options.drain_s * 1e6));
    }
    if (!impl.farewell && (impl.drained() || now >= drain_until_us)) {
      impl.farewell = true;
      gone_by_us = now + kFarewellUs;
      for (const Impl::Served& one : impl.served) {
        one.hub->say_goodbye_to_all(failure ? "the server's graphics have failed"
                                            : "server is shutting down");
      }
      impl.ask_to_write();
    }
    if (impl.farewell && (impl.sockets.empty() || now >= gone_by_us)) break;
  }
  if (const std::optional<Error> failure = impl.failure()) return *failure;
  return {};
}

void Endpoint::serve(SessionHub& hub, StageQueues& queues) {
  Impl& impl = *impl_;
  const auto sockets = impl.sockets;
  for (const auto& [of, wsi] : sockets) {
    impl.leave(*static_cast<Connection*>(lws_wsi_user(wsi)));
    std::string why = "the scene is loaded anew";
    lws_close_reason(wsi, LWS_CLOSE_STATUS_GOINGAWAY, reinterpret_cast<unsigned char*>(why.data()),
                     why.size());
    lws_callback_on_writable(wsi);  // closes connections without a session
  }
  impl.serve(hub, queues);
  impl.drain_completions();  // what came before woke nobody
}

void Endpoint::add(const SceneChoice& choice, SessionHub& hub, StageQueues& queues) {
  Impl& impl = *impl_;
  impl.served.push_back({&hub, &queues.completions});
  for (lws* const wsi : impl.waiting_for(choice)) {
    auto& connection = *static_cast<Connection*>(lws_wsi_user(wsi));
    impl.enter(wsi, connection, hub);
    const Bytes hello = std::exchange(*connection.hello, {});
    const Result<void> done = hub.receive(connection.session, hello.data(), hello.size());
    if (!done) impl.close_soon(wsi, done.error());
  }
  impl.drain_completions();  // what came before woke nobody
}

void Endpoint::give_up(const SceneChoice& choice, const Error& error) {
  for (lws* const wsi : impl_->waiting_for(choice)) impl_->close_soon(wsi, error);
}

void Endpoint::remove(const SessionHub& hub) {
  auto& served = impl_->served;
  served.erase(std::remove_if(served.begin(), served.end(),
                              [&](const Impl::Served& one) { return one.hub == &hub; }),
               served.end());
}

void Endpoint::stop() {
  impl_->stopping = true;
  wake();
}

void Endpoint::reload() {
  impl_->reloading = true;
  wake();
}

void Endpoint::wake() {
  if (impl_->context) lws_cancel_service(impl_->context);
}

}  // namespace mirage
