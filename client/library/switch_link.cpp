#include "client/library/switch_link.h"

#include <chrono>
#include <utility>

#include "client/native/native_link.h"

namespace mirage::library {
namespace {

constexpr std::int64_t kSilentUs = 3'000'000;  // after which nobody answers

std::int64_t steady_us() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::microseconds>(now).count();
}

}  // namespace

SwitchLink::SwitchLink() = default;
SwitchLink::~SwitchLink() = default;

void SwitchLink::connect(const ServerUrl& url, std::function<void()> arrived) {
  drop();
  native_ = std::make_unique<NativeLink>(url, std::move(arrived));
  address_ = url.unix_socket ? url.host : url.host + ":" + std::to_string(url.port);
  tls_ = url.tls;
  tried_us_ = steady_us();
}

void SwitchLink::drop() {
  if (native_) former_ += native_->generation();
  native_.reset();
}

void SwitchLink::reconnect() {
  if (native_) native_->reconnect();
}

void SwitchLink::send(Bytes message) {
  if (native_) native_->send(std::move(message));
}

std::vector<Message> SwitchLink::receive() {
  return native_ ? native_->receive() : std::vector<Message>();
}

bool SwitchLink::connected() const { return native_ && native_->connected(); }

std::uint32_t SwitchLink::generation() const {
  return former_ + (native_ ? native_->generation() : 0);
}

LinkTraffic SwitchLink::traffic() const { return native_ ? native_->traffic() : LinkTraffic(); }

std::optional<Error> SwitchLink::problem() const {
  if (!native_) return std::nullopt;
  if (native_->last_close_code() == close_code(ErrorId::kAuth)) {
    return make_error(ErrorId::kAuth, "the server refused the token");
  }
  if (std::optional<Error> refused = native_->refusal()) return refused;
  if (native_->connected()) return std::nullopt;
  const std::string why = native_->last_problem();
  if (why.empty() && steady_us() - tried_us_ < kSilentUs) return std::nullopt;
  return make_error(ErrorId::kNetworkConnect,
                    "no server answers at " + address_ + (why.empty() ? "" : ": " + why),
                    tls_ ? "is it a server with TLS? it is tried again and again"
                         : "does it listen there, and without TLS? it is tried again and again");
}

}  // namespace mirage::library
