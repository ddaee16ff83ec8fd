#pragma once
// Scene opener: asks for the members of groups, and for the parts of instances, before they are
// needed.
// Input:  the scene as far as it is known, the predicted camera.
// Output: requests for the members of groups that are, or soon will be, too near to be shown as
//         one, and for the parts of instances that are too near and do not come as geometry.
// Thread: the frame loop's.
// Full:   never; a group is asked for once, limits::kMaxOpensPerRequest groups at a time.

#include <cstdint>
#include <optional>
#include <unordered_set>
#include <vector>

namespace mirage {

struct SelectorInput;
namespace wire {
struct OpenRequestT;
}

class SceneOpener {
 public:
  /// Forgets what was asked for. Call it for a new connection or scene, where no reply will come.
  void reset();
  /// Returns the requests to send now, without their numbers: at most one a view, ten times a
  /// second.
  std::vector<wire::OpenRequestT> plan(const std::vector<SelectorInput>& views);

 private:
  std::optional<wire::OpenRequestT> ask(const SelectorInput& in);

  std::unordered_set<std::uint32_t> asked_;  ///< the server's ids
  std::int64_t walked_us_ = INT64_MIN / 2;
};

}  // namespace mirage
