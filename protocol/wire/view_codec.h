#pragma once
// View tiles on the wire: requests and replies.

#include "protocol/impostor/view_tile.h"
#include "protocol/wire/message.h"

namespace mirage {

/// Returns the pose of a request that passed check_body().
ViewPose view_pose(const wire::ViewRequestT& request);
/// Returns a request for the content of `screen` and some margin around it, with no more texels
/// than a view needs. Id and lighting are left unset.
wire::ViewRequestT view_request(const Camera& screen, double time_s);
/// Returns the camera of a view without the margin: that of the screen it is for, but for its size.
Camera screen_of(const Camera& view);
/// Returns the request for the scene's home view, which a server makes before any client asks.
wire::ViewRequestT home_view_request();
/// True if a request asks for the home view, under the scene's own light.
bool is_home_view(const wire::ViewRequestT& request);

/// A view as bytes: lossy colours and lossless planes. The reply has no request id yet.
struct EncodedView {
  wire::ViewReplyT reply;
  Bytes payload;
};
EncodedView encode_view(const ViewTile& view);
/// Decodes a view from hostile bytes: sizes are checked before allocating. Errors kWireValue,
/// kCodec.
Result<ViewTile> decode_view(const wire::ViewReplyT& reply, const Bytes& payload);
/// decode_view() in two steps: RGBA and planes one after the other, then the view made of them.
Result<Bytes> view_planes(const wire::ViewReplyT& reply, const Bytes& payload);
Result<ViewTile> view_of_planes(const wire::ViewReplyT& reply, const Bytes& planes);

}  // namespace mirage
