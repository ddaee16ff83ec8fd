#include "protocol/wire/view_codec.h"

#include <algorithm>
#include <cmath>

#include "protocol/codec/color_codec.h"
#include "protocol/codec/tile_codec.h"
#include "protocol/wire/conversions.h"

namespace mirage {
namespace {

// Factor on the tangents of half the field of view: the margin has content ready when the head
// turns.
constexpr double kGuard = 1.15;
// WebP quality. A view is shown for a second at most, at about its own size; 75 takes half the
// bytes of the 90 that tiles have.
constexpr float kColorQuality = 75;
// Steps per radian, and per metre, to which poses are rounded.
constexpr double kStepsPerUnit = 1024;
constexpr std::size_t kPlaneBytes = 3;  // per cell: a depth code and an owner

// Adding 0.0 turns -0 into 0.
double in_steps(double v) { return std::round(v * kStepsPerUnit) / kStepsPerUnit + 0.0; }

glm::quat in_steps(const glm::quat& q) {
  // Two quaternions give the same rotation; the one with w >= 0 is used.
  const float sign = q.w < 0 ? -1.0f : 1.0f;
  const auto step = [&](float v) { return static_cast<float>(in_steps(double{v * sign})); };
  return glm::normalize(glm::quat(step(q.w), step(q.x), step(q.y), step(q.z)));
}

std::size_t cells_of(const wire::ViewReplyT& reply) {
  return std::size_t{reply.width / kViewCellTexels} * (reply.height / kViewCellTexels);
}

std::uint32_t even_edge(double texels) {
  const auto edge = static_cast<std::uint32_t>(2 * std::floor((texels + 1e-6) / 2));
  return std::clamp(edge, limits::kMinViewEdge, limits::kMaxViewEdge);
}

}  // namespace

ViewPose view_pose(const wire::ViewRequestT& m) {
  ViewPose out;
  out.camera.pose = {from_wire(*m.eye), in_steps(glm::normalize(from_wire(*m.rotation)))};
  for (int axis = 0; axis < 3; ++axis) {
    out.camera.pose.eye[axis] = in_steps(out.camera.pose.eye[axis]);
  }
  out.camera.fov_y = m.fov_y;
  out.camera.width = m.width;
  out.camera.height = m.height;
  out.time_s = m.time_s;
  return out;
}

wire::ViewRequestT view_request(const Camera& camera, double time_s) {
  const Camera screen = camera.enclosing();
  wire::ViewRequestT m;
  const double tangent = std::tan(0.5 * screen.fov_y) * kGuard;
  const double widest = std::tan(0.5 * limits::kMaxFovDegrees / 57.29577951308232);
  m.fov_y = 2 * std::atan(std::min(tangent, widest));
  const double aspect = static_cast<double>(screen.width) / screen.height;
  const double height = std::sqrt(static_cast<double>(limits::kMaxViewTexels) / aspect);
  m.height = static_cast<std::uint16_t>(even_edge(height));
  m.width = static_cast<std::uint16_t>(
      std::min(even_edge(height * aspect),
               even_edge(static_cast<double>(limits::kMaxViewTexels) / m.height)));
  m.eye = std::make_unique<wire::Vec3d>(to_wire(screen.pose.eye));
  m.rotation = std::make_unique<wire::Quat>(to_wire(screen.pose.rotation));
  m.time_s = time_s;
  return m;
}

Camera screen_of(const Camera& view) {
  Camera screen = view;
  screen.fov_y = 2 * std::atan(std::tan(0.5 * view.fov_y) / kGuard);
  return screen;
}

wire::ViewRequestT home_view_request() {
  wire::ViewRequestT m = view_request(Camera{}, 0);
  m.home = true;
  return m;
}

bool is_home_view(const wire::ViewRequestT& request) {
  const wire::ViewRequestT home = home_view_request();
  return request.home && request.lighting_id == 0 && request.time_s == home.time_s &&
         request.fov_y == home.fov_y && request.width == home.width &&
         request.height == home.height;
}

EncodedView encode_view(const ViewTile& view) {
  EncodedView out;
  const Camera& c = view.camera;
  const ColorBytes colors = encode_webp_colors(view.rgba, c.width, c.height, kColorQuality);
  // Codes, then the low bytes of all owners, then the high ones: similar bytes compress better
  // together.
  Bytes planes(view.depth.begin(), view.depth.end());
  for (const int shift : {0, 8}) {
    for (const std::uint16_t owner : view.owners) {
      planes.push_back(static_cast<std::uint8_t>(owner >> shift));
    }
  }
  const Bytes packed = compress_block(planes.data(), planes.size());
  out.reply.eye = std::make_unique<wire::Vec3d>(to_wire(c.pose.eye));
  out.reply.rotation = std::make_unique<wire::Quat>(to_wire(c.pose.rotation));
  out.reply.fov_y = c.fov_y;
  out.reply.width = static_cast<std::uint16_t>(c.width);
  out.reply.height = static_cast<std::uint16_t>(c.height);
  out.reply.time_s = view.time_s;
  out.reply.near_m = view.near_m;
  out.reply.far_m = view.far_m;
  out.reply.color_bytes = static_cast<std::uint32_t>(colors.size());
  out.reply.instances = view.instances;
  out.payload = colors;
  out.payload.insert(out.payload.end(), packed.begin(), packed.end());
  return out;
}

Result<Bytes> view_planes(const wire::ViewReplyT& reply, const Bytes& payload) {
  if (reply.color_bytes > payload.size()) {
    return make_error(ErrorId::kWireValue, "view with parts that do not fit together");
  }
  Result<ColorBytes> out =
      decode_webp_colors(payload.data(), reply.color_bytes, reply.width, reply.height);
  if (!out) return out.error();
  const Result<Bytes> planes =
      decompress_block(payload.data() + reply.color_bytes, payload.size() - reply.color_bytes,
                       kPlaneBytes * cells_of(reply));
  if (!planes) return planes.error();
  out->insert(out->end(), planes->begin(), planes->end());
  return out;
}

Result<ViewTile> view_of_planes(const wire::ViewReplyT& reply, const Bytes& planes) {
  ViewTile out;
  out.camera.pose = {from_wire(*reply.eye), glm::normalize(from_wire(*reply.rotation))};
  out.camera.fov_y = reply.fov_y;
  out.camera.width = reply.width;
  out.camera.height = reply.height;
  out.time_s = reply.time_s;
  out.near_m = reply.near_m;
  out.far_m = reply.far_m;
  out.instances = reply.instances;
  const std::size_t color_bytes = std::size_t{reply.width} * reply.height * 4;
  const std::size_t cells = cells_of(reply);
  if (planes.size() != color_bytes + kPlaneBytes * cells ||
      !std::is_sorted(out.instances.begin(), out.instances.end())) {
    return make_error(ErrorId::kWireValue, "view with parts that do not fit together");
  }
  const auto depth = planes.begin() + static_cast<std::ptrdiff_t>(color_bytes);
  out.rgba.assign(planes.begin(), depth);
  out.depth.assign(depth, depth + static_cast<std::ptrdiff_t>(cells));
  out.owners.resize(cells);
  const std::uint8_t* low = planes.data() + color_bytes + cells;
  for (std::size_t i = 0; i < cells; ++i) {
    const auto owner = static_cast<std::uint16_t>(low[i] | (low[cells + i] << 8));
    if (owner != ViewTile::kNobody && owner > out.instances.size()) {
      return make_error(ErrorId::kWireValue, "view with an owner that is not listed");
    }
    out.owners[i] = owner;
  }
  return out;
}

Result<ViewTile> decode_view(const wire::ViewReplyT& reply, const Bytes& payload) {
  const Result<Bytes> planes = view_planes(reply, payload);
  if (!planes) return planes.error();
  return view_of_planes(reply, *planes);
}

}  // namespace mirage
