#include "client/native/native_link.h"

#include <libwebsockets.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstring>
#include <deque>
#include <mutex>
#include <random>
#include <thread>

#include "client/native/quiet_thread.h"
#include "client/native/unpacker.h"

namespace mirage {
namespace {

constexpr std::size_t kMaxOutbound = 1024;
constexpr std::size_t kMaxInbound = 4096;
constexpr int kFirstPauseMs = 100;
constexpr int kLongestPauseMs = 5000;
constexpr int kMostChancePercent = 15;  // of a pause; small enough that pauses still grow
// Header of a WebSocket packet, roughly: 2 to 14 bytes.
constexpr std::uint64_t kWebSocketOverhead = 8;

using SteadyTime = std::chrono::steady_clock;

int on_client(lws* wsi, lws_callback_reasons reason, void* user, void* in, size_t length);

const lws_protocols kProtocols[] = {
    {"mirage", on_client, 0, 128 * 1024, 0, nullptr, 0},
    {nullptr, nullptr, 0, 0, 0, nullptr, 0},
};

}  // namespace

struct NativeLink::Impl {
  ServerUrl url;
  lws_context* context = nullptr;
  lws* socket = nullptr;
  std::thread thread;
  std::atomic<bool> stopping{false};
  std::atomic<bool> leaving{false};  // the connection is to be closed and another one opened
  std::atomic<bool> connected{false};
  std::atomic<std::uint32_t> generation{0};
  std::atomic<std::uint64_t> bytes_up{0}, bytes_down{0};
  std::atomic<int> close_code{0};
  mutable std::mutex mutex;
  mutable std::condition_variable changed;
  std::function<void()> arrived;
  std::deque<Bytes> outbound;
  std::deque<std::pair<SteadyTime::time_point, Message>> inbound;
  std::string problem;
  std::optional<Error> refusal;
  std::atomic<bool> damaged{false};  // the connection brought something that cannot be unpacked
  // The network thread alone uses these.
  Bytes fragments;
  PacketAssembler assembler{limits::kMaxTransferBytes};
  std::uint32_t next_transfer = 1;
  int pause_ms = kFirstPauseMs;
  std::minstd_rand chance{std::random_device{}()};
  // A timer for the next try, because libwebsockets sleeps until it has something to do.
  struct RetryTimer {
    lws_sorted_usec_list_t timer{};  // first member: the callback gets its address
    Impl* impl = nullptr;
  };
  RetryTimer retry;

  void tell() {
    changed.notify_all();
    if (arrived) arrived();
  }

  void set_problem(const std::string& text) {
    const std::lock_guard<std::mutex> lock(mutex);
    problem = text;
    tell();
  }

  void connect() {
    const std::string address = url.address(), host = url.host_header();
    lws_client_connect_info info{};
    info.context = context;
    info.address = address.c_str();
    info.port = url.port;
    info.path = url.path.c_str();
    info.host = host.c_str();
    info.origin = nullptr;
    info.protocol = "mirage";
    info.local_protocol_name = "mirage";
    info.ssl_connection = url.tls ? LCCSCF_USE_SSL : 0;
    info.pwsi = &socket;
    lws_client_connect_via_info(&info);
  }

  void connect_later(int after_ms) {
    lws_sul_schedule(context, 0, &retry.timer, on_retry, after_ms * 1000ll + 1);
  }

  static void on_retry(lws_sorted_usec_list_t* timer) {
    Impl* impl = reinterpret_cast<RetryTimer*>(timer)->impl;
    if (!impl->stopping && !impl->socket) impl->connect();
    // A timer that runs before the poll does not end the poll, so wake it.
    lws_cancel_service(impl->context);
  }

  void down(const std::string& why) {
    if (stopping) return;
    socket = nullptr;
    fragments.clear();
    assembler = PacketAssembler(limits::kMaxTransferBytes);
    const std::lock_guard<std::mutex> lock(mutex);
    connected = false;
    outbound.clear();
    if (problem.empty() || !why.empty()) problem = why;
    tell();
    if (leaving.exchange(false)) return connect_later(0);
    // A random part is added, so that clients do not all return at once when their server is back.
    const int more_ms = pause_ms * kMostChancePercent / 100;
    connect_later(pause_ms + std::uniform_int_distribution<int>(0, more_ms)(chance));
    pause_ms = std::min(pause_ms * 2, kLongestPauseMs);
  }

  void up() {
    close_code = 0;
    leaving = false;
    const std::lock_guard<std::mutex> lock(mutex);
    problem.clear();
    inbound.clear();
    damaged = paused = false;
    ++generation;
    connected = true;
    tell();
  }

