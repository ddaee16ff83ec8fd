#pragma once
// Impostor files: pictures of the scene that also tell how far away its surfaces are.
//
// An impostor file is a WebP file, which everything that shows WebP shows. Behind the colours it
// has one more chunk, which other programs skip. Numbers are little-endian:
//
//   at  bytes
//    0      4  "MIRI"
//    4      4  bytes of what follows, without a padding byte
//    8      4  version, 1
//   12      4  vertical field of view, radians (float)
//   16      8  near and far, m (2 floats)
//   24     16  rotation, world from camera, quaternion x, y, z, w (4 floats); the camera looks
//              along its -z
//   40     24  eye, m (3 doubles)
//   64         depth: a lossless, gray WebP, kImpostorCellTexels of the picture to a texel
//
// A texel t, 0 to 255, has the eye depth z of the nearest surface in its cell:
//   1 / z = 1 / far + t / 255 * (1 / near - 1 / far)
// A sky has 0, and what is nearer than `near` has 255. A picture moves by a share of 1 / z when
// the eye moves aside, so the steps of t are steps on the screen.

#include "protocol/base/bytes.h"
#include "protocol/base/result.h"
#include "protocol/impostor/camera.h"
#include "server/tile/tile_job.h"

namespace mirage {

inline constexpr std::uint32_t kImpostorVersion = 1;
inline constexpr std::uint32_t kImpostorCellTexels = 4;

/// Returns the chunk of a drawn picture, a whole one. Error kCodec. A pure function.
Result<Bytes> impostor_chunk(const Camera& camera, const SceneFrame& frame);
/// Returns a WebP file of lossy colours with one chunk more. Error kCodec: it is another file.
Result<Bytes> with_chunk(const Bytes& webp, const Camera& camera, const Bytes& chunk);

}  // namespace mirage
