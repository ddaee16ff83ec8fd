#pragma once
// Arrivals: takes in what the link brings.
// Input:  messages.
// Output: scene, tiles, geometry, images, views and references, in the session; their pixels, for
//         the sink.
// Thread: the frame loop's.
// Full:   never; replies are limited by the asks, and by the upload budget of a frame.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "protocol/base/bytes.h"
#include "protocol/base/result.h"
#include "protocol/wire/message.h"
#include "protocol/wire/unpack.h"

namespace mirage {

struct AssetId;
struct Capture;
struct PendingAsk;
struct SessionParts;

class Arrivals {
 public:
  explicit Arrivals(SessionParts& parts) : s_(parts) {}

  /// Takes in everything that has arrived, as far as a frame allows. Returns the first error.
  Result<void> take(std::int64_t now_us);

 private:
  Result<void> handle(Message message, std::int64_t now_us);
  /// Returns the bytes of graphics memory that a reply will fill, as far as it tells.
  std::size_t upload_cost(const Message& message) const;
  /// True if it is the first picture of an instance.
  bool first_image(const Message& message) const;
  Result<void> take_welcome(const wire::WelcomeT& welcome, std::int64_t came_us);
  void await_new_scene(std::int64_t now_us);
  /// Takes a page of the scene. A page that comes before its turn waits for it.
  Result<void> take_page(Message page);
  /// Tells the other parts that the scene is complete, or has grown.
  void take_scene(bool was_complete);
  /// `came_us` is when the link received it.
  Result<void> take_tile(const Message& message, std::int64_t came_us, std::int64_t now_us);
  Result<void> finish_asset(std::uint32_t request_id, const AssetId& id, std::size_t bytes,
                            std::int64_t came_us);
  void take_shadow(const PendingAsk& ask, const Capture& capture, const UnpackedTile& taken);
  Result<void> take_mesh(const Message& message, std::int64_t came_us, std::int64_t now_us);
  Result<void> take_image(const Message& message, std::int64_t came_us, std::int64_t now_us);
  Result<void> take_ground(const Message& message, std::int64_t came_us);
  Result<void> take_view(const Message& message, std::int64_t came_us);
  Result<void> take_reference(const wire::ReferenceReplyT& reply, const Bytes& bytes);
  void take_refusal(const wire::RefusedT& refused, std::int64_t now_us);

  SessionParts& s_;
  MessageUnpacker unpacker_;          ///< for links without a thread that unpacks
  std::vector<Message> early_pages_;  ///< pages of the scene that came before their turn
};

}  // namespace mirage
