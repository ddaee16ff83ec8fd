#pragma once
// Pictures as files: full renders that browsers and other programs get by HTTP.

#include <optional>
#include <string>
#include <vector>

#include "protocol/base/bytes.h"
#include "protocol/base/result.h"
#include "server/tile/tile_job.h"

namespace mirage {

/// Returns the format of this name: webp, png, jpeg, impostor.
std::optional<PictureFormat> picture_format(const std::string& name);
/// Returns the media type, such as image/webp.
const char* media_type(PictureFormat format);

/// Returns the file of a drawn full render, its sky included. WebP and JPEG are lossy; an impostor
/// has depth as well (impostor_file.h). Errors kModule, kIo, kCodec.
Result<Bytes> encode_picture(const RenderedReference& drawn, const PictureName& name);

}  // namespace mirage
