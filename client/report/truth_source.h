#pragma once
// Truth source: full renders of a scene by its server. Each is asked for once, however many runs
// are compared with it.
// Input:  cameras, samples and light.
// Output: full renders.
// Thread: one at a time.
// Full:   never; it keeps all renders until forget().

#include <map>
#include <memory>
#include <string>

#include "client/frame/reference_frame.h"
#include "protocol/base/result.h"
#include "protocol/impostor/camera.h"
#include "protocol/impostor/lighting_state.h"

namespace mirage {

class Client;
class ClientHost;
class SceneView;
using ReferencePtr = std::shared_ptr<const ReferenceFrame>;

class TruthSource {
 public:
  /// Connects and learns the scene; moving objects stay at the beginning of their clips. Errors as
  /// ClientHost's.
  static Result<std::unique_ptr<TruthSource>> open(const std::string& url);

  TruthSource();
  ~TruthSource();
  const SceneView& scene() const;
  /// Sets the light of later renders.
  void set_lighting(const Lighting& lighting);
  /// Returns the full render with `samples` along each axis of a pixel. Errors as
  /// ClientHost::reference.
  Result<ReferencePtr> at(const Camera& camera, std::uint32_t samples);
  /// Forgets the kept renders; those handed out stay valid.
  void forget() { kept_.clear(); }

 private:
  std::unique_ptr<Client> client_;  ///< without graphics
  std::unique_ptr<ClientHost> host_;
  std::map<std::string, ReferencePtr> kept_;  ///< by camera, samples and light, byte for byte
};

}  // namespace mirage