  // Takes bytes of a packet. Returns the value for the libwebsockets callback to return.
  int receive(lws* wsi, const std::uint8_t* bytes, std::size_t n) {
    if (fragments.size() + n > limits::kMaxMessageBytes) return -1;
    fragments.insert(fragments.end(), bytes, bytes + n);
    if (!lws_is_final_fragment(wsi) || lws_remaining_packet_payload(wsi) > 0) return 0;
    const Bytes packet = std::exchange(fragments, {});
    Result<std::optional<Bytes>> whole = assembler.accept(packet.data(), packet.size());
    if (!whole) return refuse(whole.error());
    if (!whole->has_value()) {
      pending_bytes += packet.size() + kWebSocketOverhead;
      return 0;
    }
    Result<Message> message = decode_message((*whole)->data(), (*whole)->size());
    if (!message) return refuse(message.error());
    // A client that is turned away at every hello keeps its growing pauses; a welcome ends them.
    if (message->body.type == wire::Body::Welcome) pause_ms = kFirstPauseMs;
    pending_bytes += packet.size() + kWebSocketOverhead;
    // Full renders are not counted, because they serve comparison, not the product.
    if (message->body.type != wire::Body::ReferenceReply) bytes_down += pending_bytes;
    pending_bytes = 0;
    unpacker->add({SteadyTime::now(), generation, message.take()});
    const std::lock_guard<std::mutex> lock(mutex);
    if (inbound.size() + unpacker->waiting() >= kMaxInbound) {
      paused = true;
      lws_rx_flow_control(wsi, 0);
    }
    return 0;
  }

  // The unpacker's thread calls this, and the next.
  void take_unpacked(Unpacker::Received received) {
    const std::lock_guard<std::mutex> lock(mutex);
    if (received.generation != generation) return;
    inbound.emplace_back(received.came, std::move(received.message));
    tell();
  }

  void take_damaged(std::uint32_t of, const Error& error) {
    if (of != generation) return;
    refuse(error);
    damaged = true;
    lws_cancel_service(context);
  }

  int refuse(const Error& error) {
    set_problem(error.line());
    const std::lock_guard<std::mutex> lock(mutex);
    refusal = error;
    return -1;
  }

  int write_one(lws* wsi) {
    if (damaged || leaving) return -1;
    Bytes message;
    bool more = false;
    {
      const std::lock_guard<std::mutex> lock(mutex);
      if (outbound.empty()) return 0;
      message = std::move(outbound.front());
      outbound.pop_front();
      more = !outbound.empty();
    }
    for (const Bytes& packet : split_into_packets(std::move(message), next_transfer++)) {
      std::vector<std::uint8_t> buffer(LWS_PRE + packet.size());
      std::memcpy(buffer.data() + LWS_PRE, packet.data(), packet.size());
      bytes_up += packet.size() + kWebSocketOverhead + 4;  // 4 bytes: clients mask
      const int n = lws_write(wsi, buffer.data() + LWS_PRE, packet.size(), LWS_WRITE_BINARY);
      if (n < static_cast<int>(packet.size())) return -1;
    }
    if (more) lws_callback_on_writable(wsi);
    return 0;
  }

  void wake_up() {
    if (!socket || !connected) return;
    {
      const std::lock_guard<std::mutex> lock(mutex);
      if (paused && inbound.size() + unpacker->waiting() < kMaxInbound / 2) {
        paused = false;
        lws_rx_flow_control(socket, 1);
      }
    }
    lws_callback_on_writable(socket);
  }

  void run() {
    retry.impl = this;
    connect_later(0);
    while (!stopping) lws_service(context, 0);
    lws_sul_schedule(context, 0, &retry.timer, nullptr, LWS_SET_TIMER_USEC_CANCEL);
  }

