#include "server/prepare/derived_cache.h"

#include <xxhash.h>

#include <limits>
#include <optional>

#include "protocol/base/byte_stream.h"
#include "protocol/codec/animation_codec.h"
#include "protocol/codec/mip_chain.h"
#include "protocol/impostor/lod.h"
#include "protocol/impostor/object_proxy.h"
#include "protocol/model/need_mask.h"
#include "server/lod/lod_family.h"
#include "server/scene/scene.h"

namespace mirage {
namespace {

// Raise it when equal input gives other levels, other mips or another layout here.
constexpr std::uint32_t kDerivedVersion = 7;

class Hash128 {
 public:
  explicit Hash128(const char* kind) : kind_(kind), state_(XXH3_createState()) {
    XXH3_128bits_reset(state_);
    add(kDerivedVersion);
  }
  Hash128(const Hash128&) = delete;
  Hash128& operator=(const Hash128&) = delete;
  ~Hash128() { XXH3_freeState(state_); }

  template <typename T>
  void add(const T& value) {
    XXH3_128bits_update(state_, &value, sizeof(value));
  }
  template <typename T>
  void add_array(const std::vector<T>& values) {
    add(values.size());
    if (!values.empty()) {
      XXH3_128bits_update(state_, values.data(), values.size() * sizeof(T));
    }
  }
  CacheKey key() const {
    const XXH128_hash_t hash = XXH3_128bits_digest(state_);
    return {hash.high64, hash.low64, kind_};
  }

