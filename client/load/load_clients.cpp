#include "client/load/load_clients.h"

#include <libwebsockets.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstring>
#include <deque>
#include <vector>

#include "protocol/base/clock.h"

namespace mirage {
namespace {

constexpr rlim_t kSpareFiles = 64;
constexpr unsigned int kReadBytes = 64 * 1024;
constexpr std::size_t kKeptCapacity = 64 * 1024;              // bytes kept per client
constexpr std::size_t kMaxTransferBytes = 32u * 1024 * 1024;  // the largest tile takes 20
constexpr int kMaxWritesPerCallback = 16;

int on_client(lws* wsi, lws_callback_reasons reason, void* user, void* in, size_t length);

const lws_protocols kProtocols[] = {
    {"mirage", on_client, 0, kReadBytes, 0, nullptr, 0},
    {nullptr, nullptr, 0, 0, 0, nullptr, 0},
};

enum class LinkState : std::uint8_t { kIdle, kConnecting, kOpen, kDown };

struct Connection {
  LoadClients::Impl* all = nullptr;
  std::uint32_t index = 0;
  LinkState state = LinkState::kIdle;
  lws* socket = nullptr;
  std::vector<Bytes> outbound;
  std::size_t sent = 0;  // bytes of `outbound` that were sent
  Bytes inbound;         // fragments of the message under way
  PacketAssembler assembler{kMaxTransferBytes};
  std::string down_id, down_text;
};

// A timer that knows its context, because libwebsockets passes only the list node to its callback.
struct WakeTimer {
  lws_sorted_usec_list_t node{};
  lws_context* context = nullptr;
};

// Raises the limit on open files only as far as needed, because libwebsockets sizes its tables by
// it.
Result<void> allow_open_files(rlim_t wanted) {
  rlimit limit{};
  getrlimit(RLIMIT_NOFILE, &limit);
  if (limit.rlim_max != RLIM_INFINITY && limit.rlim_max < wanted) {
    return make_error(ErrorId::kUsage,
                      "this process may open " + std::to_string(limit.rlim_max) + " files only",
                      "fewer --clients, or a higher `ulimit -Hn`");
  }
  limit.rlim_cur = std::max<rlim_t>(wanted, 1024);
  if (limit.rlim_max != RLIM_INFINITY) limit.rlim_cur = std::min(limit.rlim_cur, limit.rlim_max);
  setrlimit(RLIMIT_NOFILE, &limit);
  return {};
}

// Returns the error id of a close code with one meaning; other codes name themselves.
std::string id_from_close_code(int code) {
  for (const ErrorId id : {ErrorId::kAuth, ErrorId::kBusy, ErrorId::kWireVersion}) {
    if (code == close_code(id)) return std::string(error_name(id));
  }
  const bool ordinary = code == LWS_CLOSE_STATUS_NORMAL || code == LWS_CLOSE_STATUS_GOINGAWAY;
  return ordinary ? "network-closed" : "closed-" + std::to_string(code);
}

void silent_log(int, const char*) {}

}  // namespace

struct LoadClients::Impl {
  Impl(ServerUrl to, std::uint32_t count, LoadSink& s)
      : url(std::move(to)), sink(s), connections(count) {
    for (std::uint32_t i = 0; i < count; ++i) {
      connections[i].all = this;
      connections[i].index = i;
    }
  }

  ServerUrl url;
  LoadSink& sink;
  std::vector<Connection> connections;
  lws_context* context = nullptr;
  WakeTimer timer;
  std::vector<std::uint8_t> write_buffer;
  std::uint64_t bytes = 0;
  std::size_t live = 0;  // connecting or open
  bool closing = false;

  void down(Connection& c) {
    if (c.state != LinkState::kConnecting && c.state != LinkState::kOpen) return;
    c.state = LinkState::kDown;
    c.socket = nullptr;
    c.outbound = {};
    c.sent = 0;
    c.inbound = {};
    c.assembler = PacketAssembler(kMaxTransferBytes);
    --live;
    if (!closing) sink.on_down(c.index, c.down_id, c.down_text);
  }

