#pragma once
// Jobs and results that travel between the server's stages.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "protocol/base/bytes.h"
#include "protocol/codec/codec_id.h"
#include "protocol/impostor/camera.h"
#include "protocol/impostor/lighting_state.h"
#include "protocol/impostor/tile_key.h"
#include "protocol/impostor/view_tile.h"
#include "protocol/model/ground.h"
#include "wire_generated.h"

namespace mirage {

struct EncodedView;

using SessionId = std::uint64_t;

/// A request that waits for a tile.
struct Waiter {
  SessionId session = 0;
  std::uint32_t request_id = 0;
  float error_px = 0;            ///< rank that the client gave (wire.fbs, Ask)
  std::int64_t deadline_us = 0;  ///< on the server's clock; 0: none
  TileCodec codec = TileCodec::kZstd;
  std::int64_t asked_us = 0;
};

/// A tile with one request that waits for it.
struct TileAsk {
  TileKey key;
  TileId id;
  ObjectLighting lighting;
  Lighting world;  ///< for a shadow tile
  Waiter waiter;
};

/// One tile to render, for all requests.
struct TileJob {
  TileKey key;
  TileId id;
  ObjectLighting lighting;
  std::int64_t queued_us = 0;
  Lighting world;                      ///< for a shadow tile
  TileCodec codec = TileCodec::kZstd;  ///< of the first request
};

/// Pixels of one rendered page, shared by the encoders working on its tiles.
struct PagePixels {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;     ///< bottom row first, as GL reads it
  std::vector<std::uint8_t> depth;    ///< one code per texel
  std::vector<std::uint8_t> surface;  ///< empty if no tile of the page is relit or blended
};

/// A rendered tile on its way to an encoder.
struct RenderedTile {
  TileJob job;
  std::shared_ptr<const PagePixels> page;
  int x = 0, y = 0;  ///< lower left texel of the tile in the page
  std::uint32_t queue_us = 0;
  std::uint32_t render_us = 0;
};

/// A finished tile: header fields without a request id, and the encoded planes.
struct StoredTile {
  wire::TileReplyT reply;
  Bytes planes;
  std::size_t bytes() const { return planes.size() + sizeof(reply); }
};
using StoredTilePtr = std::shared_ptr<const StoredTile>;

/// A tile to look for in the sources.
struct FetchJob {
  TileId id;
  TileCodec codec = TileCodec::kZstd;
};
/// Result of a look into the sources; nothing if both are null.
struct FetchedTile {
  StoredTilePtr form;      ///< in the codec asked for
  StoredTilePtr lossless;  ///< else a form to make that from
};
/// A tile to be kept in the sources.
struct SaveJob {
  TileId id;
  TileCodec codec = TileCodec::kZstd;
  StoredTilePtr tile;
};

/// A form to be made from a lossless one.
struct FormJob {
  TileId id;
  StoredTilePtr lossless;
  TileCodec codec = TileCodec::kZstd;
};
/// A level of one of the scene's images.
struct ImageLevel {
  std::uint32_t image = 0;
  std::uint8_t level = 0;
  bool operator<(const ImageLevel& o) const {
    return image != o.image ? image < o.image : level < o.level;
  }
};

/// A block of ground as bytes (ground_codec.h).
struct EncodedGround {
  Bytes bytes;
  std::uint32_t raw_bytes = 0;  ///< 0: it could not be made
};

/// A picture of the whole scene from one camera.
struct SceneShot {
  Camera camera;
  std::uint32_t supersample = 2;
  Lighting lighting;
  double time_s = 0;    ///< of the animation
  double level_px = 0;  ///< allowed error of levels of detail, px; 0: whole meshes
  /// True: whole meshes whatever `level_px` is. Such a picture can be drawn before there are
  /// levels.
  bool whole = false;
};

/// A drawn picture of the scene; rows from the top.
struct SceneFrame {
  std::vector<std::uint8_t> rgba;  ///< sRGB, alpha = coverage by objects
  std::vector<float> depth;        ///< eye depth, m; 0: none
  std::vector<std::uint32_t> ids;  ///< instance + 1; 0: none
};

enum class PictureFormat : std::uint8_t { kWebp, kPng, kJpeg, kImpostor };
/// A full render that goes out as a file, to everybody who asked for it under this key.
struct PictureName {
  std::string key;
  PictureFormat format = PictureFormat::kWebp;
  Camera camera{};
  std::size_t most_bytes = 0;  ///< an impostor gets coarser until it has so many; 0: never
};

/// A full render of the scene: for comparison, or as a picture.
struct ReferenceJob {
  SessionId session = 0;
  std::uint32_t request_id = 0;
  SceneShot shot;
  std::optional<PictureName> picture{};
  bool idle = false;  ///< drawn while nothing else waits, and put back for any slow work
};

/// A view tile to draw, for all requests.
struct ViewJob {
  TileId id;
  SceneShot shot;
  bool home = false;   ///< the home view: made before anybody asks, so it may take longer
  bool wanted = true;  ///< a request waits for it; else it is drawn when idle
};
/// A drawn view on its way to an encoder.
struct RenderedView {
  TileId id;
  Camera camera;
  double time_s = 0;  ///< of the animation
  SceneFrame frame;
};

/// A drawn full render on its way to its client.
struct RenderedReference {
  SessionId session = 0;
  std::uint32_t request_id = 0;
  std::uint32_t width = 0, height = 0;  ///< px
  SceneFrame frame;
  std::uint32_t render_us = 0;
  std::optional<PictureName> picture{};
};

using EncodeJob = std::variant<RenderedTile, FormJob, RenderedView, RenderedReference>;
/// Returns the bytes of the job's pixels, or of its part of a page.
std::size_t pixel_bytes(const EncodeJob& job);

// Completions: results that the stages hand to the network loop.

/// A tile, or another form of one, for all requests that wait for it in `codec`.
struct FinishedTile {
  TileId id;
  TileCodec codec = TileCodec::kZstd;
  StoredTilePtr tile;
  StoredTilePtr lossless = nullptr;  ///< set if just rendered: source of its other forms
};
/// A tile refused because it takes too much graphics memory.
struct TooLargeTile {
  TileId id;
};
/// Result of a look into the sources, for all requests that wait for the tile in `codec`.
struct FinishedFetch {
  TileId id;
  TileCodec codec = TileCodec::kZstd;
  FetchedTile found;
};
/// A tile that another server is rendering; the fetch stage keeps looking for it.
struct PendingFetch {
  TileId id;
  TileCodec codec = TileCodec::kZstd;
};
/// An encoded image, for all requests that wait for it.
struct FinishedImage {
  ImageLevel level;
  Bytes bytes;  ///< empty: it failed
};
/// A block of ground, for all requests that wait for it.
struct FinishedGround {
  GroundBlockId block;
  EncodedGround ground;
};
/// An encoded view, for all requests that wait for it.
struct FinishedView {
  TileId id;
  std::shared_ptr<const EncodedView> view;  ///< null: it failed
};
/// The answer to a request for a full render, as a whole message.
struct FinishedReference {
  SessionId session = 0;
  Bytes message;
};
/// A full render as a file, for all requests that wait for it.
struct FinishedPicture {
  std::string key;
  std::shared_ptr<const Bytes> file;  ///< null: it failed
};
/// The scene's levels of detail are made, and its tiles can be drawn.
struct LevelsMade {};
/// The renderer has failed, and the server must end with this error.
struct RendererFailure {
  Error error;
};
using Completion = std::variant<FinishedTile, TooLargeTile, FinishedFetch, PendingFetch,
                                FinishedImage, FinishedGround, FinishedView, FinishedReference,
                                FinishedPicture, LevelsMade, RendererFailure>;

}  // namespace mirage
