// T1 to T5: tiles of any size, the atlas when it is full, its neighbours, uploads.

#include <algorithm>
#include <map>
#include <set>

#include "client/draw/frame_target.h"
#include "client/hold/atlas_allocator.h"
#include "client/plan/tile_need.h"
#include "protocol/impostor/error_bound.h"
#include "protocol/wire/conversions.h"
#include "server/render/gpu_scene.h"
#include "tests/extreme/registry.h"
#include "tests/extreme/shapes.h"
#include "tests/extreme/studio.h"
#include "tests/gl/bench.h"
#include "tests/support/rig.h"

namespace mirage::extreme {
using namespace test;
namespace {

constexpr std::uint8_t kAllClasses = limits::kMaxSizeClass + 1;

// Asks the server's sessions for every possible size.
void ask_all_classes(Checks& checks) {
  Rig rig(rig_scene({1}), {});
  HostLink other(rig.host);
  wire::HelloT hello;
  hello.version_min = hello.version_max = limits::kProtocolVersion;
  hello.codecs = {static_cast<std::uint8_t>(TileCodec::kZstd)};
  other.send(encode_message(std::move(hello)));
  wire::RequestBatchT batch;
  batch.credit_bytes = std::uint64_t{1} << 40;
  for (std::uint32_t size = 0; size < 256; ++size) {
    batch.asks.emplace_back(size + 1, 0, 0, 1.0f, 0, 8, 0, 0, 9, 2, static_cast<std::uint8_t>(size),
                            kLitTile, 0);
  }
  other.send(encode_message(std::move(batch)));
  int tiles = 0, refused = 0, wrong = 0;
  for (const Message& m : other.receive()) {
    if (const auto* tile = m.body.AsTileReply()) {
      ++tiles;
      wrong += tile->edge == tile_edge(static_cast<int>(tile->request_id) - 1) ? 0 : 1;
    }
    if (const auto* no = m.body.AsRefused()) {
      ++refused;
      const bool clear = no->reason == wire::RefusalReason::BadKey &&
                         no->request_id > std::uint32_t{limits::kMaxSizeClass} + 1;
      wrong += clear ? 0 : 1;
    }
  }
  checks.equal("size classes with a tile", tiles, kAllClasses);
  checks.equal("refused", refused, 256 - kAllClasses);
  checks.equal("wrong answers", wrong, 0);
}

// T1: edges 1 to 16384 in a reply's header; sizes 16 to 2048 rendered, sent, held and drawn.
Outcome any_size(const Conditions&) {
  Checks checks;
  int wrong = 0;
  for (std::uint32_t edge = 1; edge <= 16384; ++edge) {
    wire::TileReplyT reply;
    reply.edge = static_cast<std::uint16_t>(edge);
    reply.crop_w = reply.crop_h = reply.edge;
    reply.channels = kLitTile;
    const Result<Tile> tile = tile_from_fields(reply);
    const bool allowed = edge >= 4 && edge <= limits::kMaxTileEdge;
    wrong += tile.ok() == allowed && (tile || tile.error().id == ErrorId::kWireValue) ? 0 : 1;
    // One texel more than the window is never allowed.
    ++reply.crop_w;
    wrong += tile_from_fields(reply) ? 1 : 0;
  }
  checks.equal("headers taken or refused wrongly", wrong, 0);
  ask_all_classes(checks);
  StudioOptions options;
  options.samples = 1;
  Result<std::unique_ptr<Studio>> made =
      Studio::create("builtin:knot?tubular=48&radial=12", options);
  if (!made) {
    checks.failed(made.error().line());
    return checks.outcome();
  }
  Studio& studio = **made;
  const Camera camera = studio.camera(0, {1, 0.3, 1}, 6, 64);
  int empty = 0, drawn = 0, left_out = 0, not_finite_count = 0;
  for (int size = 0; size <= limits::kMaxSizeClass; ++size) {
    TileKey key = studio.key_for(camera, 0, kLitTile);
    key.size_class = static_cast<std::uint8_t>(size);
    const MadeTile tile = studio.make_tile(key, 0);
    empty += tile.tile.crop.area() > 0 && !tile.tile.rgba.empty() ? 0 : 1;
    not_finite_count += not_finite(tile.header);
    const TileRecordPtr record = studio.hold(tile, 0);
    const bool fits = tile.tile.crop.w + 2 <= 1024 && tile.tile.crop.h + 2 <= 1024;
    left_out += record ? 0 : 1;
    empty += fits == (record != nullptr) ? 0 : 1;
    if (!record) continue;
    DrawList list;
    list.impostors.push_back({0, record, DrawMethod::kQuad, 0, 1, 1});
    const std::size_t seen = covered(studio.draw(camera, list));
    drawn += seen > 400 && seen < 64 * 64 ? 1 : 0;
  }
  checks.equal("tiles without content, or held wrongly", empty, 0);
  checks.equal("header floats that are not finite", not_finite_count, 0);
  checks.equal("tiles drawn or too large for the atlas", drawn + left_out, kAllClasses);
  checks.at_least("drawn", drawn, 12);
  checks.equal("GL errors", static_cast<double>(glGetError()), 0);
  return checks.outcome();
}

// T2: an atlas far too small for everything in view.
Outcome full_atlas(const Conditions&) {
  RigScene scene;
  scene.objects = 24;
  RigOptions options;
  options.client.atlas_edge = 256;
  options.client.atlas_layers = 1;
  options.net.rtt_ms = 40;
  options.net.server_ms = 2;
  Rig rig(rig_scene(scene), options);
  rig.camera.width = 1280;
  rig.camera.height = 720;
  int lost = 0, wanted_texels = 0;
  std::uint64_t late_asks = 0;
  std::size_t without = 0, visible = 0, coarse = 0;
  for (const double turn : {0.0, 0.5, 0.25}) {
    const Pose pose = eye_at({14 * std::sin(turn), 2, 14 * std::cos(turn) - 4}, {0, 0, -8});
    std::set<std::uint32_t> before;
    std::uint64_t asked = 0;
    for (int i = 0; i < 60 * 20; ++i) {
      if (i == 60 * 10) asked = rig.session.tiles().asked;
      const DrawList list = rig.frame(pose);
      std::set<std::uint32_t> now;
      for (const DrawnImpostor& d : list.impostors) now.insert(d.instance);
      for (const std::uint32_t instance : before) lost += now.count(instance) ? 0 : 1;
      before = std::move(now);
      if (i + 1 < 60 * 20) continue;
      visible += list.visible;
      without += list.placeholders.size();
      for (const DrawnImpostor& d : list.impostors) {
        const InstanceView& view_of = rig.session.scene().instances[d.instance];
        const ViewGeometry view =
            view_geometry(rig.camera, view_of, rig.session.scene().objects[view_of.object]);
        const std::uint32_t edge = tile_edge(need_for_view(view, ViewPlan{}).size_class);
        wanted_texels += static_cast<int>(edge * edge);
        coarse += d.tile->capture.edge < edge ? 1 : 0;
      }
    }
    late_asks += rig.session.tiles().asked - asked;
  }
  Checks checks;
  checks.at_least("texels wanted, of those there are", wanted_texels / (3 * 65536.0), 2);
  checks.equal("in view and evicted", lost, 0);
  checks.equal("asks after the first 10 s of standing still", static_cast<double>(late_asks), 0);
  checks.equal("in view without an image", static_cast<double>(without), 0);
  checks.at_least("coarser than wanted", static_cast<double>(coarse), 10);
  checks.at_least("in view", static_cast<double>(visible), 60);
  return checks.outcome();
}

// T3: owners of each texel of an atlas, over a million allocations and releases.
Outcome allocations(const Conditions& conditions) {
  constexpr int kEdge = 512, kLayers = 2;
  AtlasAllocator atlas(kEdge, kLayers);
  std::vector<int> owner(std::size_t{kLayers} * kEdge * kEdge, 0);
  Random random(conditions.seed);
  struct Live {
    AtlasSlot slot;
    int id;
  };
  std::vector<Live> live;
  int overlaps = 0, outside = 0, full = 0;
  const auto claim = [&](const AtlasSlot& s, int from, int to) {
    for (int y = s.y; y < s.y + s.h; ++y) {
      for (int x = s.x; x < s.x + s.w; ++x) {
        int& texel = owner[static_cast<std::size_t>((s.layer * kEdge + y) * kEdge + x)];
        overlaps += texel == from ? 0 : 1;
        texel = to;
      }
    }
  };
  for (int i = 1; i <= 1'000'000; ++i) {
    const bool grow = random.uniform(0, 1) < ((i / 4000) % 2 == 0 ? 0.8 : 0.2);
    if (grow || live.empty()) {
      const double most = random.uniform(0, 1) < 0.01 ? kEdge + 1 : 48;
      const auto slot = atlas.allocate(static_cast<int>(random.uniform(1, most)),
                                       static_cast<int>(random.uniform(1, most)));
      if (!slot) {
        ++full;
        continue;
      }
      if (slot->layer >= kLayers || slot->x < 0 || slot->y < 0 || slot->x + slot->w > kEdge ||
          slot->y + slot->h > kEdge) {
        ++outside;
        continue;
      }
      claim(*slot, 0, i);
      live.push_back({*slot, i});
    } else {
      const auto k = static_cast<std::size_t>(random.uniform(0, static_cast<double>(live.size())));
      claim(live[k].slot, live[k].id, 0);
      atlas.release(live[k].slot);
      live[k] = live.back();
      live.pop_back();
    }
  }
  for (const Live& l : live) atlas.release(l.slot);
  Checks checks;
  checks.equal("texels of two owners", overlaps, 0);
  checks.equal("slots outside", outside, 0);
  checks.at_least("times full", full, 1000);
  checks.equal("texels still taken at the end", static_cast<double>(atlas.used_texels()), 0);
  return checks.outcome();
}

bool magenta(const std::uint8_t* texel) {
  return texel[3] > 0 && std::min(texel[0], texel[2]) > texel[1] + 24;
}

std::size_t magenta_texels(const Pixels& rgba) {
  std::size_t n = 0;
  for (std::size_t i = 0; i < rgba.size(); i += 4) n += magenta(&rgba[i]) ? 1 : 0;
  return n;
}

// T4: the tiles around it in the atlas are solid magenta, up to their last texel.
Outcome neighbours(const Conditions&) {
  Checks checks;
  Result<std::unique_ptr<Studio>> made = Studio::create("builtin:knot?tubular=48&radial=12");
  if (!made) {
    checks.failed(made.error().line());
    return checks.outcome();
  }
  Studio& studio = **made;
  std::size_t bled = 0, control = 0, seen = 0;
  for (const int size : {24, 64, 150}) {
    const Camera near = studio.camera(0, {1, 0.4, 1}, 6, size);
    const MadeTile own = studio.make_tile(studio.key_for(near, 0, kLitTile), 0);
    MadeTile loud = own;
    for (std::size_t i = 0; i < loud.tile.rgba.size(); i += 4) {
      loud.tile.rgba[i] = loud.tile.rgba[i + 2] = loud.tile.rgba[i + 3] = 255;
      loud.tile.rgba[i + 1] = 0;
    }
    std::fill(loud.tile.depth.begin(), loud.tile.depth.end(), std::uint8_t{200});
    TileRecordPtr record, other;
    for (int i = 0; i < 40; ++i) {  // some before it, the others after it, in rows
      MadeTile next = loud;
      // Each has another direction, because the same tile would not be uploaded again.
      next.capture.basis = capture_basis(*view_cell_from_direction({1, 0.1 * i, 0.3}, 12));
      other = studio.hold(next, 0);
      if (i != 17) continue;
      record = studio.hold(own, 0);
      studio.keep(record);  // whatever arrives later
    }
    for (const DrawMethod method : {DrawMethod::kQuad, DrawMethod::kCuboid, DrawMethod::kHull,
                                    DrawMethod::kWarp, DrawMethod::kDepth}) {
      for (const double zoom : {0.3, 1.0, 1.7}) {  // minified to magnified
        for (const double aside : {0.0, 0.15}) {
          Camera camera = studio.camera(0, {1 + aside, 0.4, 1}, 6, static_cast<int>(size * zoom));
          DrawList list;
          list.impostors.push_back({0, record, method, 0, 1, 1});
          const Pixels drawn = studio.draw(camera, list);
          bled += magenta_texels(drawn);
          seen += covered(drawn);
          list.impostors[0].tile = other;
          if (method == DrawMethod::kQuad) control += magenta_texels(studio.draw(camera, list));
        }
      }
    }
  }
  checks.equal("magenta texels", static_cast<double>(bled), 0);
  checks.at_least("drawn texels", static_cast<double>(seen), 10'000);
  checks.at_least("magenta where the neighbour is drawn", static_cast<double>(control), 1'000);
  return checks.outcome();
}

/// Delivers every arriving tile to the session once more, under each id by turns.
class Echo final : public Link {
 public:
  explicit Echo(Link& inner) : inner_(inner) {}
  void send(Bytes bytes) override { inner_.send(std::move(bytes)); }
  std::vector<Message> receive() override {
    std::vector<Message> out;
    for (Message& m : inner_.receive()) {
      if (m.body.AsTileReply()) {
        const Bytes bytes = encode_body(m.body, m.payload);
        Result<Message> again = decode_message(bytes.data(), bytes.size());
        out.push_back(std::move(m));
        if (again) out.push_back(again.take());
      } else {
        out.push_back(std::move(m));
      }
    }
    return out;
  }
  bool connected() const override { return inner_.connected(); }
  std::uint32_t generation() const override { return inner_.generation(); }
  LinkTraffic traffic() const override { return inner_.traffic(); }

 private:
  Link& inner_;
};

// T5: the same tile twice: for two instances of one object, sent twice, and already held.
Outcome texels_twice(const Conditions&) {
  Checks checks;
  RigScene scene;
  scene.objects = 6;
  const auto apart = rig_scene(scene);
  auto shared = std::make_shared<PreparedScene>(*apart);
  for (Instance& i : shared->scene.instances) {
    i.object = 0;  // six of one object at one place: the same key for all
    i.world_from_object = shared->scene.instances[0].world_from_object;
  }
  RigOptions options;
  options.wrap = [](Link& inner) { return std::make_unique<Echo>(inner); };
  Rig rig(shared, options);
  std::map<std::vector<double>, int> uploads;
  rig.on_tile = [&](const TileRecord& t, const AtlasPlanes&) {
    const glm::dvec3& f = t.capture.basis.forward;
    ++uploads[{f.x, f.y, f.z, t.capture.distance, double(t.capture.edge), double(t.relit)}];
  };
  const glm::dvec3 there = shared->scene.instances[0].world_from_object.position;
  const Pose pose = eye_at(there + glm::dvec3(3, 0, 9), there);
  const DrawList list = rig.run(3, [&](double) { return pose; });
  int again = 0;
  for (const auto& [key, count] : uploads) again += count - 1;
  const std::uint64_t uploaded = rig.uploaded_bytes, asked = rig.session.tiles().asked;
  // Away and back: the tiles are held, so nothing is asked for.
  rig.run(
      1, [&](double) { return eye_at(there + glm::dvec3(3, 0, 9), there + glm::dvec3(3, 0, 20)); });
  rig.run(3, [&](double) { return pose; });
  checks.equal("uploads of a tile that is there", again, 0);
  checks.equal("bytes uploaded for a view held already",
               static_cast<double>(rig.uploaded_bytes - uploaded), 0);
  checks.equal("asks for it", static_cast<double>(rig.session.tiles().asked - asked), 0);
  checks.equal("instances drawn", static_cast<double>(list.impostors.size()), 6);
  checks.at_least("tiles received", static_cast<double>(rig.session.tiles().received), 12);
  return checks.outcome();
}

}  // namespace

std::vector<Case> texture_cases() {
  return {
      {"T1", "tiles of 1 to 16384 texels", "works, or a clear refusal", any_size},
      {"T2", "atlas full of visible tiles", "coarser, never evicts what is visible, never loops",
       full_atlas},
      {"T3", "1e6 allocations and releases", "no overlap", allocations},
      {"T4", "solid magenta neighbours in the atlas", "0 magenta texels", neighbours},
      {"T5", "the same tile twice", "0 bytes uploaded for the second", texels_twice},
  };
}

}  // namespace mirage::extreme
