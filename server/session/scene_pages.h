#pragma once
// The scene's description as clients receive it. After the welcome come images, objects, and the
// part of the group tree that the home view needs. The rest follows on request.

#include <deque>
#include <memory>
#include <vector>

#include "protocol/wire/message.h"
#include "server/session/outbox.h"
#include "server/session/scene_opening.h"

namespace mirage {

struct PreparedScene;

/// Returns the encoded pages in order of sending; each respects the limits of
/// `protocol/base/limits.h`. A small scene is complete with them.
std::vector<PacketPtr> make_scene_pages(const PreparedScene& scene);

/// Sends the tree page by page. No page is made before it can be sent. A client that asks for much,
/// or does not read, therefore neither blocks the others nor takes memory.
class TreeTelling {
 public:
  /// Answers `request` with at least one page; the last is marked. Unknown groups, and more groups
  /// than a scene has, are ignored. The scene must outlive this object.
  TreeTelling(const PreparedScene& scene, const wire::OpenRequestT& request);
  /// Sends, unasked after the welcome, the roots and the groups that the home view needs.
  explicit TreeTelling(const PreparedScene& scene);

  /// Returns the next page; nullptr: no more. A page costs some tens of microseconds.
  PacketPtr next_page();

 private:
  bool has_room(std::size_t records) const;
  void add_record(std::uint32_t id);
  PacketPtr finish_page(bool last);

  const PreparedScene& scene_;
  wire::InstancePageT page_;
  std::deque<std::uint32_t> roots_;  ///< roots not sent yet
  GroupOpening opening_;
  std::deque<std::uint32_t> cut_;        ///< instances whose parts are not sent yet
  std::optional<std::uint32_t> opened_;  ///< group whose members come next
  bool done_ = false;
};

}  // namespace mirage
