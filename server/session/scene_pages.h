#pragma once
// The description of the scene as clients get it: after the welcome its images, objects and what of
// its tree of groups the home view needs; the rest as it is asked for.

#include <deque>
#include <memory>
#include <vector>

#include "protocol/wire/message.h"
#include "server/session/outbox.h"
#include "server/session/scene_opening.h"

namespace mirage {

struct PreparedScene;

/// Encoded pages, in the order they are sent; each within the limits of `protocol/base/limits.h`.
/// Of a small scene it is everything.
std::vector<FramePtr> make_scene_pages(const PreparedScene& scene);

/// What is told of the tree, page by page: nothing is made before it can be sent, so that a client
/// who asks for much, or does not read, neither stops the others nor takes memory.
class TreeTelling {
 public:
  /// The answer to `request`; at least one page, the last is marked. Groups that are not there, or
  /// more than a scene has, are passed over. The scene outlives it.
  TreeTelling(const PreparedScene& scene, const wire::OpenRequestT& request);
  /// Unasked, after the welcome: the roots, and what the home view needs.
  explicit TreeTelling(const PreparedScene& scene);

  /// nullptr: that was all. A page costs some tens of microseconds.
  FramePtr next_page();

 private:
  bool has_room(std::size_t records) const;
  void add_record(std::uint32_t id);
  FramePtr finish_page(bool last);

  const PreparedScene& scene_;
  wire::InstancePageT page_;
  std::deque<std::uint32_t> roots_;  ///< still to be told of
  GroupOpening opening_;
  std::deque<std::uint32_t> cut_;        ///< instances whose parts are still to be told of
  std::optional<std::uint32_t> opened_;  ///< whose members come next
  bool done_ = false;
};

}  // namespace mirage