  std::uint64_t pending_bytes = 0;
  std::atomic<bool> paused{false};  // reading has stopped until messages are taken
  std::unique_ptr<Unpacker> unpacker;
};

namespace {

using SteadyTime = std::chrono::steady_clock;

int on_client(lws* wsi, lws_callback_reasons reason, void*, void* in, size_t length) {
  auto* impl = static_cast<NativeLink::Impl*>(lws_context_user(lws_get_context(wsi)));
  switch (reason) {
    case LWS_CALLBACK_CLIENT_ESTABLISHED:
      impl->up();
      return 0;
    case LWS_CALLBACK_CLIENT_CONNECTION_ERROR:
      impl->down(in ? std::string(static_cast<const char*>(in), length) : "cannot connect");
      return 0;
    case LWS_CALLBACK_CLIENT_RECEIVE:
      return impl->receive(wsi, static_cast<std::uint8_t*>(in), length);
    case LWS_CALLBACK_CLIENT_WRITEABLE:
      return impl->write_one(wsi);
    case LWS_CALLBACK_WS_PEER_INITIATED_CLOSE: {
      if (length < 2) return 0;
      const auto* bytes = static_cast<const std::uint8_t*>(in);
      impl->close_code = bytes[0] << 8 | bytes[1];
      impl->set_problem("server closed the connection: " +
                        std::string(reinterpret_cast<const char*>(bytes + 2), length - 2));
      return 0;
    }
    case LWS_CALLBACK_CLIENT_CLOSED:
      impl->down("");
      return 0;
    case LWS_CALLBACK_EVENT_WAIT_CANCELLED:
      impl->wake_up();
      return 0;
    default:
      return 0;
  }
}

void silent_log(int, const char*) {}

}  // namespace

NativeLink::NativeLink(const ServerUrl& url, std::function<void()> arrived, bool packed)
    : impl_(std::make_unique<Impl>()) {
  impl_->url = url;
  impl_->arrived = std::move(arrived);
  impl_->unpacker = std::make_unique<Unpacker>(
      Unpacker::Hooks{
          [impl = impl_.get()](Unpacker::Received r) { impl->take_unpacked(std::move(r)); },
          [impl = impl_.get()](std::uint32_t of, const Error& e) { impl->take_damaged(of, e); }},
      packed);
  lws_set_log_level(0, silent_log);
  lws_context_creation_info info{};
  info.port = CONTEXT_PORT_NO_LISTEN;
  info.protocols = kProtocols;
  info.user = impl_.get();
  info.gid = static_cast<gid_t>(-1);
  info.uid = static_cast<uid_t>(-1);
  info.options = url.tls ? LWS_SERVER_OPTION_DO_SSL_GLOBAL_INIT : 0;
  if (!url.ca_file.empty()) info.client_ssl_ca_filepath = impl_->url.ca_file.c_str();
  info.timeout_secs = 10;
  info.ka_time = 10;
  info.ka_probes = 3;
  info.ka_interval = 5;
  // libwebsockets ignores SIGPIPE for the whole program. The network thread blocks it anyway.
  struct sigaction of_program {};
  sigaction(SIGPIPE, nullptr, &of_program);
  impl_->context = lws_create_context(&info);
  sigaction(SIGPIPE, &of_program, nullptr);
  if (impl_->context) impl_->thread = quiet_thread("mirage-net", [this] { impl_->run(); });
}

NativeLink::~NativeLink() {
  impl_->stopping = true;
  if (impl_->context) lws_cancel_service(impl_->context);
  if (impl_->thread.joinable()) impl_->thread.join();
  impl_->unpacker.reset();  // it wakes the context
  if (impl_->context) lws_context_destroy(impl_->context);
}

void NativeLink::send(Bytes message) {
  {
    const std::lock_guard<std::mutex> lock(impl_->mutex);
    if (!impl_->connected || impl_->outbound.size() >= kMaxOutbound) return;
    impl_->outbound.push_back(std::move(message));
  }
  lws_cancel_service(impl_->context);
}

void NativeLink::reconnect() {
  impl_->leaving = true;
  lws_cancel_service(impl_->context);
}

std::vector<Message> NativeLink::receive() {
  std::vector<Message> out;
  {
    const std::lock_guard<std::mutex> lock(impl_->mutex);
    const auto now = SteadyTime::now();
    for (auto& [came, message] : impl_->inbound) {
      out.push_back(std::move(message));
      out.back().waited_us =
          std::chrono::duration_cast<std::chrono::microseconds>(now - came).count();
    }
    impl_->inbound.clear();
  }
  if (impl_->paused) lws_cancel_service(impl_->context);
  return out;
}

bool NativeLink::connected() const { return impl_->connected; }
std::uint32_t NativeLink::generation() const { return impl_->generation; }
LinkTraffic NativeLink::traffic() const { return {impl_->bytes_up, impl_->bytes_down}; }
int NativeLink::last_close_code() const { return impl_->close_code; }

bool NativeLink::wait_connected(int timeout_ms) const {
  std::unique_lock<std::mutex> lock(impl_->mutex);
  impl_->changed.wait_for(lock, std::chrono::milliseconds(timeout_ms),
                          [this] { return impl_->connected.load(); });
  return impl_->connected;
}

void NativeLink::wait_message(int timeout_ms) const {
  std::unique_lock<std::mutex> lock(impl_->mutex);
  impl_->changed.wait_for(lock, std::chrono::milliseconds(timeout_ms),
                          [this] { return !impl_->inbound.empty() || !impl_->connected; });
}

std::optional<Error> NativeLink::refusal() const {
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  return impl_->refusal;
}

std::string NativeLink::last_problem() const {
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  return impl_->problem;
}

}  // namespace mirage