  // The functions below return the value for the libwebsockets callback to return.
  int refuse(Connection& c, const Error& error) {
    c.down_id = error_name(error.id);
    c.down_text = error.text;
    return -1;
  }

  int handle(Connection& c, const std::uint8_t* packet, std::size_t size) {
    bytes += size;
    const bool chunk = size > 3 && packet[3] == static_cast<std::uint8_t>(PacketKind::kChunk);
    if (!chunk) {  // the usual case, without a copy
      const Result<void> taken = sink.on_message(c.index, packet, size);
      return taken ? 0 : refuse(c, taken.error());
    }
    Result<std::optional<Bytes>> whole = c.assembler.accept(packet, size);
    if (!whole) return refuse(c, whole.error());
    if (!whole->has_value()) return 0;
    const Result<void> taken = sink.on_message(c.index, (*whole)->data(), (*whole)->size());
    return taken ? 0 : refuse(c, taken.error());
  }

  int receive(Connection& c, const std::uint8_t* part, std::size_t n) {
    if (!lws_frame_is_binary(c.socket)) {
      return refuse(c, make_error(ErrorId::kWireMalformed, "server sent a text frame"));
    }
    if (c.inbound.size() + n > limits::kMaxMessageBytes) {
      return refuse(c, make_error(ErrorId::kWireLimit, "message is larger than allowed"));
    }
    const bool last =
        lws_is_final_fragment(c.socket) && lws_remaining_packet_payload(c.socket) == 0;
    if (last && c.inbound.empty()) return handle(c, part, n);
    c.inbound.insert(c.inbound.end(), part, part + n);
    if (!last) return 0;
    const int result = handle(c, c.inbound.data(), c.inbound.size());
    if (c.inbound.capacity() > kKeptCapacity) {
      c.inbound = {};
    } else {
      c.inbound.clear();
    }
    return result;
  }

