#include "client/load/tile_verifier.h"

#include <unistd.h>

#include "protocol/codec/tile_codec.h"
#include "protocol/wire/conversions.h"

namespace mirage {
namespace {
constexpr std::size_t kMaxWaiting = 8192;  // tiles of some 15 KB
}

Result<void> verify_tile(const VerifyTask& task) {
  Result<Tile> tile = tile_from_fields(task.reply);
  if (!tile) return tile.error();
  const auto codec = static_cast<TileCodec>(task.reply.codec);
  const Result<void> decoded =
      decode_tile_planes(task.planes.data(), task.planes.size(), codec, *tile);
  if (!decoded) return decoded.error();
  if (tile_content_hash(*tile) != task.reply.content_hash) {
    return make_error(ErrorId::kComparison, "tile content differs from its announced hash");
  }
  const std::vector<std::uint8_t>& rgba = tile->rgba;
  for (std::size_t i = 0; i < rgba.size(); i += 4) {
    if (rgba[i + 3] == 0 && (rgba[i] | rgba[i + 1] | rgba[i + 2]) != 0) {
      return make_error(ErrorId::kComparison, "texel without coverage has a colour");
    }
  }
  return {};
}

TileVerifier::TileVerifier() : tasks_(kMaxWaiting), thread_([this] { run(); }) {}

void TileVerifier::run() {
  // Linux sets the niceness of the calling thread alone. If this fails, checking only costs more.
  [[maybe_unused]] const int niceness = nice(19);
  while (const std::optional<VerifyTask> task = tasks_.pop()) {
    const Result<void> good = verify_tile(*task);
    ++verified_;
    if (good) continue;
    if (failures_++ == 0) first_failure_ = good.error().line();
  }
}

void TileVerifier::finish() {
  tasks_.close();
  if (thread_.joinable()) thread_.join();
}

}  // namespace mirage
