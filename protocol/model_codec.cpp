#include "protocol/model_codec.h"

#include <cmath>
#include <cstring>
#include <type_traits>

#include "protocol/animation_codec.h"
#include "protocol/limits.h"

namespace mirage {
namespace {

// Fixed layouts are written as the memory of trivially copyable structs; all supported targets are
// little-endian (checked here), so the wire is too.
#if __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "the model codec needs a little-endian target"
#endif

constexpr std::size_t kTextureBytes = 4 + 4 + 5 * 4;
constexpr std::size_t kMaterialBytes = 4 * 4 + 3 * 4 + 5 * 4 + 4 + 5 * kTextureBytes;
constexpr std::size_t kPrimitiveBytes = 16;
constexpr std::size_t kImageHeaderBytes = 12;

class Writer {
 public:
  template <typename T>
  void put(const T& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto* p = reinterpret_cast<const std::uint8_t*>(&v);
    bytes.insert(bytes.end(), p, p + sizeof(T));
  }
  template <typename T>
  void put_array(const std::vector<T>& v) {
    const auto* p = reinterpret_cast<const std::uint8_t*>(v.data());
    bytes.insert(bytes.end(), p, p + v.size() * sizeof(T));
  }
  Bytes bytes;
};

class Reader {
 public:
  Reader(const std::uint8_t* bytes, std::size_t size) : at_(bytes), left_(size) {}

  template <typename T>
  T get() {
    T v{};
    if (left_ < sizeof(T)) {
      failed_ = true;
      return v;
    }
    std::memcpy(&v, at_, sizeof(T));
    skip(sizeof(T));
    return v;
  }
  /// Reads `n` elements; fails (allocating nothing) when they are not there.
  template <typename T>
  void get_array(std::vector<T>& out, std::size_t n) {
    if (failed_ || n > left_ / sizeof(T)) {
      failed_ = true;
      return;
    }
    out.resize(n);
    if (n > 0) std::memcpy(out.data(), at_, n * sizeof(T));
    skip(n * sizeof(T));
  }
  bool has(std::size_t n, std::size_t each) const { return !failed_ && n <= left_ / each; }
  bool failed() const { return failed_; }
  const std::uint8_t* at() const { return at_; }
  std::size_t left() const { return left_; }