  int write_some(Connection& c) {
    if (closing) {
      lws_close_reason(c.socket, LWS_CLOSE_STATUS_NORMAL, nullptr, 0);
      return -1;
    }
    for (int i = 0; i < kMaxWritesPerCallback && c.sent < c.outbound.size(); ++i) {
      const Bytes& message = c.outbound[c.sent++];
      write_buffer.resize(LWS_PRE + message.size());
      std::memcpy(write_buffer.data() + LWS_PRE, message.data(), message.size());
      const int n =
          lws_write(c.socket, write_buffer.data() + LWS_PRE, message.size(), LWS_WRITE_BINARY);
      if (n < static_cast<int>(message.size())) return -1;
      if (lws_send_pipe_choked(c.socket)) break;
    }
    if (c.sent < c.outbound.size()) {
      lws_callback_on_writable(c.socket);
    } else {
      c.outbound.clear();
      c.sent = 0;
    }
    return 0;
  }
};

namespace {

// A timer that is due before the wait begins would be served and forgotten, and the wait would last
// until the next timer. The cancel ends that wait as well.
void wake(lws_sorted_usec_list_t* node) {
  lws_cancel_service(reinterpret_cast<WakeTimer*>(node)->context);
}

void note_close_code(Connection& c, const void* in, std::size_t length) {
  if (length < 2) return;
  const auto* bytes = static_cast<const std::uint8_t*>(in);
  c.down_id = id_from_close_code(bytes[0] << 8 | bytes[1]);
  c.down_text = "server closed the connection";
  if (length > 2) c.down_text += ": ";
  c.down_text.append(reinterpret_cast<const char*>(bytes + 2), length - 2);
}

int on_client(lws* wsi, lws_callback_reasons reason, void* user, void* in, size_t length) {
  auto* c = static_cast<Connection*>(user);
  if (!c) return 0;  // an event of the context, not of a connection
  switch (reason) {
    case LWS_CALLBACK_CLIENT_ESTABLISHED:
      c->socket = wsi;
      c->state = LinkState::kOpen;
      c->all->sink.on_open(c->index);
      return 0;
    case LWS_CALLBACK_CLIENT_CONNECTION_ERROR:
      c->down_id = error_name(ErrorId::kNetworkConnect);
      c->down_text = in ? std::string(static_cast<const char*>(in), length) : "cannot connect";
      c->all->down(*c);
      return 0;
    case LWS_CALLBACK_CLIENT_RECEIVE:
      return c->all->receive(*c, static_cast<const std::uint8_t*>(in), length);
    case LWS_CALLBACK_CLIENT_WRITEABLE:
      return c->all->write_some(*c);
    case LWS_CALLBACK_WS_PEER_INITIATED_CLOSE:
      note_close_code(*c, in, length);
      return 0;
    case LWS_CALLBACK_CLIENT_CLOSED:
      c->all->down(*c);
      return 0;
    default:
      return 0;
  }
}

}  // namespace

LoadClients::LoadClients(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

LoadClients::~LoadClients() {
  impl_->closing = true;
  lws_sul_cancel(&impl_->timer.node);
  lws_context_destroy(impl_->context);
}

Result<std::unique_ptr<LoadClients>> LoadClients::create(const ServerUrl& url, std::uint32_t count,
                                                         LoadSink& sink) {
  if (Result<void> allowed = allow_open_files(count + kSpareFiles); !allowed) {
    return allowed.error();
  }
  lws_set_log_level(0, silent_log);
  lws_context_creation_info info{};
  info.port = CONTEXT_PORT_NO_LISTEN;
  info.protocols = kProtocols;
  info.gid = static_cast<gid_t>(-1);
  info.uid = static_cast<uid_t>(-1);
  info.options = url.tls ? LWS_SERVER_OPTION_DO_SSL_GLOBAL_INIT : 0;
  if (!url.ca_file.empty()) info.client_ssl_ca_filepath = url.ca_file.c_str();
  info.timeout_secs = 10;
  info.pt_serv_buf_size = kReadBytes;
  auto impl = std::make_unique<Impl>(url, count, sink);
  impl->context = lws_create_context(&info);
  if (!impl->context) return make_error(ErrorId::kInternal, "libwebsockets does not start");
  return std::unique_ptr<LoadClients>(new LoadClients(std::move(impl)));
}

void LoadClients::connect(std::uint32_t client) {
  Connection& c = impl_->connections[client];
  c.state = LinkState::kConnecting;
  c.down_id = "network-closed";
  c.down_text = "server closed the connection";
  ++impl_->live;
  const std::string address = impl_->url.address(), host = impl_->url.host_header();
  lws_client_connect_info info{};
  info.context = impl_->context;
  info.address = address.c_str();
  info.port = impl_->url.port;
  info.path = impl_->url.path.c_str();
  info.host = host.c_str();
  info.protocol = "mirage";
  info.local_protocol_name = "mirage";
  info.ssl_connection = impl_->url.tls ? LCCSCF_USE_SSL : 0;
  info.userdata = &c;
  if (!lws_client_connect_via_info(&info)) {
    c.down_id = error_name(ErrorId::kNetworkConnect);
    c.down_text = "cannot connect";
    impl_->down(c);  // no effect if the callback has reported it already
  }
}

void LoadClients::send(std::uint32_t client, Bytes message) {
  Connection& c = impl_->connections[client];
  if (c.state != LinkState::kOpen) return;
  c.outbound.push_back(std::move(message));
  lws_callback_on_writable(c.socket);
}

void LoadClients::service(std::int64_t wait_us) {
  if (wait_us <= 0) {
    lws_service(impl_->context, -1);  // does not wait
    return;
  }
  impl_->timer.context = impl_->context;
  lws_sul_schedule(impl_->context, 0, &impl_->timer.node, wake, wait_us);
  lws_service(impl_->context, 0);
}

void LoadClients::close_all(std::int64_t wait_us) {
  impl_->closing = true;
  for (Connection& c : impl_->connections) {
    if (c.state == LinkState::kOpen) lws_callback_on_writable(c.socket);
  }
  const SteadyClock clock;
  while (impl_->live > 0 && clock.now_us() < wait_us) service(wait_us - clock.now_us());
}

std::uint64_t LoadClients::bytes() const { return impl_->bytes; }

}  // namespace mirage
