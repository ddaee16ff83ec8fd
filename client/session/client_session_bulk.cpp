// The client's session: what is no tile. Geometry, images and full renders.
#include <cstring>

#include "client/session/client_session.h"

namespace mirage {
namespace {
constexpr std::size_t kReplyBytes = 64;  // control part and header of a geometry reply
}  // namespace

std::size_t ClientSession::upload_cost(const Message& message) const {
  const wire::BodyUnion& body = message.body;
  if (const wire::TileReplyT* tile = body.AsTileReply()) {
    return tile_upload_bytes(tile->crop_w, tile->crop_h, tile->channels);
  }
  if (const wire::MeshReplyT* mesh = body.AsMeshReply()) {
    const bool known = mesh->object < scene_.objects.size() &&
                       mesh->lod < scene_.objects[mesh->object].lods.size();
    return known ? expected_gpu_bytes(scene_.objects[mesh->object].lods[mesh->lod]) : 0;
  }
  const wire::ImageReplyT* image = body.AsImageReply();
  if (!image || image->image >= scene_.images.size()) return 0;
  return image_gpu_bytes(image_level_size(scene_.images[image->image], image->level));
}

bool ClientSession::first_image(const Message& message) const {
  const wire::TileReplyT* tile = message.body.AsTileReply();
  const PendingAsk* ask = tile ? scheduler_.pending(tile->request_id) : nullptr;
  return ask && is_picture(ask->need.channels) &&
         !cache_.group_to_draw(ask->need.instance)->known();
}

// The reply is what was asked for by this id, and the scene is still the one it was asked for.
Result<void> ClientSession::finish_asset(std::uint32_t request_id, const AssetId& id,
                                         std::size_t bytes, std::int64_t came_us) {
  const std::optional<AssetNeed> need =
      scheduler_.finish_asset(request_id, bytes + kReplyBytes, came_us);
  if (need && scene_.complete() && need->id == id) return {};
  return make_error(ErrorId::kWireValue, "geometry or an image that was not asked for");
}

Result<void> ClientSession::take_mesh(const wire::MeshReplyT& reply, const Bytes& bytes,
                                      std::int64_t came_us, std::int64_t now_us) {
  const AssetId id{AssetId::Kind::kMesh, reply.object, reply.lod};
  const Result<void> asked = finish_asset(reply.request_id, id, bytes.size(), came_us);
  if (!asked) return asked.error();
  if (reply.raw_bytes > options_.max_mesh_bytes) {
    return make_error(ErrorId::kWireLimit, "geometry is larger than asked for");
  }
  Result<Bytes> raw = reply.raw_bytes == bytes.size()
                          ? Result<Bytes>(bytes)
                          : decompress_block(bytes.data(), bytes.size(), reply.raw_bytes);
  if (!raw) return raw.error();
  Result<ObjectModel> model = decode_model(raw->data(), raw->size(), scene_.images.size());
  if (!model) return model.error();
  shadows_.assets_changed();
  meshes_.add_mesh(reply.object, reply.lod, *model, now_us);
  uploads_.uploaded(mesh_gpu_bytes(model->mesh), false);
  if (sink_.mesh) sink_.mesh(reply.object, reply.lod, model.take());
  return {};
}

Result<void> ClientSession::take_image(const wire::ImageReplyT& reply, const Bytes& bytes,
                                       std::int64_t came_us, std::int64_t now_us) {
  const AssetId id{AssetId::Kind::kImage, reply.image, reply.level};
  const Result<void> asked = finish_asset(reply.request_id, id, bytes.size(), came_us);
  if (!asked) return asked.error();
  const ImageDescription& description = scene_.images[reply.image];
  Result<Image> image = decode_image(bytes.data(), bytes.size(),
                                     image_level_size(description, reply.level), description.srgb);
  if (!image) return image.error();
  shadows_.assets_changed();
  meshes_.add_image(scene_, reply.image, reply.level, bytes.size(), now_us);
  uploads_.uploaded(image_gpu_bytes({image->width, image->height}), false);
  if (sink_.image) sink_.image(reply.image, *image);
  return {};
}

Result<void> ClientSession::take_view(const wire::ViewReplyT& reply, const Bytes& bytes,
                                      std::int64_t came_us) {
  const std::size_t size = bytes.size() + kReplyBytes;
  if (scene_.complete()) {
    scheduler_.note_other(size, came_us);
  } else {
    scheduler_.note_opening(size, came_us);
  }
  const Result<std::shared_ptr<const ViewTile>> view = views_.take(reply, bytes);
  if (!view) return view.error();
  if (*view && sink_.view) sink_.view(**view);
  return {};
}

Result<void> ClientSession::take_reference(const wire::ReferenceReplyT& reply, const Bytes& bytes) {
  const std::size_t pixels = std::size_t{reply.width} * reply.height;
  const bool asked = std::exchange(reference_asked_px_, 0) == pixels && pixels > 0;
  if (!asked || reply.raw_bytes != pixels * 12) {
    return make_error(ErrorId::kWireValue, "reference frame that was not asked for");
  }
  Result<Bytes> raw = decompress_block(bytes.data(), bytes.size(), reply.raw_bytes);
  if (!raw) return raw.error();
  ReferenceFrame frame{reply.width,
                       reply.height,
                       {},
                       std::vector<float>(pixels),
                       std::vector<std::uint32_t>(pixels)};
  frame.rgba.assign(raw->begin(), raw->begin() + static_cast<std::ptrdiff_t>(pixels * 4));
  std::memcpy(frame.depth.data(), raw->data() + pixels * 4, pixels * 4);
  std::memcpy(frame.ids.data(), raw->data() + pixels * 8, pixels * 4);
  reference_ = std::move(frame);
  return {};
}

void ClientSession::ask_reference(const Camera& camera, std::uint32_t supersample) {
  wire::ReferenceRequestT request;
  request.request_id = 0;
  request.lighting_id = lighting_id_;
  request.eye = std::make_unique<wire::Vec3d>(to_wire(camera.pose.eye));
  request.rotation = std::make_unique<wire::Quat>(to_wire(camera.pose.rotation));
  request.fov_y = camera.fov_y;
  request.width = camera.width;
  request.height = camera.height;
  request.supersample = supersample;
  request.time_s = time_s_;
  reference_refused_ = false;
  reference_asked_px_ = std::size_t{camera.width} * camera.height;
  link_.send(encode_message(std::move(request)));
}

}  // namespace mirage
