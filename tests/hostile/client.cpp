#include "tests/hostile/client.h"

#include <atomic>
#include <chrono>

#include "protocol/codec/codec_id.h"
#include "protocol/impostor/tile.h"
#include "protocol/impostor/tile_key.h"

namespace mirage::test {

wire::HelloT hello(const std::string& token) {
  wire::HelloT m;
  m.version_min = m.version_max = limits::kProtocolVersion;
  m.codecs = {static_cast<std::uint8_t>(TileCodec::kRaw),
              static_cast<std::uint8_t>(TileCodec::kZstd)};
  m.token = token;
  return m;
}

wire::Ask new_tile(std::uint32_t request, std::uint8_t size_class, std::uint32_t deadline_ms,
                   float error_px) {
  static std::atomic<std::uint32_t> count{0};
  constexpr std::uint32_t kEdge = 1u << 12;  // view cells of this level
  const std::uint32_t n = count++;
  const auto x = static_cast<std::uint16_t>(n % kEdge), y = static_cast<std::uint16_t>(n / kEdge);
  return {request, 0, 0, error_px, deadline_ms, 8, x, y, 12, 2, size_class, kLitTile, 0};
}

wire::ReferenceRequestT full_render(std::uint32_t request, std::uint32_t width,
                                    std::uint32_t height) {
  wire::ReferenceRequestT m;
  m.request_id = request;
  m.eye = std::make_unique<wire::Vec3d>(0, 0, 4);
  m.rotation = std::make_unique<wire::Quat>(1, 0, 0, 0);
  m.fov_y = 0.8;
  m.width = width;
  m.height = height;
  m.supersample = 1;
  return m;
}

Client::Client(int port, const std::string& token, const PeerFrom& from) : socket_(port, from) {
  if (!socket_.open()) return;
  send(hello(token));
  while (const std::optional<Message> message = next(10'000)) {
    const wire::InstancePageT* page = message->body.AsInstancePage();
    greeted_ = page && page->last;
    if (greeted_) return;
  }
}

void Client::ask(std::vector<wire::Ask> asks) {
  wire::RequestBatchT batch;
  batch.asks = std::move(asks);
  batch.credit_bytes = std::uint64_t{1} << 40;
  send(std::move(batch));
}

std::optional<Message> Client::next(int wait_ms) {
  while (const std::optional<ServerFrame> frame = socket_.next(wait_ms)) {
    if (frame->opcode == 8) {
      close_code_ = frame->close_code();
      return std::nullopt;
    }
    if (frame->opcode != 2) continue;
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(frame->payload.data());
    Result<std::optional<Bytes>> whole = assembler_.accept(bytes, frame->payload.size());
    if (!whole || !whole->has_value()) continue;
    Result<Message> message = decode_message((*whole)->data(), (*whole)->size());
    if (message) return message.take();
  }
  return std::nullopt;
}

double Client::tile_ms(std::uint8_t size_class) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  const std::uint32_t request = request_++;
  ask({new_tile(request, size_class)});
  while (const std::optional<Message> message = next(10'000)) {
    const wire::TileReplyT* tile = message->body.AsTileReply();
    if (tile && tile->request_id == request) {
      return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
    }
    const wire::RefusedT* refused = message->body.AsRefused();
    if (refused && refused->request_id == request) return -1;
  }
  return -1;
}

}  // namespace mirage::test
