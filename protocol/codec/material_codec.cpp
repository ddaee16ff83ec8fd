#include "protocol/codec/material_codec.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace mirage {
namespace {

void put_texture(ByteWriter& w, const TextureRef& t) {
  w.put(t.image);
  w.put(t.uv_set);
  w.put(static_cast<std::uint8_t>(t.wrap_s));
  w.put(static_cast<std::uint8_t>(t.wrap_t));
  w.put(static_cast<std::uint8_t>(t.nearest));
  for (const float v : {t.offset.x, t.offset.y, t.scale.x, t.scale.y, t.rotation}) w.put(v);
}

bool get_texture(ByteReader& r, TextureRef& t, std::size_t images) {
  t.image = r.get<std::int32_t>();
  t.uv_set = r.get<std::uint8_t>();
  const auto wrap_s = r.get<std::uint8_t>(), wrap_t = r.get<std::uint8_t>();
  const auto nearest = r.get<std::uint8_t>();
  bool finite = true;
  for (float* v : {&t.offset.x, &t.offset.y, &t.scale.x, &t.scale.y, &t.rotation}) {
    *v = r.get<float>();
    finite = finite && std::isfinite(*v);
  }
  if (t.image < -1 || t.image >= static_cast<std::int64_t>(images)) return false;
  if (t.uv_set > 1 || wrap_s > 2 || wrap_t > 2 || nearest > 1) return false;
  t.wrap_s = static_cast<Wrap>(wrap_s);
  t.wrap_t = static_cast<Wrap>(wrap_t);
  t.nearest = nearest != 0;
  return finite;
}

// Bits for the optional parts that follow a material, in this order. Anisotropy has its own bit, so
// lobes without it keep their earlier layout.
constexpr std::uint8_t kHasLobes = 1, kHasAnisotropy = 2;
// number of lobe maps before anisotropy's
constexpr std::size_t kFirstMaps = static_cast<std::size_t>(LobeMap::kAnisotropy);
constexpr std::size_t kLobeBytes = 15 * 4 + kFirstMaps * kTextureBytes;
constexpr std::size_t kAnisotropyBytes = 2 * 4 + kTextureBytes;

template <typename LobesT, typename Visit>
void each_factor(LobesT& l, const Visit& visit) {
  visit(l.specular);
  for (int i = 0; i < 3; ++i) visit(l.specular_color[i]);
  visit(l.ior);
  visit(l.clearcoat);
  visit(l.clearcoat_roughness);
  for (int i = 0; i < 3; ++i) visit(l.sheen_color[i]);
  visit(l.sheen_roughness);
  visit(l.transmission);
  for (int i = 0; i < 3; ++i) visit(l.volume_tint[i]);
}

bool has_lobes(const Lobes& lobes) {
  std::vector<float> set, plain;
  each_factor(lobes, [&](float v) { set.push_back(v); });
  const Lobes none;
  each_factor(none, [&](float v) { plain.push_back(v); });
  return set != plain || std::any_of(lobes.maps.begin(), lobes.maps.begin() + kFirstMaps,
                                     [](const TextureRef& map) { return map.present(); });
}

bool has_anisotropy(const Lobes& lobes) {
  return lobes.anisotropy != 0 || lobes.anisotropy_rotation != 0 ||
         lobes.map(LobeMap::kAnisotropy).present();
}

bool get_lobes(ByteReader& r, Lobes& lobes, std::size_t images) {
  bool ok = true;
  each_factor(lobes, [&](float& v) {
    v = r.get<float>();
    ok = ok && std::isfinite(v) && v >= 0;
  });
  for (std::size_t i = 0; i < kFirstMaps; ++i) ok = get_texture(r, lobes.maps[i], images) && ok;
  return ok && lobes.ior >= 1;
}

bool get_anisotropy(ByteReader& r, Lobes& lobes, std::size_t images) {
  lobes.anisotropy = r.get<float>();
  lobes.anisotropy_rotation = r.get<float>();
  // Each is false for NaN.
  const bool ok = lobes.anisotropy >= 0 && lobes.anisotropy <= 1 &&
                  lobes.anisotropy_rotation >= 0 && lobes.anisotropy_rotation <= kMaxGrainRotation;
  return get_texture(r, lobes.map(LobeMap::kAnisotropy), images) && ok;
}

}  // namespace

void put_material(ByteWriter& w, const Material& m) {
  for (int i = 0; i < 4; ++i) w.put(m.base_color[i]);
  for (int i = 0; i < 3; ++i) w.put(m.emissive[i]);
  for (const float v :
       {m.metallic, m.roughness, m.normal_scale, m.occlusion_strength, m.alpha_cutoff}) {
    w.put(v);
  }
  w.put(static_cast<std::uint8_t>(m.alpha_mode));
  w.put(static_cast<std::uint8_t>(m.double_sided));
  w.put(static_cast<std::uint8_t>(m.unlit));
  const bool lobes = has_lobes(m.lobes), anisotropy = has_anisotropy(m.lobes);
  w.put(static_cast<std::uint8_t>((lobes ? kHasLobes : 0) | (anisotropy ? kHasAnisotropy : 0)));
  for (const TextureRef* t :
       {&m.base_color_map, &m.metal_rough_map, &m.normal_map, &m.occlusion_map, &m.emissive_map}) {
    put_texture(w, *t);
  }
  if (lobes) {
    each_factor(m.lobes, [&](float v) { w.put(v); });
    for (std::size_t i = 0; i < kFirstMaps; ++i) put_texture(w, m.lobes.maps[i]);
  }
  if (anisotropy) {
    w.put(m.lobes.anisotropy);
    w.put(m.lobes.anisotropy_rotation);
    put_texture(w, m.lobes.map(LobeMap::kAnisotropy));
  }
}

bool get_material(ByteReader& r, Material& m, std::size_t images) {
  bool ok = true;
  const auto number = [&](float& v) {
    v = r.get<float>();
    ok = ok && std::isfinite(v);
  };
  for (int i = 0; i < 4; ++i) number(m.base_color[i]);
  for (int i = 0; i < 3; ++i) number(m.emissive[i]);
  for (float* v :
       {&m.metallic, &m.roughness, &m.normal_scale, &m.occlusion_strength, &m.alpha_cutoff}) {
    number(*v);
  }
  const auto alpha_mode = r.get<std::uint8_t>(), double_sided = r.get<std::uint8_t>();
  const auto unlit = r.get<std::uint8_t>(), more = r.get<std::uint8_t>();
  if (alpha_mode > 2 || double_sided > 1 || unlit > 1) return false;
  if (more > (kHasLobes | kHasAnisotropy)) return false;
  m.alpha_mode = static_cast<AlphaMode>(alpha_mode);
  m.double_sided = double_sided != 0;
  m.unlit = unlit != 0;
  for (TextureRef* t :
       {&m.base_color_map, &m.metal_rough_map, &m.normal_map, &m.occlusion_map, &m.emissive_map}) {
    ok = get_texture(r, *t, images) && ok;
  }
  if (more & kHasLobes) ok = r.has(1, kLobeBytes) && get_lobes(r, m.lobes, images) && ok;
  if (more & kHasAnisotropy) {
    ok = r.has(1, kAnisotropyBytes) && get_anisotropy(r, m.lobes, images) && ok;
  }
  return ok;
}

}  // namespace mirage
