#pragma once
// Chosen scenes: the served scene with another clip or variant (SceneChoice). Each is loaded when a
// viewer asks for it, beside the served scene, and ends a while after its last viewer has left.
// Input:  choices of clients.
// Output: hubs, handed to the endpoint.
// Thread: the network loop's; one load at a time has a thread of its own.
// Full:   beyond `most` scenes with viewers, a choice is refused as busy.

#include <atomic>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "protocol/base/clock.h"
#include "protocol/base/result.h"
#include "protocol/model/scene_types.h"

namespace mirage {

class Access;
class Endpoint;
class ServedScene;
class SessionHub;

class ChosenScenes {
 public:
  using ScenePtr = std::unique_ptr<ServedScene>;
  struct Hooks {
    std::function<Result<ScenePtr>(const SceneChoice&)> load;  ///< on a thread of its own
    std::function<void(ScenePtr)> retire;                      ///< ends a scene
  };
  ChosenScenes(std::size_t most, const Clock& clock, Hooks hooks)
      : most_(most), clock_(clock), hooks_(std::move(hooks)) {}
  ~ChosenScenes() { end(); }
  /// Waits for a load under way, and ends all scenes.
  void end();

  /// Returns the hub that shows a choice; nullptr: it will be loaded, and look() tells the
  /// endpoint. Error kBusy: as many scenes as there may be have viewers.
  Result<SessionHub*> find(const SceneChoice& choice);
  /// Goes on with loading and ending. Called several times a second.
  void look(Endpoint& endpoint, const Access& access);
  /// Sets the rights of new clients.
  void set_access(const Access& access);
  /// Drops all scenes, after the endpoint has: they are choices of a scene that is gone.
  void clear();

 private:
  struct Chosen {
    SceneChoice choice;
    ScenePtr scene;
    std::int64_t used_us = 0;  ///< when it last had a viewer
  };
  struct Load {
    SceneChoice choice;
    bool dropped = false;  ///< its scene is not wanted any more
    std::optional<Result<ScenePtr>> done;
  };
  bool has_viewers(const Chosen& one) const;
  void take_loaded(Endpoint& endpoint, const Access& access);
  void end_unused(Endpoint& endpoint);
  void load_next();

  const std::size_t most_;
  const Clock& clock_;
  const Hooks hooks_;
  std::vector<Chosen> scenes_;
  std::deque<SceneChoice> wanted_;  ///< to be loaded
  std::unique_ptr<Load> load_;      ///< under way
  std::atomic<bool> loaded_{false};
  std::thread loading_;
};

}  // namespace mirage
