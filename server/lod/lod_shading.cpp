#include "server/lod/lod_shading.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

namespace mirage {
namespace {

constexpr std::uint32_t kLeastEdge = 32, kMostEdge = 256;
constexpr double kPixelsPerTriangle = 4;  // per side of a picture
constexpr std::uint32_t kCoarsestEdge = 8;
// in mean light, a turn of a normal or grain shows at half its size
constexpr float kNormalWeight = 0.5f;
constexpr float kWhole = 0.99f;  // less cover is an edge, which MeshLod::error covers
constexpr float kMargin = 1.02f;

// Returns views along the axes of a tilted frame, so that few faces are seen exactly edge-on.
std::array<glm::mat3, MeshPictures::kSides> view_rotations() {
  const glm::mat3 askew = glm::mat3_cast(glm::normalize(glm::quat(0.93f, 0.21f, 0.27f, 0.13f)));
  std::array<glm::mat3, MeshPictures::kSides> out;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const int axis = static_cast<int>(i % 3);
    const float sign = i < 3 ? 1.0f : -1.0f;
    glm::vec3 right(0), up(0), toward(0);
    toward[axis] = sign;
    right[(axis + 1) % 3] = sign;
    up[(axis + 2) % 3] = 1;
    out[i] = glm::transpose(glm::mat3(right, up, toward)) * askew;
  }
  return out;
}

std::uint32_t wrapped(float v, std::uint32_t size, Wrap wrap) {
  const auto n = static_cast<float>(size);
  float at = std::isfinite(v) ? v : 0.0f;
  if (wrap == Wrap::kClamp) at = std::clamp(at, 0.0f, 1.0f);
  if (wrap == Wrap::kMirror) at = 1 - std::abs(1 - (at - 2 * std::floor(0.5f * at)));
  if (wrap == Wrap::kRepeat) at -= std::floor(at);
  return static_cast<std::uint32_t>(std::clamp(at * n, 0.0f, n - 1));
}

/// The base colour of one primitive.
class Paint {
 public:
  Paint(const Material& material, const std::vector<Image>& images)
      : map_(material.base_color_map),
        image_(map_.present() ? &images[static_cast<std::size_t>(map_.image)] : nullptr),
        factor_(glm::sqrt(glm::vec3(material.base_color))),
        turn_(std::cos(map_.rotation), std::sin(map_.rotation)) {}

  glm::vec3 at(const Vertex* const (&v)[3], const glm::vec3& weights) const {
    glm::vec3 color = factor_;
    glm::vec3 tint(0);
    for (int k = 0; k < 3; ++k) tint += weights[k] * glm::vec3(v[k]->color);
    color *= glm::sqrt(glm::max(tint, 0.0f) / 65535.0f);
    if (!image_) return color;
    glm::vec2 uv(0);
    for (int k = 0; k < 3; ++k) uv += weights[k] * (map_.uv_set == 1 ? v[k]->uv1 : v[k]->uv0);
    const glm::vec2 scaled = uv * map_.scale;
    const std::uint32_t x = wrapped(turn_.x * scaled.x + turn_.y * scaled.y + map_.offset.x,
                                    image_->width, map_.wrap_s);
    const std::uint32_t y = wrapped(-turn_.y * scaled.x + turn_.x * scaled.y + map_.offset.y,
                                    image_->height, map_.wrap_t);
    const std::uint8_t* texel = &image_->rgba[(std::size_t{y} * image_->width + x) * 4];
    return color * glm::vec3(texel[0], texel[1], texel[2]) / 255.0f;
  }