 private:
  const char* const kind_;
  XXH3_state_t* const state_;
};

template <typename T>
void put_array(ByteWriter& w, const std::vector<T>& values) {
  w.put(static_cast<std::uint64_t>(values.size()));
  if (!values.empty()) w.put_bytes(values.data(), values.size() * sizeof(T));
}

template <typename T>
bool get_array(ByteReader& r, std::vector<T>& values) {
  const auto count = r.get<std::uint64_t>();
  if (!r.has(count, sizeof(T))) return false;
  const std::uint8_t* from = r.take(count * sizeof(T));
  values.resize(count);
  if (count > 0) std::memcpy(static_cast<void*>(values.data()), from, count * sizeof(T));
  return true;
}

CacheKey geometry_key(const Scene& scene, const SceneObject& object,
                      const ObjectDescription& description,
                      const std::vector<std::uint64_t>& image_hashes, const LodFamilies& families) {
  Hash128 hash("lods");
  hash.add_array(object.mesh.vertices);
  hash.add_array(object.mesh.indices);
  for (const Primitive& p : object.mesh.primitives) {
    hash.add(p.kind);
    hash.add(p.first_index);
    hash.add(p.index_count);
    hash.add(p.material);
    const Material& material = scene.materials[p.material];
    hash.add_array(encode_materials({material}));
    const TextureRef& map = material.base_color_map;
    if (map.present()) hash.add(image_hashes[static_cast<std::size_t>(map.image)]);
  }
  hash.add_array(encode_animation(object.animation.get()));
  if (const SceneObject* first = families.first_of(object)) {
    hash.add_array(first->mesh.vertices);
    hash.add(first->baked->shape);
    hash.add(object.baked->shape);
  }
  hash.add(description.box_min);
  hash.add(description.box_max);
  return hash.key();
}

void put_mesh(ByteWriter& w, const Mesh& mesh) {
  put_array(w, mesh.vertices);
  put_array(w, mesh.indices);
  put_array(w, mesh.primitives);
}

// The file's hash proves that the bytes are those written. The mesh is still checked, because it is
// drawn.
bool get_mesh(ByteReader& r, std::size_t materials, Mesh& mesh) {
  if (!get_array(r, mesh.vertices) || !get_array(r, mesh.indices) ||
      !get_array(r, mesh.primitives)) {
    return false;
  }
  for (const std::uint32_t i : mesh.indices) {
    if (i >= mesh.vertices.size()) return false;
  }
  for (const Primitive& p : mesh.primitives) {
    if (p.material >= materials || p.kind > PrimitiveKind::kPoints ||
        std::uint64_t{p.first_index} + p.index_count > mesh.indices.size()) {
      return false;
    }
  }
  return true;
}

Bytes encode_geometry(const ObjectGeometry& geometry, const std::vector<LodInfo>& lods) {
  ByteWriter w;
  put_array(w, lods);
  for (std::size_t i = 0; i < lods.size(); ++i) {
    w.put(geometry.encoded[i].raw_bytes);
    put_array(w, geometry.encoded[i].payload);
    put_mesh(w, geometry.tile_lods[i]);
  }
  return std::move(w.bytes);
}

std::optional<ObjectGeometry> decode_geometry(const Bytes& bytes, std::size_t materials,
                                              std::vector<LodInfo>& lods) {
  ByteReader r(bytes.data(), bytes.size());
  if (!get_array(r, lods)) return std::nullopt;
  ObjectGeometry out;
  for (std::size_t i = 0; i < lods.size(); ++i) {
    EncodedLod& encoded = out.encoded.emplace_back();
    encoded.raw_bytes = r.get<std::uint32_t>();
    if (!get_array(r, encoded.payload) || !get_mesh(r, materials, out.tile_lods.emplace_back())) {
      return std::nullopt;
    }
  }
  if (!r.at_end()) return std::nullopt;
  return out;
}

std::optional<std::vector<Image>> decode_mips(const Bytes& bytes, const Image& image) {
  ByteReader r(bytes.data(), bytes.size());
  std::vector<Image> out;
  for (auto left = r.get<std::uint32_t>(); left > 0; --left) {
    Image& mip = out.emplace_back();
    mip.width = r.get<std::uint32_t>();
    mip.height = r.get<std::uint32_t>();
    mip.srgb = image.srgb;
    if (!get_array(r, mip.rgba) || mip.rgba.size() != std::size_t{4} * mip.width * mip.height) {
      return std::nullopt;
    }
  }
  if (!r.at_end()) return std::nullopt;
  return out;
}

std::vector<Image> find_or_make_mips(const Image& image, float cutoff, CacheDirectory* cache) {
  if (!cache) return alpha_preserving_mips(image, cutoff);
  Hash128 hash("mips");
  hash.add(image.width);
  hash.add(image.height);
  hash.add(image.srgb);
  hash.add(cutoff);
  hash.add_array(image.rgba);
  if (const std::optional<Bytes> bytes = cache->read(hash.key())) {
    if (auto found = decode_mips(*bytes, image)) return std::move(*found);
  }
  std::vector<Image> made = alpha_preserving_mips(image, cutoff);
  ByteWriter w;
  w.put(static_cast<std::uint32_t>(made.size()));
  for (const Image& mip : made) {
    w.put(mip.width);
    w.put(mip.height);
    put_array(w, mip.rgba);
  }
  cache->write(hash.key(), std::move(w.bytes));
  return made;
}

}  // namespace

std::vector<std::uint64_t> hash_images(const Scene& scene, const Workers& workers) {
  std::vector<std::uint64_t> out(scene.images.size());
  workers.each(out.size(), [&](std::size_t i) {
    const Image& image = scene.images[i];
    out[i] = XXH3_64bits_withSeed(image.rgba.data(), image.rgba.size(), image.width);
  });
  return out;
}

ObjectGeometry find_or_make_geometry(const Scene& scene, const SceneObject& object,
                                     ObjectDescription& description, CacheDirectory* cache,
                                     const std::vector<std::uint64_t>& image_hashes,
                                     const LodFamilies& families, const Workers& workers) {
  if (!cache) return make_geometry(scene, object, description, &families, workers);
  const CacheKey key = geometry_key(scene, object, description, image_hashes, families);
  if (const std::optional<Bytes> bytes = cache->read(key)) {
    std::vector<LodInfo> lods;
    if (auto found = decode_geometry(*bytes, scene.materials.size(), lods)) {
      description.lods = std::move(lods);
      return std::move(*found);
    }
  }
  ObjectGeometry made = make_geometry(scene, object, description, &families, workers);
  cache->write(key, encode_geometry(made, description.lods));
  return made;
}

std::vector<std::vector<Image>> make_mips(const Scene& scene, CacheDirectory* cache,
                                          const Workers& workers) {
  std::vector<std::vector<Image>> out(scene.images.size());
  workers.each(out.size(), [&](std::size_t i) {
    const float cutoff = alpha_test_cutoff(static_cast<std::int32_t>(i), scene.materials);
    if (cutoff > 0) out[i] = find_or_make_mips(scene.images[i], cutoff, cache);
  });
  return out;
}

}  // namespace mirage
