#pragma once
// Takes in what the link brings.
// Input:  messages. Output: scene, tiles, geometry, images, views and references as they are held;
//         their pixels for the sink.
// Thread: the frame loop's. What comes is bounded by what was asked for, and by the upload budget.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "protocol/base/bytes.h"
#include "protocol/base/result.h"
#include "protocol/wire/message.h"

namespace mirage {

struct AssetId;
struct Capture;
struct PendingAsk;
struct SessionParts;
struct Tile;

class Arrivals {
 public:
  explicit Arrivals(SessionParts& parts) : s_(parts) {}

  /// Everything that has arrived, as far as it may be taken in within a frame; the first error.
  Result<void> take(std::int64_t now_us);

 private:
  Result<void> handle(Message message, std::int64_t now_us);
  /// Bytes of graphics memory a reply will fill, as far as it tells.
  std::size_t upload_cost(const Message& message) const;
  /// It is a picture of what shows none yet.
  bool first_image(const Message& message) const;
  Result<void> take_welcome(const wire::WelcomeT& welcome, std::int64_t came_us);
  void await_new_scene(std::int64_t now_us);
  /// Of the scene; one that comes before its turn waits for it.
  Result<void> take_page(Message page);
  /// The scene is there, or has grown.
  void take_scene(bool was_complete);
  /// `came_us`: when the link had it.
  Result<void> take_tile(const Message& message, std::int64_t came_us, std::int64_t now_us);
  Result<void> finish_asset(std::uint32_t request_id, const AssetId& id, std::size_t bytes,
                            std::int64_t came_us);
  void take_shadow(const PendingAsk& ask, const Capture& capture, const Tile& tile);
  Result<void> take_mesh(const Message& message, std::int64_t came_us, std::int64_t now_us);
  Result<void> take_image(const Message& message, std::int64_t came_us, std::int64_t now_us);
  Result<void> take_view(const Message& message, std::int64_t came_us);
  Result<void> take_reference(const wire::ReferenceReplyT& reply, const Bytes& bytes);
  void take_refusal(const wire::RefusedT& refused, std::int64_t now_us);

  SessionParts& s_;
  std::vector<Message> early_pages_;  ///< of the scene, before their turn
};

}  // namespace mirage
