#include "server/scene/builtin/sculpture_cache.h"

#include <optional>

#include "protocol/base/byte_stream.h"
#include "server/scene/builtin/random.h"

namespace mirage::builtin {
namespace {

// Raise it when the same number gives another sculpture, or another layout here.
constexpr std::uint32_t kSculptureVersion = 1;

CacheKey key_of(std::uint32_t seed, std::uint32_t number, std::size_t triangles) {
  const std::uint64_t what = mix_bits(std::uint64_t{kSculptureVersion} << 32 | number);
  return {mix_bits(what ^ seed), mix_bits(what + mix_bits(triangles)), "sculpture"};
}

/// Attributes that differ from vertex to vertex of a sculpture.
struct StoredVertex {
  glm::vec3 position, normal;
  glm::vec4 tangent;
  glm::vec2 uv;
};
static_assert(sizeof(StoredVertex) == 48);

template <typename T>
void put_array(ByteWriter& w, const std::vector<T>& values) {
  w.put(static_cast<std::uint64_t>(values.size()));
  w.put_bytes(values.data(), values.size() * sizeof(T));
}

/// Returns the values in place; nullptr if they are incomplete.
const std::uint8_t* take_array(ByteReader& r, std::size_t each, std::size_t& count) {
  count = r.get<std::uint64_t>();
  return r.has(count, each) ? r.take(count * each) : nullptr;
}

void put_image(ByteWriter& w, const Image& image) {
  w.put(image.width);
  w.put(image.height);
  w.put(image.srgb);
  put_array(w, image.rgba);
}

bool get_image(ByteReader& r, Image& image) {
  image.width = r.get<std::uint32_t>();
  image.height = r.get<std::uint32_t>();
  image.srgb = r.get<bool>();
  std::size_t bytes = 0;
  const std::uint8_t* from = take_array(r, 1, bytes);
  if (!from || bytes != std::size_t{4} * image.width * image.height) return false;
  image.rgba.assign(from, from + bytes);
  return true;
}

Bytes encode(const Sculpture& s) {
  ByteWriter w;
  w.put(static_cast<std::uint64_t>(s.name.size()));
  w.put_bytes(s.name.data(), s.name.size());
  w.put(s.height);
  w.put(s.finish.roughness);
  w.put(s.finish.metallic);
  for (const Image* image : {&s.finish.color, &s.finish.metal_rough, &s.finish.normal}) {
    put_image(w, *image);
  }
  put_array(w, s.mesh.indices);
  w.put(static_cast<std::uint64_t>(s.mesh.vertices.size()));
  for (const Vertex& v : s.mesh.vertices) {
    w.put(StoredVertex{v.position, v.normal, v.tangent, v.uv0});
  }
  return std::move(w.bytes);
}

// The file's hash proves that the bytes are those written. The sculpture is still checked, because
// it is drawn.
std::optional<Sculpture> decode(const Bytes& bytes) {
  ByteReader r(bytes.data(), bytes.size());
  Sculpture s;
  std::size_t count = 0;
  if (const std::uint8_t* name = take_array(r, 1, count)) s.name.assign(name, name + count);
  s.height = r.get<float>();
  s.finish.roughness = r.get<float>();
  s.finish.metallic = r.get<float>();
  for (Image* image : {&s.finish.color, &s.finish.metal_rough, &s.finish.normal}) {
    if (!get_image(r, *image)) return std::nullopt;
  }
  const std::uint8_t* indices = take_array(r, sizeof(std::uint32_t), count);
  if (!indices) return std::nullopt;
  s.mesh.indices.resize(count);
  std::memcpy(s.mesh.indices.data(), indices, count * sizeof(std::uint32_t));
  const std::uint8_t* vertices = take_array(r, sizeof(StoredVertex), count);
  if (!vertices || !r.at_end()) return std::nullopt;
  s.mesh.vertices.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    StoredVertex from;
    std::memcpy(&from, vertices + i * sizeof(from), sizeof(from));
    Vertex& v = s.mesh.vertices[i];
    v.position = from.position;
    v.normal = from.normal;
    v.tangent = from.tangent;
    v.uv0 = from.uv;
  }
  for (const std::uint32_t i : s.mesh.indices) {
    if (i >= count) return std::nullopt;
  }
  Primitive whole;
  whole.index_count = static_cast<std::uint32_t>(s.mesh.indices.size());
  s.mesh.primitives = {whole};
  return s;
}

}  // namespace

Sculpture find_or_make_sculpture(std::uint32_t seed, std::uint32_t number, std::size_t triangles,
                                 CacheDirectory* cache) {
  if (!cache) return make_sculpture(seed, number, triangles);
  const CacheKey key = key_of(seed, number, triangles);
  if (const std::optional<Bytes> bytes = cache->read(key)) {
    if (std::optional<Sculpture> found = decode(*bytes)) return std::move(*found);
  }
  Sculpture made = make_sculpture(seed, number, triangles);
  cache->write(key, encode(made));
  return made;
}

}  // namespace mirage::builtin
