#pragma once
// Sampler: a client without a picture, which looks from one eye after the other and waits at each
// until it would not ask for more.
// Input:  a link, poses.
// Output: asks, on the link; how wrong the picture would be.
// Thread: the caller's. Time is virtual, so that the same poses ask for the same files.
// Full:   as ClientSession.

#include <cstddef>
#include <functional>
#include <memory>

#include "client/freeze/options.h"
#include "protocol/base/result.h"
#include "protocol/impostor/camera.h"

namespace mirage {

class Link;
class SceneView;

/// The errors of views, from the bounds by which they were drawn.
struct SeenError {
  double worst_px = 0;     ///< the largest bound
  std::size_t views = 0;   ///< looked at
  std::size_t beyond = 0;  ///< views with a bound above the error that was asked for
  std::size_t bare = 0;    ///< views with a thing that has no image

  void add(const SeenError& other);
};

class Sampler {
 public:
  /// `link` must outlive it; `wait` waits until something has arrived on it, and returns false if
  /// nothing will.
  Sampler(Link& link, const FreezeOptions& options, std::function<bool()> wait);
  ~Sampler();

  /// Waits for the scene. Errors: those of ClientSession::receive(), kNetworkClosed.
  Result<void> open();
  const SceneView& scene() const;
  /// Looks from a pose until the picture rests, or would not get better for a while.
  Result<SeenError> look(const Pose& pose);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace mirage