 private:
  const TextureRef& map_;
  const Image* image_;
  glm::vec3 factor_;
  glm::vec2 turn_;
};

struct Canvas {
  std::uint32_t edge;
  MeshPictures::Picture& pixels;
  std::vector<float> nearest;  // larger is nearer
};

// Fills a triangle on the canvas; `at`: its corners in pixels, and their nearness.
template <typename Shade>
void fill(Canvas& canvas, const glm::vec3 (&at)[3], const Shade& shade) {
  const auto low = [&](int axis) {
    const float least = std::min({at[0][axis], at[1][axis], at[2][axis]});
    return static_cast<int>(std::max(std::ceil(least - 0.5f), 0.0f));
  };
  const auto high = [&](int axis) {
    const float most = std::max({at[0][axis], at[1][axis], at[2][axis]});
    return static_cast<int>(std::min(std::floor(most - 0.5f), static_cast<float>(canvas.edge) - 1));
  };
  const int x0 = low(0), x1 = high(0), y0 = low(1), y1 = high(1);
  if (x0 > x1 || y0 > y1) return;
  const auto side = [](const glm::vec3& a, const glm::vec3& b, float x, float y) {
    return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
  };
  const float area = side(at[0], at[1], at[2].x, at[2].y);
  if (area == 0) return;
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      const float px = static_cast<float>(x) + 0.5f, py = static_cast<float>(y) + 0.5f;
      const glm::vec3 w = glm::vec3(side(at[1], at[2], px, py), side(at[2], at[0], px, py),
                                    side(at[0], at[1], px, py)) /
                          area;
      if (w.x < 0 || w.y < 0 || w.z < 0) continue;
      const float z = w.x * at[0].z + w.y * at[1].z + w.z * at[2].z;
      const std::size_t i = static_cast<std::size_t>(y) * canvas.edge + static_cast<std::size_t>(x);
      if (z <= canvas.nearest[i]) continue;
      canvas.nearest[i] = z;
      shade(canvas.pixels[i], w);
    }
  }
}

glm::vec3 grain_of(const Vertex* const (&v)[3], const glm::vec3& weights) {
  glm::vec3 sum(0);
  for (int k = 0; k < 3; ++k) sum += weights[k] * glm::vec3(v[k]->tangent);
  const float length = glm::length(sum);
  return length > 1e-6f ? sum / length : glm::vec3(0);
}

void draw(const Mesh& mesh, const std::vector<Material>& materials,
          const std::vector<Image>& images, const MeshPictures::Frame& frame,
          const glm::mat3& rotation, Canvas& canvas) {
  const float per_unit = static_cast<float>(frame.edge) / frame.extent;
  const glm::vec3 middle(0.5f * static_cast<float>(frame.edge),
                         0.5f * static_cast<float>(frame.edge), 0);
  std::vector<glm::vec3> places;
  places.reserve(mesh.vertices.size());
  for (const Vertex& v : mesh.vertices) {
    places.push_back(middle + rotation * (v.position - frame.center) * per_unit);
  }
  for (const Primitive& p : mesh.primitives) {
    if (p.kind != PrimitiveKind::kTriangles) continue;
    const Material& material = materials[p.material];
    const Paint paint(material, images);
    for (std::uint32_t i = 0; i + 2 < p.index_count; i += 3) {
      const std::uint32_t* corner = &mesh.indices[p.first_index + i];
      const glm::vec3 at[3] = {places[corner[0]], places[corner[1]], places[corner[2]]};
      const float turn =
          (at[1].x - at[0].x) * (at[2].y - at[0].y) - (at[1].y - at[0].y) * (at[2].x - at[0].x);
      if (turn <= 0 && !material.double_sided) continue;
      const Vertex* v[3];
      for (std::size_t k = 0; k < 3; ++k) v[k] = &mesh.vertices[corner[k]];
      fill(canvas, at, [&](MeshPictures::Pixel& pixel, const glm::vec3& w) {
        const glm::vec3 sum = w.x * v[0]->normal + w.y * v[1]->normal + w.z * v[2]->normal;
        const float length = glm::length(sum);
        pixel.normal = length > 1e-6f ? sum / (turn < 0 ? -length : length) : glm::vec3(0);
        pixel.color = paint.at(v, w);
        pixel.grain = material.lobes.anisotropy > 0 ? grain_of(v, w) : glm::vec3(0);
        pixel.cover = 1;
      });
    }
  }
}