 private:
  void skip(std::size_t n) {
    at_ += n;
    left_ -= n;
  }
  const std::uint8_t* at_;
  std::size_t left_;
  bool failed_ = false;
};

void put_texture(Writer& w, const TextureRef& t) {
  w.put(t.image);
  w.put(t.uv_set);
  w.put(static_cast<std::uint8_t>(t.wrap_s));
  w.put(static_cast<std::uint8_t>(t.wrap_t));
  w.put(static_cast<std::uint8_t>(t.nearest));
  for (const float v : {t.offset.x, t.offset.y, t.scale.x, t.scale.y, t.rotation}) w.put(v);
}

bool get_texture(Reader& r, TextureRef& t, std::size_t images) {
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

void put_material(Writer& w, const Material& m) {
  for (int i = 0; i < 4; ++i) w.put(m.base_color[i]);
  for (int i = 0; i < 3; ++i) w.put(m.emissive[i]);
  for (const float v :
       {m.metallic, m.roughness, m.normal_scale, m.occlusion_strength, m.alpha_cutoff}) {
    w.put(v);
  }
  w.put(static_cast<std::uint8_t>(m.alpha_mode));
  w.put(static_cast<std::uint8_t>(m.double_sided));
  w.put(static_cast<std::uint8_t>(m.unlit));
  w.put(std::uint8_t{0});
  for (const TextureRef* t :
       {&m.base_color_map, &m.metal_rough_map, &m.normal_map, &m.occlusion_map, &m.emissive_map}) {
    put_texture(w, *t);
  }
}

bool get_material(Reader& r, Material& m, std::size_t images) {
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
  const auto unlit = r.get<std::uint8_t>(), zero = r.get<std::uint8_t>();
  if (alpha_mode > 2 || double_sided > 1 || unlit > 1 || zero != 0) return false;
  m.alpha_mode = static_cast<AlphaMode>(alpha_mode);
  m.double_sided = double_sided != 0;
  m.unlit = unlit != 0;
  for (TextureRef* t :
       {&m.base_color_map, &m.metal_rough_map, &m.normal_map, &m.occlusion_map, &m.emissive_map}) {
    ok = get_texture(r, *t, images) && ok;
  }
  return ok;
}

Error value_error(const char* what) {
  return make_error(ErrorId::kWireValue, std::string("geometry has a bad ") + what);
}

Result<void> check_mesh(const Mesh& mesh, std::size_t materials) {
  for (const Vertex& v : mesh.vertices) {
    const double sum = 0.0 + v.position.x + v.position.y + v.position.z + v.normal.x + v.normal.y +
                       v.normal.z + v.tangent.x + v.tangent.y + v.tangent.z + v.tangent.w +
                       v.uv0.x + v.uv0.y + v.uv1.x + v.uv1.y;
    if (!std::isfinite(sum)) return value_error("vertex");
  }
  for (const std::uint32_t i : mesh.indices) {
    if (i >= mesh.vertices.size()) return value_error("index");
  }
  for (const Primitive& p : mesh.primitives) {
    const bool range = std::uint64_t{p.first_index} + p.index_count <= mesh.indices.size();
    if (!range || p.material >= materials || p.kind > PrimitiveKind::kPoints) {
      return value_error("primitive");
    }
  }
  return {};
}

Result<void> read_images(Reader& r, std::vector<Image>& images, std::size_t count) {
  if (!r.has(count, kImageHeaderBytes)) return value_error("image count");
  images.resize(count);
  for (Image& image : images) {
    image.width = r.get<std::uint32_t>();
    image.height = r.get<std::uint32_t>();
    image.srgb = r.get<std::uint32_t>() != 0;
    const bool size = image.width >= 1 && image.height >= 1 &&
                      image.width <= limits::kMaxImageEdge && image.height <= limits::kMaxImageEdge;
    if (!size) return value_error("image size");
    r.get_array(image.rgba, std::size_t{image.width} * image.height * 4);
    if (r.failed()) return value_error("image");
  }
  return {};
}

Result<void> read_mesh(Reader& r, Mesh& mesh) {
  const auto vertices = r.get<std::uint32_t>();
  const auto indices = r.get<std::uint32_t>();
  const auto primitives = r.get<std::uint32_t>();
  if (vertices > limits::kMaxMeshVertices || indices > limits::kMaxMeshIndices ||
      primitives > limits::kMaxMeshPrimitives) {
    return make_error(ErrorId::kWireLimit, "geometry is larger than allowed");
  }
  r.get_array(mesh.vertices, vertices);
  r.get_array(mesh.indices, indices);
  if (!r.has(primitives, kPrimitiveBytes)) return value_error("primitive count");
  mesh.primitives.resize(primitives);
  for (Primitive& p : mesh.primitives) {
    p.kind = static_cast<PrimitiveKind>(std::min<std::uint32_t>(r.get<std::uint32_t>(), 255));
    p.first_index = r.get<std::uint32_t>();
    p.index_count = r.get<std::uint32_t>();
    p.material = r.get<std::uint32_t>();
  }
  return {};
}

}  // namespace

std::size_t encoded_model_bytes(const ObjectModel& m) {
  std::size_t bytes = 5 * 4 + m.mesh.vertices.size() * sizeof(Vertex) + m.mesh.indices.size() * 4 +
                      m.mesh.primitives.size() * kPrimitiveBytes +
                      m.materials.size() * kMaterialBytes;
  for (const Image& image : m.images) bytes += kImageHeaderBytes + image.rgba.size();
  return bytes + encoded_animation_bytes(m.animation.get());
}

Bytes encode_model(const ObjectModel& m) {
  Writer w;
  w.bytes.reserve(encoded_model_bytes(m));
  w.put(static_cast<std::uint32_t>(m.mesh.vertices.size()));
  w.put(static_cast<std::uint32_t>(m.mesh.indices.size()));
  w.put(static_cast<std::uint32_t>(m.mesh.primitives.size()));
  w.put_array(m.mesh.vertices);
  w.put_array(m.mesh.indices);
  for (const Primitive& p : m.mesh.primitives) {
    w.put(static_cast<std::uint32_t>(p.kind));
    w.put(p.first_index);
    w.put(p.index_count);
    w.put(p.material);
  }
  w.put(static_cast<std::uint32_t>(m.images.size()));
  for (const Image& image : m.images) {
    w.put(image.width);
    w.put(image.height);
    w.put(static_cast<std::uint32_t>(image.srgb));
    w.put_array(image.rgba);
  }
  w.put(static_cast<std::uint32_t>(m.materials.size()));
  for (const Material& material : m.materials) put_material(w, material);
  w.put_array(encode_animation(m.animation.get()));
  return std::move(w.bytes);
}

Result<ObjectModel> decode_model(const std::uint8_t* bytes, std::size_t size) {
  Reader r(bytes, size);
  ObjectModel model;
  if (Result<void> mesh = read_mesh(r, model.mesh); !mesh) return mesh.error();
  if (Result<void> images = read_images(r, model.images, r.get<std::uint32_t>()); !images) {
    return images.error();
  }
  const auto materials = r.get<std::uint32_t>();
  if (!r.has(materials, kMaterialBytes)) return value_error("material count");
  model.materials.resize(materials);
  for (Material& material : model.materials) {
    if (!get_material(r, material, model.images.size())) return value_error("material");
  }
  if (r.failed()) return make_error(ErrorId::kWireMalformed, "geometry ends too early");
  if (Result<void> mesh = check_mesh(model.mesh, model.materials.size()); !mesh) {
    return mesh.error();
  }
  auto animation = decode_animation(r.at(), r.left(), model.mesh.vertices.size());
  if (!animation) return animation.error();
  model.animation = animation.take();
  return model;
}

}  // namespace mirage
