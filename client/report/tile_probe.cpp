#include "client/report/tile_probe.h"

#include <algorithm>

#include "client/frame/draw_list.h"
#include "client/host/client_host.h"
#include "client/plan/eight_views.h"
#include "client/screen/viewer_defaults.h"
#include "protocol/base/limits.h"
#include "protocol/wire/conversions.h"
#include "protocol/wire/unpack.h"

namespace mirage {
namespace {

constexpr int kConnectMs = 10'000, kReplyMs = 60'000;
constexpr int kLayers = 24;
constexpr std::uint32_t kLightingId = 1;
constexpr std::uint64_t kCreditAhead = 256u << 20;

}  // namespace

TileProbe::TileProbe(const ServerUrl& url, FrameRenderer& renderer)
    : link_(url), renderer_(renderer), cache_(kAtlasEdge, kLayers) {}

Result<std::unique_ptr<TileProbe>> TileProbe::open(const std::string& url, const Lighting& lighting,
                                                   FrameRenderer& renderer) {
  Result<ServerUrl> address = parse_url(url);
  if (!address) return address.error();
  std::unique_ptr<TileProbe> probe(new TileProbe(*address, renderer));
  probe->lighting_ = lighting;
  if (Result<void> met = probe->meet(); !met) return met.error();
  return probe;
}

Result<void> TileProbe::meet() {
  if (!link_.wait_connected(kConnectMs)) {
    return make_error(ErrorId::kNetworkConnect, "no server answers: " + link_.last_problem());
  }
  wire::HelloT hello;
  hello.version_min = hello.version_max = limits::kProtocolVersion;
  hello.name = "mirage-report fidelity";
  hello.codecs = {static_cast<std::uint8_t>(TileCodec::kRaw),
                  static_cast<std::uint8_t>(TileCodec::kZstd)};
  link_.send(encode_message(std::move(hello)));
  const SteadyClock patience;
  while (!scene_.described()) {
    if (!link_.connected() || patience.now_us() > kReplyMs * 1000ll) {
      return make_error(ErrorId::kNetworkTimeout, "the server did not describe its scene");
    }
    link_.wait_message(100);
    for (const Message& m : link_.receive()) {
      Result<void> taken;
      if (m.body.AsWelcome()) taken = scene_.accept(*m.body.AsWelcome());
      if (m.body.AsImagePage()) taken = scene_.accept(*m.body.AsImagePage());
      if (m.body.AsObjectPage()) taken = scene_.accept(*m.body.AsObjectPage());
      if (m.body.AsInstancePage()) taken = scene_.accept(*m.body.AsInstancePage());
      if (!taken) return taken;
    }
  }
  wire::SetLightingT light;
  light.id = kLightingId;
  light.lighting = to_wire(lighting_);
  link_.send(encode_message(std::move(light)));
  return renderer_.reset(scene_);
}

Result<void> TileProbe::send_asks(const std::vector<TileNeed>& needs) {
  records_.assign(needs.size(), nullptr);
  answered_ = 0;
  cache_.reset(scene_, lighting_);
  wire::RequestBatchT batch;
  batch.lighting_id = kLightingId;
  batch.credit_bytes = received_bytes_ + kCreditAhead;
  for (std::size_t i = 0; i < needs.size(); ++i) {
    const TileNeed& n = needs[i];
    batch.asks.emplace_back(first_request_ + static_cast<std::uint32_t>(i),
                            scene_.instances[n.instance].id, scene_.object_id(n.instance), 1.0f, 0u,
                            n.distance.index, n.cell.x, n.cell.y, n.cell.level, n.distance.level,
                            n.size_class, n.channels, n.phase);
  }
  link_.send(encode_message(std::move(batch)));
  const SteadyClock patience;
  while (answered_ < needs.size()) {
    if (!link_.connected() || patience.now_us() > kReplyMs * 1000ll) {
      return make_error(ErrorId::kNetworkTimeout, "tiles did not come: " + link_.last_problem());
    }
    link_.wait_message(100);
    for (const Message& message : link_.receive()) {
      if (Result<void> taken = take(message, needs); !taken) return taken;
    }
  }
  first_request_ += static_cast<std::uint32_t>(needs.size());
  return {};
}

Result<void> TileProbe::take(const Message& message, const std::vector<TileNeed>& needs) {
  if (message.body.AsRefused()) {
    return make_error(ErrorId::kWireValue, "the server refused a tile of the fidelity protocol");
  }
  const wire::TileReplyT* reply = message.body.AsTileReply();
  if (!reply || reply->request_id < first_request_) return {};
  const std::size_t index = reply->request_id - first_request_;
  if (index >= needs.size()) return make_error(ErrorId::kWireValue, "a tile nobody asked for");
  ++answered_;
  received_bytes_ += message.payload_bytes;
  const TileNeed& need = needs[index];
  if (reply->edge != tile_edge(need.size_class) || reply->channels != need.channels) {
    return make_error(ErrorId::kWireValue, "a tile other than asked for");
  }
  Result<UnpackedTile> taken = read_unpacked_tile(message);
  if (!taken) return taken.error();
  if (on_tile) on_tile(taken->tile);
  const ObjectDescription& object = scene_.objects[scene_.instances[need.instance].object];
  const Capture capture(need.cell, need.distance, object.radius, reply->edge);
  records_[index] =
      cache_.insert(need.instance, scene_, capture, std::move(taken->tile), 1, 0, 0, need.phase);
  return records_[index] ? renderer_.upload(*records_[index], taken->planes) : Result<void>{};
}

Result<DrawList> TileProbe::draw_list(const std::vector<TileNeed>& needs, const Camera& camera,
                                      DrawMethod method) {
  if (Result<void> asked = send_asks(needs); !asked) return asked.error();
  DrawList list;
  for (std::size_t i = 0; i < needs.size(); ++i) {
    if (!records_[i]) continue;  // empty: nothing shows from there
    const glm::dvec3 center = scene_.instances[needs[i].instance].center;
    DrawnImpostor drawn;
    drawn.instance = needs[i].instance;
    drawn.tile = records_[i];
    drawn.method = method;
    drawn.distance = glm::length(camera.pose.eye - center);
    list.impostors.push_back(drawn);
  }
  std::stable_sort(list.impostors.begin(), list.impostors.end(),
                   [](const auto& a, const auto& b) { return a.distance > b.distance; });
  return list;
}

Result<DrawList> TileProbe::capture(const Camera& captured, const Camera& camera,
                                    DrawMethod method) {
  std::vector<TileNeed> needs;
  for (std::uint32_t i = 0; i < scene_.instances.size(); ++i) {
    const InstanceView& instance = scene_.instances[i];
    const ObjectDescription& object = scene_.objects[instance.object];
    if (object.group || object.radius <= 0) continue;
    const ViewGeometry view = view_geometry(captured, instance, object);
    const double radii = glm::length(view.eye) / object.radius;
    if (radii < limits::kMinCaptureRadii) continue;
    TileNeed need = need_for_view(view, ViewPlan{});  // for its size
    need.instance = i;
    need.cell = *view_cell_from_direction(view.eye, limits::kMaxViewLevel);
    need.distance = *distance_bucket_from_radii(radii, limits::kMaxDistanceLevel);
    need.phase = object.motion.moving() ? Phase{1} : kStaticPhase;  // beginning of the clip
    if (method == DrawMethod::kDepth && layered(object.needs)) need.channels = kLayeredTile;
    needs.push_back(need);
  }
  return draw_list(needs, camera, method);
}

Result<DrawList> TileProbe::eight_views(const Camera& camera) {
  std::vector<TileNeed> needs;
  for (std::uint32_t i = 0; i < scene_.instances.size(); ++i) {
    const InstanceView& instance = scene_.instances[i];
    const ObjectDescription& object = scene_.objects[instance.object];
    if (object.group || object.radius <= 0) continue;
    const ViewGeometry view = view_geometry(camera, instance, object);
    TileNeed need = *eight_view_need(TileGroup{}, view, radius_px(view));
    need.size_class = need_for_view(view, ViewPlan{}).size_class;
    need.instance = i;
    need.phase = object.motion.moving() ? Phase{1} : kStaticPhase;
    needs.push_back(need);
  }
  return draw_list(needs, camera, DrawMethod::kQuad);
}

}  // namespace mirage
