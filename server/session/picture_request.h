#pragma once
// Picture request: which full render somebody wants by HTTP, and what the answer is.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "protocol/base/bytes.h"
#include "protocol/impostor/camera.h"
#include "protocol/model/sun_place.h"
#include "server/tile/tile_job.h"

namespace mirage {

struct PictureRequest {
  Camera camera;                ///< with the size of the picture
  bool posed = false;           ///< false: seen from the scene's home view
  std::uint32_t samples = 2;    ///< a side of a pixel
  std::optional<SunPlace> sun;  ///< nullopt: the scene's own light
  PictureFormat format = PictureFormat::kWebp;
  std::size_t most_bytes = 0;  ///< of an impostor, which is coarser then; 0: as many as it takes
  bool idle = false;           ///< drawn while the server has nothing else to do

  /// Returns a text that is equal for equal requests only.
  std::string key() const;
};

struct GotPicture {
  std::uint32_t request = 0;
  std::shared_ptr<const Bytes> file;  ///< null: refused
  wire::RefusalReason reason = wire::RefusalReason::None;
};

}  // namespace mirage
