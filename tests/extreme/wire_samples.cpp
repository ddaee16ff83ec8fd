#include "tests/extreme/wire_samples.h"

#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include "protocol/codec/image_codec.h"
#include "protocol/codec/tile_codec.h"
#include "protocol/model/scene_types.h"
#include "protocol/wire/conversions.h"
#include "tests/support/protocol_samples.h"

namespace mirage::extreme {
namespace {

constexpr std::size_t kImages = 4;  // images that the corpus's geometry may refer to

/// Counts floats that are not finite.
class FloatCheck {
 public:
  void add(double v) { bad += std::isfinite(v) ? 0 : 1; }
  void add(const wire::Vec3f& v) { add(glm::dvec3(v.x(), v.y(), v.z())); }
  void add(const wire::Vec3d& v) { add(glm::dvec3(v.x(), v.y(), v.z())); }
  void add(const wire::Quat& q) { add(glm::dvec3(q.x(), q.y(), q.z())), add(double{q.w()}); }
  void add(const glm::dvec3& v) { add(v.x), add(v.y), add(v.z); }
  void add(const std::vector<float>& list) {
    for (const float v : list) add(double{v});
  }
  template <typename V>
  void add(const std::unique_ptr<V>& v) {
    if (v) add(*v);
  }
  void add(const Lighting& lighting) {
    add(glm::dvec3(lighting.ambient));
    for (const Light& l : lighting.lights) {
      add(l.position), add(glm::dvec3(l.color)), add(glm::dvec3(l.direction));
      add(double{l.range}), add(double{l.cos_inner}), add(double{l.cos_outer});
    }
    const glm::quat& q = lighting.probe.rotation;
    add(glm::dvec3(q.x, q.y, q.z)), add(double{q.w}), add(double{lighting.probe.strength});
  }
  void add(const wire::ObjectInfoT& o) {
    add(o.center), add(o.box_min), add(o.box_max), add(o.mean_color), add(double{o.radius});
    for (const wire::LodInfo& lod : o.lods) {
      add(double{lod.error()}), add(double{lod.spread()}), add(double{lod.shading()});
    }
    for (const wire::Vec3f& v : o.hull_vertices) add(v);
    add(o.hull_parallax), add(o.speed), add(o.jump);
    for (const wire::Vec3f& v : o.track) add(v);
    add(double{o.clip_s}), add(double{o.wrap_jump}), add(double{o.track_clip_s});
  }
  int bad = 0;
};

bool use_lighting(const wire::LightingT& lighting, FloatCheck& check) {
  const Result<Lighting> taken = from_wire(lighting);
  if (taken) check.add(*taken);
  return taken.ok();
}

bool use_tile(const wire::TileReplyT& m, const Bytes& payload) {
  Result<Tile> tile = tile_from_fields(m);
  return tile &&
         decode_tile_planes(payload.data(), payload.size(), static_cast<TileCodec>(m.codec), *tile)
             .ok();
}

// Treats the message as its receiver does, up to where it would act on it.
bool accepts_message(const Bytes& bytes, int& not_finite) {
  const Result<Message> message = decode_message(bytes.data(), bytes.size());
  if (!message) return false;
  const wire::BodyUnion& body = message->body;
  FloatCheck check;
  bool taken = true;
  if (const auto* m = body.AsWelcome()) {
    check.add(m->sky_zenith), check.add(m->sky_horizon), check.add(m->sky_nadir);
    check.add(m->home_eye), check.add(m->home_target), check.add(m->walk_radius_m);
    check.add(m->walk_speed_mps), check.add(m->walk_eye_m), check.add(double{m->fog_density});
    check.add(m->bounds_center), check.add(m->bounds_radius);
    taken = use_lighting(*m->lighting, check);
  }
  if (const auto* m = body.AsSetLighting()) taken = use_lighting(*m->lighting, check);
  if (const auto* m = body.AsObjectPage()) {
    for (const auto& o : m->objects) check.add(*o);
  }
  if (const auto* m = body.AsInstancePage()) {
    for (const wire::InstanceRecord& i : m->instances) {
      check.add(i.position()), check.add(i.rotation()), check.add(double{i.scale()});
      check.add(double{i.clip_offset_s()});
    }
    for (const wire::GroupRecord& g : m->groups) check.add(g.center()), check.add(g.half());
  }
  if (const auto* m = body.AsOpenRequest()) {
    check.add(m->eye), check.add(m->forward), check.add(m->focal_px), check.add(m->tau_px);
    check.add(m->speed_mps), check.add(m->margin);
  }
  if (const auto* m = body.AsLightProbePage()) check.add(m->irradiance);
  if (const auto* m = body.AsImagePage()) {
    for (const wire::ImageInfo& i : m->images) check.add(double{i.alpha_cutoff()});
  }
  if (const auto* m = body.AsRequestBatch()) {
    for (const wire::Ask& a : m->asks) check.add(double{a.error_px()});
  }
  if (const auto* m = body.AsReferenceRequest()) {
    check.add(m->eye), check.add(m->rotation), check.add(m->fov_y), check.add(m->time_s);
  }
  if (const auto* m = body.AsTileReply()) {
    taken = use_tile(*m, message->payload);
    for (const float v : {m->plane_depth, m->depth_min, m->depth_max, m->dz_quad, m->dz_cuboid,
                          m->dz_hull, m->depth_gap, m->dz_behind, m->lod_error, m->color_rms}) {
      check.add(double{v});
    }
  }
  if (taken) not_finite += check.bad;
  return taken;
}

void add_reference(FloatCheck& check, const TextureRef& t) {
  for (const float v : {t.offset.x, t.offset.y, t.scale.x, t.scale.y, t.rotation}) {
    check.add(double{v});
  }
}

bool accepts_model(const Bytes& bytes, int& not_finite) {
  const Result<ObjectModel> model = decode_model(bytes.data(), bytes.size(), kImages);
  if (!model) return false;
  FloatCheck check;
  for (const Vertex& v : model->mesh.vertices) {
    check.add(glm::dvec3(v.position)), check.add(glm::dvec3(v.normal));
    check.add(glm::dvec3(v.tangent)), check.add(double{v.tangent.w});
    check.add(glm::dvec3(v.uv0, v.uv1.x)), check.add(double{v.uv1.y});
  }
  for (const Material& m : model->materials) {
    check.add(glm::dvec3(m.base_color)), check.add(double{m.base_color.w});
    check.add(glm::dvec3(m.emissive));
    check.add({m.metallic, m.roughness, m.normal_scale, m.occlusion_strength, m.alpha_cutoff});
    check.add({m.lobes.anisotropy, m.lobes.anisotropy_rotation});
    m.each_map([&](const TextureRef& t) { add_reference(check, t); });
  }
  if (model->animation) {
    // Poses as they are drawn, at both ends of the clip and within it.
    std::vector<Vertex> posed;
    for (const double t : {0.0, 0.37, 1.0}) {
      pose_vertices(model->mesh.vertices, *model->animation, t * model->animation->clip_s, posed);
      for (const Vertex& v : posed) check.add(glm::dvec3(v.position));
    }
  }
  not_finite += check.bad;
  return true;
}

// The fuzzers' form of a tile: 12 bytes of header fields, then the planes.
bool accepts_tile(const Bytes& bytes, int&) {
  if (bytes.size() < 12) return false;
  const auto word = [&](std::size_t at) {
    return static_cast<std::uint16_t>(bytes[at] | bytes[at + 1] << 8);
  };
  constexpr std::uint8_t kKinds[] = {kLitTile, kRelitTile, kShadowTile, kCasterTile};
  wire::TileReplyT reply;
  reply.edge = word(0);
  reply.crop_x = word(2);
  reply.crop_y = word(4);
  reply.crop_w = word(6);
  reply.crop_h = word(8);
  reply.codec = bytes[10];
  reply.channels = kKinds[std::min<int>(bytes[11], 3)];
  return use_tile(reply, Bytes(bytes.begin() + 12, bytes.end()));
}

bool accepts_image(const Bytes& bytes, int&) {
  return decode_image(bytes.data(), bytes.size(), {8, 4}, true).ok();
}

}  // namespace

std::vector<WireSample> wire_samples(const std::string& data) {
  std::vector<WireSample> out;
  for (const Bytes& bytes : test::sample_messages()) {
    const wire::Body type = decode_message(bytes.data(), bytes.size())->body.type;
    out.push_back({wire::EnumNameBody(type), bytes, accepts_message});
  }
  for (const char* name :
       {"raw_9x8", "zstd_9x8", "relit_raw", "relit_zstd", "shadow_raw", "caster_raw"}) {
    const std::string file = std::string("tile/") + name;
    out.push_back({file, corpus(data, file), accepts_tile});
  }
  for (const char* file : {"model/everything", "model/sheet", "model/animated"}) {
    out.push_back({file, corpus(data, file), accepts_model});
  }
  for (const char* file : {"image/lossless_8x4", "image/lossy_8x4"}) {
    out.push_back({file, corpus(data, file), accepts_image});
  }
  return out;
}

Bytes corpus(const std::string& data, const std::string& name) {
  std::ifstream in(data + "/" + name, std::ios::binary);
  if (!in) {
    throw std::runtime_error("'" + data + "/" + name +
                             "' is missing; --data names the folder of the fuzzers' corpus");
  }
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::uint64_t hash_of(const Bytes& bytes) {
  std::uint64_t hash = 0xcbf29ce484222325ull;
  for (const std::uint8_t b : bytes) hash = (hash ^ b) * 0x100000001b3ull;
  return hash;
}

}  // namespace mirage::extreme
