#include "server/prepare/leave_out.h"

#include <xxhash.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <unordered_map>

#include "server/prepare/leave_out_covered.h"
#include "server/prepare/leave_out_lobes.h"

namespace mirage {
namespace {

class MaterialAnalysis {
 public:
  explicit MaterialAnalysis(Scene& scene) : scene_(scene), ranges_(scene.images.size()) {
    vertex_alpha_.assign(scene.materials.size(), true);
    for (const SceneObject& object : scene.objects) {
      const auto& vertices = object.mesh.vertices;
      const bool solid = std::all_of(vertices.begin(), vertices.end(),
                                     [](const Vertex& v) { return v.color.a == 65535; });
      for (const Primitive& p : object.mesh.primitives) {
        if (!solid) vertex_alpha_[p.material] = false;
      }
    }
  }

  std::vector<LeftOut> apply(std::size_t index) {
    Material& m = scene_.materials[index];
    out_.clear();
    if (m.unlit) drop_maps_of_unlit(m);
    leave_out_lobes(
        m, [this](const TextureRef& map) { return range(map); }, out_);
    check_alpha(m, vertex_alpha_[index]);
    if (m.base_color_map.present() && range(m.base_color_map).white() && alpha_is_one(m)) {
      drop(m.base_color_map, NeedRule::kSolidColor, "base colour map", "white in every texel");
    }
    check_surface_maps(m);
    check_emission(m);
    reset_unread_factors(m);
    return out_;
  }

 private:
  const TexelRange& range(const TextureRef& map) {
    std::optional<TexelRange>& known = ranges_[static_cast<std::size_t>(map.image)];
    if (!known) known = texel_range(scene_.images[static_cast<std::size_t>(map.image)]);
    return *known;
  }
  bool alpha_is_one(const Material& m) {
    return !m.base_color_map.present() || range(m.base_color_map).always(3, 255);
  }
  void note(NeedRule rule, std::string what, std::string why) {
    out_.push_back({rule, std::move(what), std::move(why)});
  }
  void drop(TextureRef& map, NeedRule rule, const char* what, const char* why) {
    note(rule, what, why);
    map = {};
  }

  void drop_maps_of_unlit(Material& m) {
    constexpr const char* kWhy = "the material is unlit";
    const auto gone = [&](TextureRef& map, const char* what) {
      if (map.present()) drop(map, NeedRule::kLighting, what, kWhy);
    };
    gone(m.metal_rough_map, "metal-rough map");
    gone(m.normal_map, "normal map");
    gone(m.occlusion_map, "occlusion map");
    gone(m.emissive_map, "emissive map");
    m.emissive = glm::vec3(0);
  }

  void check_alpha(Material& m, bool vertices_solid) {
    if (m.lobes.transmission > 0) return;  // transmission changes alpha
    if (m.alpha_mode == AlphaMode::kOpaque || !vertices_solid || !alpha_is_one(m)) return;
    const bool blend = m.alpha_mode == AlphaMode::kBlend;
    if (blend ? m.base_color.a != 1.0f : m.base_color.a < m.alpha_cutoff) return;
    note(NeedRule::kBlending, blend ? "blending" : "alpha test",
         blend ? "every alpha is 1" : "no alpha is below the cutoff");
    m.alpha_mode = AlphaMode::kOpaque;
  }

  void check_surface_maps(Material& m) {
    if (m.metal_rough_map.present()) {
      const TexelRange& r = range(m.metal_rough_map);
      const bool rough = m.roughness == 0 || r.always(1, 255);
      const bool metal = m.metallic == 0 || r.always(2, 255);
      if (rough && metal) {
        drop(m.metal_rough_map, NeedRule::kMaps, "metal-rough map",
             "1 in every texel, or its factor is 0");
      }
    }
    if (m.normal_map.present() && m.normal_scale == 0) {
      drop(m.normal_map, NeedRule::kMaps, "normal map", "its scale is 0");
    }
    if (m.occlusion_map.present() &&
        (m.occlusion_strength == 0 || range(m.occlusion_map).always(0, 255))) {
      drop(m.occlusion_map, NeedRule::kMaps, "occlusion map",
           m.occlusion_strength == 0 ? "its strength is 0" : "1 in every texel");
    }
  }

