#pragma once
// View tiles on the wire: what is asked for, and what comes.

#include "protocol/impostor/view_tile.h"
#include "protocol/wire/message.h"

namespace mirage {

/// Of a request that check_body() let pass.
ViewPose view_pose(const wire::ViewRequestT& request);
/// A request for what `screen` shows and somewhat around it, with no more texels than a view needs.
/// Without an id and lighting.
wire::ViewRequestT view_request(const Camera& screen, double time_s);
/// The view of the scene's home that a server makes before anybody asks for it.
wire::ViewRequestT home_view_request();
/// Whether a request is for that one, by what it says: under the scene's own light.
bool is_home_view(const wire::ViewRequestT& request);

/// Colours with loss, the planes without. The reply lacks a request id.
struct EncodedView {
  wire::ViewReplyT reply;
  Bytes payload;
};
EncodedView encode_view(const ViewTile& view);
/// Takes hostile bytes: sizes are checked before allocating. Errors kWireValue, kCodec.
Result<ViewTile> decode_view(const wire::ViewReplyT& reply, const Bytes& payload);
/// The same in two steps: RGBA and planes one after the other, then the view of them.
Result<Bytes> view_planes(const wire::ViewReplyT& reply, const Bytes& payload);
Result<ViewTile> view_of_planes(const wire::ViewReplyT& reply, const Bytes& planes);

}  // namespace mirage