// Sums each 2 x 2 pixels into one.
MeshPictures::Picture halved(const MeshPictures::Picture& in, std::uint32_t edge) {
  const std::uint32_t half = edge / 2;
  MeshPictures::Picture out(std::size_t{half} * half);
  for (std::uint32_t y = 0; y < edge; ++y) {
    for (std::uint32_t x = 0; x < edge; ++x) {
      const MeshPictures::Pixel& from = in[std::size_t{y} * edge + x];
      MeshPictures::Pixel& to = out[std::size_t{y / 2} * half + x / 2];
      to.normal += 0.25f * from.normal;
      to.color += 0.25f * from.color;
      to.grain += 0.25f * from.grain;
      to.cover += 0.25f * from.cover;
    }
  }
  return out;
}

struct Difference {
  double sum = 0;
  std::size_t pixels = 0;
};

void add_difference(const MeshPictures::Picture& a, const MeshPictures::Picture& b,
                    Difference& out) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i].cover < kWhole || b[i].cover < kWhole) continue;
    const glm::vec3 normal = kNormalWeight * (a[i].normal - b[i].normal);
    const glm::vec3 color = a[i].color - b[i].color;
    const glm::vec3 grain = kNormalWeight * (a[i].grain - b[i].grain);
    out.sum += double{glm::dot(normal, normal)} + double{glm::dot(color, color)} / 3;
    out.sum += double{glm::dot(grain, grain)};
    ++out.pixels;
  }
}

}  // namespace

MeshPictures::Frame MeshPictures::frame_around(const Mesh& mesh) {
  glm::vec3 low(INFINITY), high(-INFINITY);
  std::size_t triangles = 0;
  for (const Primitive& p : mesh.primitives) {
    if (p.kind != PrimitiveKind::kTriangles) continue;
    triangles += p.index_count / 3;
    for (std::uint32_t i = 0; i < p.index_count; ++i) {
      const glm::vec3& at = mesh.vertices[mesh.indices[p.first_index + i]].position;
      low = glm::min(low, at);
      high = glm::max(high, at);
    }
  }
  Frame frame;
  if (triangles == 0) return frame;
  frame.center = 0.5f * (low + high);
  frame.extent = kMargin * glm::length(high - low);
  const double wanted = std::sqrt(kPixelsPerTriangle * static_cast<double>(triangles));
  frame.edge = kLeastEdge;
  while (frame.edge < kMostEdge && frame.edge < wanted) frame.edge *= 2;
  return frame;
}

MeshPictures::MeshPictures(const Mesh& mesh, const std::vector<Material>& materials,
                           const std::vector<Image>& images, const Frame& frame,
                           const Workers& workers)
    : frame_(frame) {
  static const std::array<glm::mat3, kSides> kRotations = view_rotations();
  if (!(frame.extent > 0)) return;
  workers.each(kSides, [&](std::size_t i) {
    const std::size_t pixels = std::size_t{frame.edge} * frame.edge;
    sides_[i].resize(pixels);
    Canvas canvas{frame.edge, sides_[i], std::vector<float>(pixels, -INFINITY)};
    draw(mesh, materials, images, frame, kRotations[i], canvas);
  });
}

float shading_size(const MeshPictures& full, const MeshPictures& level) {
  const MeshPictures::Frame& frame = full.frame();
  if (!(frame.extent > 0)) return 0;
  std::array<MeshPictures::Picture, MeshPictures::kSides> a = full.sides(), b = level.sides();
  float size = 0;
  for (std::uint32_t edge = frame.edge; edge >= kCoarsestEdge; edge /= 2) {
    Difference difference;
    for (std::size_t i = 0; i < a.size(); ++i) add_difference(a[i], b[i], difference);
    if (difference.sum <= kSameShading * kSameShading * static_cast<double>(difference.pixels)) {
      return size;
    }
    const auto half = edge / 2;
    size = frame.extent / static_cast<float>(half);
    for (std::size_t i = 0; i < a.size(); ++i) {
      a[i] = halved(a[i], edge);
      b[i] = halved(b[i], edge);
    }
  }
  return size;
}

}  // namespace mirage
