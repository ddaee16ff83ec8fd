#include "tests/hostile/web_socket.h"

#include <chrono>

namespace mirage::test {
namespace {

std::string big_endian(std::uint64_t value, int bytes) {
  std::string out;
  for (int i = bytes - 1; i >= 0; --i) out += static_cast<char>(value >> (8 * i) & 0xff);
  return out;
}

int fewest_bytes(std::uint64_t length) { return length < 126 ? 1 : length < 65536 ? 3 : 9; }

}  // namespace

std::string ClientFrame::bytes() const {
  const std::uint64_t length = declared.value_or(payload.size());
  const int told = length_bytes != 0 ? length_bytes : fewest_bytes(length);
  const std::uint64_t code = told == 1 ? length : told == 3 ? 126 : 127;
  std::string out;
  out += static_cast<char>((final ? 0x80 : 0) | reserved << 4 | opcode);
  out += static_cast<char>((masked ? 0x80 : 0) | static_cast<int>(code));
  if (told > 1) out += big_endian(length, told - 1);
  if (!masked) return out + payload;
  const std::string key = big_endian(mask, 4);
  out += key;
  for (std::size_t i = 0; i < payload.size(); ++i) {
    out += static_cast<char>(payload[i] ^ key[i % 4]);
  }
  return out;
}

int ServerFrame::close_code() const {
  if (payload.size() < 2) return 1005;
  return static_cast<unsigned char>(payload[0]) << 8 | static_cast<unsigned char>(payload[1]);
}

std::string Upgrade::bytes() const {
  return line + host + upgrade + connection + protocol + version + key + more + "\r\n";
}

WebSocket::WebSocket(int port, const PeerFrom& from, const Upgrade& request) : peer_(port, from) {
  peer_.say(request.bytes());
  const std::string end = "\r\n\r\n";
  while (heard_.find(end) == std::string::npos) {
    const std::string more = peer_.hear_within(2000);
    if (more.empty()) return;
    heard_ += more;
  }
  const std::size_t head = heard_.find(end) + end.size();
  answer_ = heard_.substr(0, head);
  heard_.erase(0, head);
}

std::optional<ServerFrame> WebSocket::next(int wait_ms) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point until = Clock::now() + std::chrono::milliseconds(wait_ms);
  for (;;) {
    if (std::optional<ServerFrame> frame = take_frame()) return frame;
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now()).count();
    if (left < 0 || peer_.ended()) return std::nullopt;
    heard_ += peer_.hear_within(static_cast<int>(left) + 1);
  }
}

std::optional<ServerFrame> WebSocket::take_frame() {
  const auto at = [&](std::size_t i) { return static_cast<unsigned char>(heard_[i]); };
  if (heard_.size() < 2) return std::nullopt;
  std::size_t head = 2;
  std::uint64_t length = at(1) & 0x7f;
  const std::size_t wide = length == 126 ? 2 : length == 127 ? 8 : 0;
  if (heard_.size() < head + wide) return std::nullopt;
  if (wide > 0) length = 0;
  for (std::size_t i = 0; i < wide; ++i) length = length << 8 | at(head++);
  if (heard_.size() - head < length) return std::nullopt;
  ServerFrame out;
  out.final = at(0) & 0x80;
  out.masked = at(1) & 0x80;
  out.reserved = at(0) >> 4 & 7;
  out.opcode = at(0) & 0x0f;
  out.payload = heard_.substr(head, length);
  heard_.erase(0, head + length);
  return out;
}

}  // namespace mirage::test
