#pragma once
// Full renders of a scene by its server: each is asked for once, however many runs are held
// against it. Thread: the GL one.

#include <map>
#include <memory>
#include <string>

#include "client/frame/reference_frame.h"
#include "protocol/base/result.h"
#include "protocol/impostor/camera.h"
#include "protocol/impostor/lighting_state.h"

namespace mirage {

class ClientHost;
class FrameRenderer;
class SceneView;
using ReferencePtr = std::shared_ptr<const ReferenceFrame>;

class TruthSource {
 public:
  /// Connects and learns the scene; objects that move stand at the beginning of their clips.
  /// `renderer` takes what a client is sent and outlives this. Errors as ClientHost's.
  static Result<std::unique_ptr<TruthSource>> open(const std::string& url, FrameRenderer& renderer);

  TruthSource();
  ~TruthSource();
  const SceneView& scene() const;
  /// Light of all renders from now on.
  void set_lighting(const Lighting& lighting);
  /// The full render with `samples` per axis of a pixel. Errors as ClientHost::reference.
  Result<ReferencePtr> at(const Camera& camera, std::uint32_t samples);
  /// Forgets what is kept; what was handed out stays.
  void forget() { kept_.clear(); }

 private:
  std::unique_ptr<ClientHost> host_;
  std::map<std::string, ReferencePtr> kept_;  ///< by camera, samples and light, byte for byte
};

}  // namespace mirage
