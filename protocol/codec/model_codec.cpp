#include "protocol/codec/model_codec.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "protocol/base/limits.h"
#include "protocol/codec/animation_codec.h"
#include "protocol/codec/material_codec.h"
#include "protocol/codec/vertex_codec.h"
#include "protocol/model/need_mask.h"

namespace mirage {
namespace {

constexpr std::size_t kPrimitiveBytes = 12;
constexpr std::size_t kHeaderBytes = 128;  // at most: counts and ranges
// Most elements that meshoptimizer packs into a byte: larger counts cannot be genuine.
constexpr std::size_t kVerticesPerByte = 6;
constexpr std::size_t kIndicesPerByte = 3;

Error value_error(const char* what) {
  return make_error(ErrorId::kWireValue, std::string("geometry has a bad ") + what);
}
Error malformed(const char* what) {
  return make_error(ErrorId::kWireMalformed, std::string("geometry: ") + what);
}

std::uint32_t streams_of(const ModelView& model) {
  std::uint32_t streams = has_vertex_color(model.mesh) ? kColor : 0u;
  for (const Material& m : model.materials) {
    if (m.reads_tangents()) streams |= kTangent;
    m.each_map([&](const TextureRef& t) {
      if (t.present()) streams |= t.uv_set == 1 ? kUv1 : kUv0;
    });
  }
  return streams;
}

VertexLayout layout_of(const ModelView& model, const std::vector<std::uint32_t>& indices) {
  VertexLayout layout;
  layout.streams = streams_of(model);
  bool first = true;
  for (const std::uint32_t i : indices) {
    const Vertex& v = model.mesh.vertices[i];
    layout.position.grow(v.position, first);
    layout.uv0.grow(v.uv0, first);
    layout.uv1.grow(v.uv1, first);
    first = false;
  }
  return layout;
}

/// Indices and primitives in wire order, primitives back to back.
struct Ordered {
  std::vector<std::uint32_t> indices;
  std::vector<Primitive> primitives;
  std::size_t triangle_indices = 0;  ///< they come first
};

Ordered in_wire_order(const ModelView& model) {
  Ordered out;
  const auto take = [&](const Primitive& p) {
    const auto at = out.indices.size();
    const auto from = model.mesh.indices.begin() + p.first_index;
    // Only whole triangles and lines are kept: leftover indices draw nothing.
    const std::uint32_t corners = p.kind == PrimitiveKind::kTriangles ? 3
                                  : p.kind == PrimitiveKind::kLines   ? 2
                                                                      : 1;
    const std::uint32_t count = p.index_count / corners * corners;
    out.indices.insert(out.indices.end(), from, from + count);
    out.primitives.push_back({p.kind, static_cast<std::uint32_t>(at), count, p.material});
  };
  for (const Primitive& p : model.primitives) {
    if (p.kind == PrimitiveKind::kTriangles) take(p);
  }
  out.triangle_indices = out.indices.size();
  for (const Primitive& p : model.primitives) {
    if (p.kind != PrimitiveKind::kTriangles) take(p);
  }
  return out;
}

// True if each vertex below `count` is used, and none before those of lower numbers.
bool in_order_of_use(const std::vector<std::uint32_t>& indices, std::size_t count) {
  std::size_t next = 0;
  for (const std::uint32_t i : indices) {
    if (i > next) return false;
    next += i == next;
  }
  return next == count;
}

/// Quantised vertices without duplicates, in order of first use; `order.indices` then refer to
/// them.
Bytes unique_vertices(const ModelView& model, const VertexLayout& layout, Ordered& order,
                      std::size_t& count) {
  const std::size_t stride = layout.stride();
  ByteWriter all;
  all.bytes.reserve(model.mesh.vertices.size() * stride);
  for (const Vertex& v : model.mesh.vertices) put_vertex(all, v, layout);
  if (model.animation) {  // it refers to vertices by index
    count = model.mesh.vertices.size();
    return std::move(all.bytes);
  }
  std::vector<std::uint32_t> remap(model.mesh.vertices.size());
  // The remap works on vertices without indices, because those of lines and points need not come in
  // threes.
  if (!remap.empty()) {
    count = meshopt_generateVertexRemap(remap.data(), nullptr, remap.size(), all.bytes.data(),
                                        remap.size(), stride);
  }
  Bytes joined = std::move(all.bytes);
  for (std::size_t i = 0; i < remap.size(); ++i) {  // numbers rise: a vertex moves to the front
    if (remap[i] == i) continue;
    std::copy_n(joined.begin() + static_cast<std::ptrdiff_t>(i * stride), stride,
                joined.begin() + static_cast<std::ptrdiff_t>(remap[i] * stride));
  }
  joined.resize(count * stride);
  for (std::uint32_t& i : order.indices) i = remap[i];
  remap = {};
  for (const Primitive& p : order.primitives) {
    const bool sorted = model.materials[p.material].alpha_mode == AlphaMode::kBlend;
    if (p.kind != PrimitiveKind::kTriangles || sorted || p.index_count == 0) continue;
    std::uint32_t* at = &order.indices[p.first_index];
    meshopt_optimizeVertexCache(at, std::vector<std::uint32_t>(at, at + p.index_count).data(),
                                p.index_count, count);
  }
  if (in_order_of_use(order.indices, count)) return joined;  // most point clouds: no second copy
  std::vector<std::uint32_t> place(count, UINT32_MAX);
  Bytes out;
  out.reserve(joined.size());
  std::uint32_t next = 0;
  for (std::uint32_t& i : order.indices) {  // drops vertices that no index uses
    if (place[i] == UINT32_MAX) {
      place[i] = next++;
      const auto from = joined.begin() + static_cast<std::ptrdiff_t>(i * stride);
      out.insert(out.end(), from, from + static_cast<std::ptrdiff_t>(stride));
    }
    i = place[i];
  }
  count = next;
  return out;
}

/// Returns what `encode(to, most)` writes of `count` elements; it returns the bytes used. `most`
/// is up to twice of that: memory that is not written to is not taken.
template <typename Encode>
Bytes coded(std::size_t count, std::size_t most, const Encode& encode) {
  if (count == 0) return {};
  const std::unique_ptr<std::uint8_t[]> to(new std::uint8_t[most]);  // not filled with zeros
  return {to.get(), to.get() + encode(to.get(), most)};
}

template <typename V>
void put_range(ByteWriter& w, const Range<V>& range) {
  for (int c = 0; c < V::length(); ++c) w.put(range.low[c]);
  for (int c = 0; c < V::length(); ++c) w.put(range.size[c]);
}

template <typename V>
bool get_range(ByteReader& r, Range<V>& range) {
  bool good = true;
  for (int c = 0; c < V::length(); ++c) range.low[c] = r.get<float>();
  for (int c = 0; c < V::length(); ++c) range.size[c] = r.get<float>();
  for (int c = 0; c < V::length(); ++c) {
    good = good && std::isfinite(range.low[c]) && std::isfinite(range.low[c] + range.size[c]) &&
           range.size[c] >= 0;
  }
  return good;
}

struct Header {
  std::uint32_t vertices = 0, triangle_indices = 0, other_indices = 0;
  std::uint32_t primitives = 0, materials = 0;
  std::uint32_t vertex_bytes = 0, triangle_bytes = 0, other_bytes = 0;
  VertexLayout layout;
};

Result<Header> read_header(ByteReader& r) {
  Header h;
  for (std::uint32_t* word :
       {&h.vertices, &h.triangle_indices, &h.other_indices, &h.primitives, &h.materials,
        &h.vertex_bytes, &h.triangle_bytes, &h.other_bytes, &h.layout.streams}) {
    *word = r.get<std::uint32_t>();
  }
  const bool ranges =
      get_range(r, h.layout.position) && get_range(r, h.layout.uv0) && get_range(r, h.layout.uv1);
  if (r.failed()) return malformed("cut short");
  if (!ranges || h.layout.streams > kAllStreams) return value_error("range");
  if (h.vertices > limits::kMaxMeshVertices || h.primitives > limits::kMaxMeshPrimitives ||
      h.materials > limits::kMaxMeshPrimitives ||
      std::uint64_t{h.triangle_indices} + h.other_indices > limits::kMaxMeshIndices) {
    return make_error(ErrorId::kWireLimit, "geometry is larger than allowed");
  }
  const std::uint64_t bytes = std::uint64_t{h.vertex_bytes} + h.triangle_bytes + h.other_bytes +
                              h.primitives * kPrimitiveBytes + h.materials * kMaterialBytes;
  if (!r.has(bytes, 1)) return malformed("cut short");
  const bool possible = h.vertices <= std::uint64_t{h.vertex_bytes} * kVerticesPerByte &&
                        h.triangle_indices <= std::uint64_t{h.triangle_bytes} * kIndicesPerByte &&
                        h.other_indices <= h.other_bytes && h.triangle_indices % 3 == 0;
  if (!possible) return value_error("count");
  return h;
}

Result<void> read_primitives(ByteReader& r, const Header& h, Mesh& mesh) {
  std::uint64_t first = 0;
  for (std::uint32_t i = 0; i < h.primitives; ++i) {
    const auto kind = r.get<std::uint32_t>();
    const auto count = r.get<std::uint32_t>();
    const auto material = r.get<std::uint32_t>();
    const bool triangles = kind == static_cast<std::uint32_t>(PrimitiveKind::kTriangles);
    // Triangles come first and fill their part exactly.
    const bool in_place = triangles ? first + count <= h.triangle_indices && count % 3 == 0
                                    : first >= h.triangle_indices;
    if (kind > static_cast<std::uint32_t>(PrimitiveKind::kPoints) || !in_place ||
        material >= h.materials ||
        first + count > std::uint64_t{h.triangle_indices} + h.other_indices) {
      return value_error("primitive");
    }
    mesh.primitives.push_back(
        {static_cast<PrimitiveKind>(kind), static_cast<std::uint32_t>(first), count, material});
    first += count;
  }
  if (first != std::uint64_t{h.triangle_indices} + h.other_indices) return value_error("primitive");
  return {};
}

Result<void> read_vertices(ByteReader& r, const Header& h, Mesh& mesh) {
  const std::size_t stride = h.layout.stride();
  const std::uint8_t* encoded = r.take(h.vertex_bytes);
  Bytes packed(h.vertices * stride);
  if (h.vertices > 0 &&
      meshopt_decodeVertexBuffer(packed.data(), h.vertices, stride, encoded, h.vertex_bytes) != 0) {
    return malformed("damaged vertices");
  }
  ByteReader from(packed.data(), packed.size());
  mesh.vertices.reserve(h.vertices);
  for (std::uint32_t i = 0; i < h.vertices; ++i) {
    mesh.vertices.push_back(get_vertex(from, h.layout));
  }
  return {};
}

Result<void> read_indices(ByteReader& r, const Header& h, Mesh& mesh) {
  mesh.indices.resize(std::size_t{h.triangle_indices} + h.other_indices);
  const std::uint8_t* triangles = r.take(h.triangle_bytes);
  if (h.triangle_indices > 0 && meshopt_decodeIndexBuffer(mesh.indices.data(), h.triangle_indices,
                                                          4, triangles, h.triangle_bytes) != 0) {
    return malformed("damaged triangles");
  }
  const std::uint8_t* others = r.take(h.other_bytes);
  if (h.other_indices > 0 &&
      meshopt_decodeIndexSequence(mesh.indices.data() + h.triangle_indices, h.other_indices, 4,
                                  others, h.other_bytes) != 0) {
    return malformed("damaged lines");
  }
  for (const std::uint32_t i : mesh.indices) {
    if (i >= h.vertices) return value_error("index");
  }
  return {};
}

}  // namespace

double quantisation_error(const glm::vec3& box_min, const glm::vec3& box_max) {
  // Float arithmetic on the way adds a few units in the last place.
  const double extent = glm::length(glm::dvec3(box_max) - glm::dvec3(box_min));
  const double reach = std::max(glm::length(glm::dvec3(box_min)), glm::length(glm::dvec3(box_max)));
  return 0.5 * extent / 65535.0 + 4e-7 * reach;
}

Bytes encode_materials(const std::vector<Material>& materials) {
  ByteWriter w;
  for (const Material& m : materials) put_material(w, m);
  return std::move(w.bytes);
}

Bytes encode_model(const ModelView& model) {
  Ordered order = in_wire_order(model);
  const VertexLayout layout = layout_of(model, order.indices);
  std::size_t vertices = 0;
  Bytes packed = unique_vertices(model, layout, order, vertices);
  const std::size_t triangles = order.triangle_indices;
  const std::size_t others = order.indices.size() - triangles;

  const Bytes vertex_code =
      coded(vertices, meshopt_encodeVertexBufferBound(vertices, layout.stride()),
            [&](std::uint8_t* to, std::size_t most) {
              return meshopt_encodeVertexBuffer(to, most, packed.data(), vertices, layout.stride());
            });
  packed = {};  // may be 100 MB, like those below
  const Bytes triangle_code =
      coded(triangles, meshopt_encodeIndexBufferBound(triangles, vertices),
            [&](std::uint8_t* to, std::size_t most) {
              return meshopt_encodeIndexBuffer(to, most, order.indices.data(), triangles);
            });
  const Bytes other_code = coded(others, meshopt_encodeIndexSequenceBound(others, vertices),
                                 [&](std::uint8_t* to, std::size_t most) {
                                   return meshopt_encodeIndexSequence(
                                       to, most, order.indices.data() + triangles, others);
                                 });
  order.indices = {};

  ByteWriter w;
  w.bytes.reserve(vertex_code.size() + triangle_code.size() + other_code.size() +
                  kPrimitiveBytes * order.primitives.size() +
                  kMaterialBytes * model.materials.size() + kHeaderBytes);
  for (const std::size_t word :
       {vertices, triangles, others, order.primitives.size(), model.materials.size(),
        vertex_code.size(), triangle_code.size(), other_code.size(), std::size_t{layout.streams}}) {
    w.put(static_cast<std::uint32_t>(word));
  }
  put_range(w, layout.position);
  put_range(w, layout.uv0);
  put_range(w, layout.uv1);
  for (const Primitive& p : order.primitives) {
    w.put(static_cast<std::uint32_t>(p.kind));
    w.put(p.index_count);
    w.put(p.material);
  }
  w.put_bytes(vertex_code.data(), vertex_code.size());
  w.put_bytes(triangle_code.data(), triangle_code.size());
  w.put_bytes(other_code.data(), other_code.size());
  for (const Material& m : model.materials) put_material(w, m);
  const Bytes animation = encode_animation(model.animation);
  w.put_bytes(animation.data(), animation.size());
  return std::move(w.bytes);
}

Result<ObjectModel> decode_model(const std::uint8_t* bytes, std::size_t size,
                                 std::size_t image_count) {
  ByteReader r(bytes, size);
  const Result<Header> header = read_header(r);
  if (!header) return header.error();
  ObjectModel model;
  if (Result<void> done = read_primitives(r, *header, model.mesh); !done) return done.error();
  if (Result<void> done = read_vertices(r, *header, model.mesh); !done) return done.error();
  if (Result<void> done = read_indices(r, *header, model.mesh); !done) return done.error();
  model.materials.resize(header->materials);
  for (Material& material : model.materials) {
    if (!get_material(r, material, image_count)) return value_error("material");
  }
  if (r.failed()) return malformed("bytes do not add up");
  auto animation = decode_animation(r.at(), r.left(), model.mesh.vertices.size());
  if (!animation) return animation.error();
  model.animation = animation.take();
  return model;
}

}  // namespace mirage
