#pragma once
// Picture cache: full renders as files, and the requests by HTTP that wait for one under way.
// Input:  requests; encoded pictures
// Output: jobs of the render stage
// Thread: the network loop's
// Full:   the picture made longest ago is dropped first; with kMostPicturesWaiting under way,
//         further ones are refused

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "protocol/base/bytes.h"
#include "server/base/byte_budget.h"
#include "server/base/wait_list.h"
#include "server/tile/tile_queue.h"

namespace mirage {

inline constexpr std::size_t kMostPicturesWaiting = 128;

/// A picture to draw. Equal keys of one revision have equal pictures.
struct PictureAsk {
  std::string key;
  PictureFormat format = PictureFormat::kWebp;
  SceneShot shot;
  std::size_t most_bytes = 0;  ///< see PictureName
  bool idle = false;           ///< see ReferenceJob
};

class PictureCache {
 public:
  explicit PictureCache(TileQueue& queue) : queue_(queue) {}

  /// Returns a picture; nullptr: not here.
  std::shared_ptr<const Bytes> find(const std::string& key) const;
  /// Requests a picture, made once for all its waiters. False: too many are under way.
  bool wait(PictureAsk ask, std::uint32_t request);
  /// Ends the making of a picture (null: it failed) and returns the requests that wait for it.
  std::vector<std::uint32_t> finish(const std::string& key, std::shared_ptr<const Bytes> file);
  /// Forgets a request; a picture that nobody waits for is not drawn.
  void cancel(std::uint32_t request);
  std::size_t under_way() const { return making_.under_way(); }

 private:
  TileQueue& queue_;
  WaitList<std::string, std::uint32_t> making_;
  std::map<std::string, SessionId> jobs_;    ///< ids of making_ in the queue
  SessionId next_job_ = SessionId{1} << 63;  ///< no session has such an id
  std::map<std::string, std::shared_ptr<const Bytes>> made_;
  ByteBudget<std::string> budget_{64u << 20};  ///< of made_: some 30 KB each
};

}  // namespace mirage