  void check_emission(Material& m) {
    if (!m.emissive_map.present()) return;
    const TexelRange& r = range(m.emissive_map);
    if (m.emissive == glm::vec3(0)) {
      drop(m.emissive_map, NeedRule::kEmission, "emissive map", "its factor is 0");
    } else if (r.black()) {
      drop(m.emissive_map, NeedRule::kEmission, "emission", "black in every texel");
      m.emissive = glm::vec3(0);
    } else if (r.white()) {
      drop(m.emissive_map, NeedRule::kEmission, "emissive map", "white in every texel");
    }
  }

  // Unread factors are reset, because they are part of the revision and of every byte of geometry.
  void reset_unread_factors(Material& m) {
    const Material plain;
    if (!m.normal_map.present()) m.normal_scale = plain.normal_scale;
    if (!m.occlusion_map.present()) m.occlusion_strength = plain.occlusion_strength;
    if (m.alpha_mode != AlphaMode::kMask) m.alpha_cutoff = plain.alpha_cutoff;
    if (m.alpha_mode == AlphaMode::kOpaque) m.base_color.a = plain.base_color.a;
    if (!m.unlit) return;
    m.metallic = plain.metallic;
    m.roughness = plain.roughness;
  }

  Scene& scene_;
  std::vector<std::optional<TexelRange>> ranges_;
  std::vector<bool> vertex_alpha_;  ///< by material: alpha is 1 on every vertex drawn with it
  std::vector<LeftOut> out_;
};

// Vertex attributes that the materials of a mesh read.
struct Reads {
  bool uv0 = false, uv1 = false, tangent = false, normal = false;
};

Reads reads_of(const Mesh& mesh, const std::vector<Material>& materials) {
  Reads out;
  for (const Primitive& p : mesh.primitives) {
    const Material& m = materials[p.material];
    out.normal = out.normal || !m.unlit;
    out.tangent = out.tangent || m.reads_tangents();
    m.each_map([&](const TextureRef& t) {
      if (t.present()) (t.uv_set == 1 ? out.uv1 : out.uv0) = true;
    });
  }
  return out;
}

// Resets an unread attribute to its default. Equal vertices then become equal, and so do the
// revision and every key.
template <typename Member>
void reset_attribute(Mesh& mesh, Member Vertex::*member, const char* what, const char* why,
                     std::vector<LeftOut>& out) {
  const Member plain = Vertex().*member;
  bool had = false;
  for (Vertex& v : mesh.vertices) {
    had = had || v.*member != plain;
    v.*member = plain;
  }
  if (had) out.push_back({NeedRule::kAttributes, what, why});
}

std::vector<LeftOut> reset_unread(SceneObject& object, const std::vector<Material>& materials) {
  std::vector<LeftOut> out;
  const Reads reads = reads_of(object.mesh, materials);
  Mesh& mesh = object.mesh;
  if (!reads.uv0) {
    reset_attribute(mesh, &Vertex::uv0, "first texture coordinates", "no map reads them", out);
  }
  if (!reads.uv1) {
    reset_attribute(mesh, &Vertex::uv1, "second texture coordinates", "no map reads them", out);
  }
  if (!reads.tangent) {
    reset_attribute(mesh, &Vertex::tangent, "tangents", "no normal map or grain reads them", out);
  }
  if (!reads.normal) reset_attribute(mesh, &Vertex::normal, "normals", "all is unlit", out);
  return out;
}

bool same_mesh(const Mesh& a, const Mesh& b) {
  const auto same_primitive = [](const Primitive& p, const Primitive& q) {
    return p.kind == q.kind && p.first_index == q.first_index && p.index_count == q.index_count &&
           p.material == q.material;
  };
  const auto same_vertex = [](const Vertex& v, const Vertex& w) {
    return v.position == w.position && v.normal == w.normal && v.tangent == w.tangent &&
           v.uv0 == w.uv0 && v.uv1 == w.uv1 && v.color == w.color;
  };
  return a.indices == b.indices &&
         std::equal(a.primitives.begin(), a.primitives.end(), b.primitives.begin(),
                    b.primitives.end(), same_primitive) &&
         std::equal(a.vertices.begin(), a.vertices.end(), b.vertices.begin(), b.vertices.end(),
                    same_vertex);
}

// Returns a hash that is equal for equal meshes; -0 counts as 0.
std::uint64_t hash_of(const Mesh& mesh) {
  std::vector<glm::vec3> places;
  places.reserve(mesh.vertices.size());
  for (const Vertex& vertex : mesh.vertices) places.push_back(vertex.position + glm::vec3(0));
  return XXH3_64bits_withSeed(places.data(), places.size() * sizeof(glm::vec3),
                              XXH3_64bits(mesh.indices.data(), mesh.indices.size() * 4));
}

// Instances of an object that equals an earlier one switch to that one, so equal tiles get equal
// keys.
std::size_t merge_equal_objects(Scene& scene) {
  std::unordered_multimap<std::uint64_t, std::uint32_t> kept;  // by hash
  std::vector<std::uint32_t> place;
  std::vector<SceneObject> objects;
  for (SceneObject& object : scene.objects) {
    const std::uint64_t hash = hash_of(object.mesh);
    const auto [first, last] = kept.equal_range(hash);
    const auto same = std::find_if(first, last, [&](const auto& one) {
      const SceneObject& other = objects[one.second];
      return !object.animation && !other.animation && same_mesh(other.mesh, object.mesh);
    });
    if (same != last) {
      place.push_back(same->second);
      continue;
    }
    place.push_back(static_cast<std::uint32_t>(objects.size()));
    kept.emplace(hash, place.back());
    objects.push_back(std::move(object));
  }
  for (Instance& instance : scene.instances) instance.object = place[instance.object];
  scene.objects = std::move(objects);
  return place.size() - scene.objects.size();
}

void drop_unused_images(Scene& scene) {
  std::vector<std::int32_t> place(scene.images.size(), -1);
  const auto each_map = [&](const auto& visit) {
    for (Material& m : scene.materials) {
      m.each_map([&](TextureRef& t) {
        if (t.present()) visit(t);
      });
    }
  };
  each_map([&](TextureRef& map) { place[static_cast<std::size_t>(map.image)] = 0; });
  std::int32_t next = 0;
  for (std::size_t i = 0; i < place.size(); ++i) {
    if (place[i] < 0) continue;
    if (static_cast<std::size_t>(next) != i) {
      scene.images[static_cast<std::size_t>(next)] = std::move(scene.images[i]);
    }
    place[i] = next++;
  }
  scene.images.resize(static_cast<std::size_t>(next));
  each_map([&](TextureRef& map) { map.image = place[static_cast<std::size_t>(map.image)]; });
}

}  // namespace

LeftOutOfScene leave_out_unneeded(Scene& scene) {
  LeftOutOfScene out;
  out.equal_objects = merge_equal_objects(scene);
  MaterialAnalysis analysis(scene);
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    out.materials.push_back(analysis.apply(i));
  }
  const Covered covered = leave_out_covered(scene);
  out.covered_instances = covered.instances;
  out.covered_triangles = covered.triangles;
  for (const std::uint32_t material : covered.materials) {
    out.materials.push_back(out.materials[material]);
  }
  for (SceneObject& object : scene.objects) {
    out.objects.push_back(reset_unread(object, scene.materials));
  }
  drop_unused_images(scene);
  return out;
}

}  // namespace mirage
