#pragma once
// Scene opener.
// Input:  the scene as far as it is known, the predicted camera. Output: requests for the members
//         of groups that are, or soon will be, too near to be shown as one, and for the parts of
//         instances that are and do not come as geometry.
// Thread: the frame loop's. Never full: a group is asked for once; limits::kMaxOpensPerRequest at a
//         time.

#include <cstdint>
#include <optional>
#include <unordered_set>

namespace mirage {

struct SelectorInput;
namespace wire {
struct OpenRequestT;
}

class SceneOpener {
 public:
  /// A new connection, or a new scene: what was asked for does not come.
  void reset();
  /// What to ask for now, at most ten times a second, still without a number; nullopt: nothing.
  std::optional<wire::OpenRequestT> plan(const SelectorInput& in);

 private:
  std::unordered_set<std::uint32_t> asked_;  ///< by the server's id
  std::int64_t walked_us_ = INT64_MIN / 2;
};

}  // namespace mirage
