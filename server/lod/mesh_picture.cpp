#include "server/lod/mesh_picture.h"

#include <algorithm>
#include <cmath>

namespace mirage {
namespace {

constexpr std::uint32_t kLeastEdge = 32, kMostEdge = 256;
constexpr double kPixelsPerTriangle = 2;  // per side of a picture
constexpr float kMargin = 1.02f;

std::uint32_t wrapped(float v, std::uint32_t size, Wrap wrap) {
  const auto n = static_cast<float>(size);
  float at = std::isfinite(v) ? v : 0.0f;
  if (wrap == Wrap::kClamp) at = std::clamp(at, 0.0f, 1.0f);
  if (wrap == Wrap::kMirror) at = 1 - std::abs(1 - (at - 2 * std::floor(0.5f * at)));
  if (wrap == Wrap::kRepeat) at -= std::floor(at);
  return static_cast<std::uint32_t>(std::clamp(at * n, 0.0f, n - 1));
}

bool white(const Vertex& v) {
  return v.color.x == 65535 && v.color.y == 65535 && v.color.z == 65535;
}

/// The base colour of one primitive.
class Paint {
 public:
  Paint(const Material& material, const std::vector<Image>& images)
      : map_(material.base_color_map),
        image_(map_.present() ? &images[static_cast<std::size_t>(map_.image)] : nullptr),
        factor_(glm::sqrt(glm::vec3(material.base_color))),
        turn_(std::cos(map_.rotation), std::sin(map_.rotation)) {}

  /// Prepares for a triangle with these corners.
  void take(const Vertex* const (&v)[3]) {
    tinted_ = !white(*v[0]) || !white(*v[1]) || !white(*v[2]);
  }

  glm::vec3 at(const Vertex* const (&v)[3], const glm::vec3& weights) const {
    glm::vec3 color = factor_;
    if (tinted_) {
      glm::vec3 tint(0);
      for (int k = 0; k < 3; ++k) tint += weights[k] * glm::vec3(v[k]->color);
      color *= glm::sqrt(glm::max(tint, 0.0f) / 65535.0f);
    }
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
  bool tinted_ = true;
};

/// The pixels whose middles an interval may cover, limited to a window.
struct Span {
  int first, last;

  Span(float low, float high, std::uint32_t begin, std::uint32_t count)
      : first(static_cast<int>(std::max(std::ceil(low - 0.5f), static_cast<float>(begin)))),
        last(static_cast<int>(
            std::min(std::floor(high - 0.5f), static_cast<float>(begin + count) - 1))) {}
};

// Fills a triangle on the picture; `at`: its corners in pixels, and their nearness.
template <typename Shade>
void fill(MeshPicture& picture, const glm::vec3 (&at)[3], const Shade& shade) {
  const PictureWindow& window = picture.window;
  const auto [x_low, x_high] = std::minmax({at[0].x, at[1].x, at[2].x});
  const auto [y_low, y_high] = std::minmax({at[0].y, at[1].y, at[2].y});
  const Span xs(x_low, x_high, window.x, window.width), ys(y_low, y_high, window.y, window.height);
  if (xs.first > xs.last || ys.first > ys.last) return;
  const auto side = [](const glm::vec3& a, const glm::vec3& b, float x, float y) {
    return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
  };
  const float area = side(at[0], at[1], at[2].x, at[2].y);
  if (area == 0) return;
  for (int y = ys.first; y <= ys.last; ++y) {
    for (int x = xs.first; x <= xs.last; ++x) {
      const float px = static_cast<float>(x) + 0.5f, py = static_cast<float>(y) + 0.5f;
      const glm::vec3 w = glm::vec3(side(at[1], at[2], px, py), side(at[2], at[0], px, py),
                                    side(at[0], at[1], px, py)) /
                          area;
      if (w.x < 0 || w.y < 0 || w.z < 0) continue;
      const float z = w.x * at[0].z + w.y * at[1].z + w.z * at[2].z;
      const std::size_t i = (static_cast<std::size_t>(y) - window.y) * window.width +
                            (static_cast<std::size_t>(x) - window.x);
      if (z <= picture.pixels[i].near) continue;
      picture.pixels[i].near = z;
      shade(i, w);
    }
  }
}

glm::vec3 grain_of(const Vertex* const (&v)[3], const glm::vec3& weights) {
  glm::vec3 sum(0);
  for (int k = 0; k < 3; ++k) sum += weights[k] * glm::vec3(v[k]->tangent);
  const float length = glm::length(sum);
  return length > 1e-6f ? sum / length : glm::vec3(0);
}

/// Places positions on a picture, px; the third coordinate is nearness.
class Placement {
 public:
  Placement(const PictureFrame& frame, const glm::mat3& rotation)
      : turn_(rotation * (static_cast<float>(frame.edge) / frame.extent)),
        center_(frame.center),
        middle_(0.5f * static_cast<float>(frame.edge), 0.5f * static_cast<float>(frame.edge), 0) {}

  glm::vec3 of(const Vertex& v) const { return middle_ + turn_ * (v.position - center_); }

 private:
  const glm::mat3 turn_;
  const glm::vec3 center_, middle_;
};

template <typename Use>
void each_corner(const Mesh& mesh, const Use& use) {
  for (const Primitive& p : mesh.primitives) {
    if (p.kind != PrimitiveKind::kTriangles) continue;
    for (std::uint32_t i = 0; i < p.index_count; ++i) {
      use(mesh.vertices[mesh.indices[p.first_index + i]]);
    }
  }
}

}  // namespace

PictureFrame frame_around(const Mesh& mesh) {
  glm::vec3 low(INFINITY), high(-INFINITY);
  std::size_t corners = 0;
  each_corner(mesh, [&](const Vertex& v) {
    low = glm::min(low, v.position);
    high = glm::max(high, v.position);
    ++corners;
  });
  PictureFrame frame;
  if (corners == 0) return frame;
  frame.center = 0.5f * (low + high);
  frame.extent = kMargin * glm::length(high - low);
  const std::size_t triangles = corners / 3;
  const double wanted = std::sqrt(kPixelsPerTriangle * static_cast<double>(triangles));
  frame.edge = kLeastEdge;
  while (frame.edge < kMostEdge && frame.edge < wanted) frame.edge *= 2;
  return frame;
}

PictureWindow window_around(const Mesh& mesh, const PictureFrame& frame,
                            const glm::mat3& rotation) {
  const Placement placement(frame, rotation);
  glm::vec2 low(INFINITY), high(-INFINITY);
  each_corner(mesh, [&](const Vertex& v) {
    const glm::vec2 at(placement.of(v));
    low = glm::min(low, at);
    high = glm::max(high, at);
  });
  const auto most = static_cast<float>(frame.edge);
  const std::uint32_t step = frame.edge / kCoarsestEdge;
  const auto down = [&](float v) {
    return static_cast<std::uint32_t>(std::clamp(v, 0.0f, most)) / step * step;
  };
  const auto up = [&](float v) {
    return (static_cast<std::uint32_t>(std::clamp(v, 0.0f, most)) + step) / step * step;
  };
  PictureWindow out{down(low.x), down(low.y), 0, 0};
  out.width = std::min(up(high.x), frame.edge) - out.x;
  out.height = std::min(up(high.y), frame.edge) - out.y;
  return out;
}

void draw_picture(const Mesh& mesh, const std::vector<Material>& materials,
                  const std::vector<Image>& images, const PictureFrame& frame,
                  const glm::mat3& rotation, bool with_grain, MeshPicture& out) {
  PicturePixel empty;
  empty.near = -INFINITY;
  out.pixels.assign(out.window.pixels(), empty);
  out.grain.assign(with_grain ? out.pixels.size() : 0, glm::vec3(0));
  const Placement placement(frame, rotation);
  std::vector<glm::vec3> places;
  places.reserve(mesh.vertices.size());
  for (const Vertex& v : mesh.vertices) places.push_back(placement.of(v));
  for (const Primitive& p : mesh.primitives) {
    if (p.kind != PrimitiveKind::kTriangles) continue;
    const Material& material = materials[p.material];
    const bool grained = with_grain && material.lobes.anisotropy > 0;
    Paint paint(material, images);
    for (std::uint32_t i = 0; i + 2 < p.index_count; i += 3) {
      const std::uint32_t* corner = &mesh.indices[p.first_index + i];
      const glm::vec3 at[3] = {places[corner[0]], places[corner[1]], places[corner[2]]};
      const float turn =
          (at[1].x - at[0].x) * (at[2].y - at[0].y) - (at[1].y - at[0].y) * (at[2].x - at[0].x);
      if (turn <= 0 && !material.double_sided) continue;
      const Vertex* const v[3] = {&mesh.vertices[corner[0]], &mesh.vertices[corner[1]],
                                  &mesh.vertices[corner[2]]};
      paint.take(v);
      fill(out, at, [&](std::size_t pixel, const glm::vec3& w) {
        const glm::vec3 sum = w.x * v[0]->normal + w.y * v[1]->normal + w.z * v[2]->normal;
        const float length = glm::length(sum);
        PicturePixel& to = out.pixels[pixel];
        to.normal = length > 1e-6f ? sum / (turn < 0 ? -length : length) : glm::vec3(0);
        to.color = paint.at(v, w);
        to.cover = 1;
        if (with_grain) out.grain[pixel] = grained ? grain_of(v, w) : glm::vec3(0);
      });
    }
  }
}

void halve(const MeshPicture& in, MeshPicture& out) {
  out.window = {in.window.x / 2, in.window.y / 2, in.window.width / 2, in.window.height / 2};
  out.pixels.assign(out.window.pixels(), PicturePixel{});
  out.grain.assign(in.grain.empty() ? 0 : out.pixels.size(), glm::vec3(0));
  for (std::uint32_t y = 0; y < in.window.height; ++y) {
    for (std::uint32_t x = 0; x < in.window.width; ++x) {
      const std::size_t from = std::size_t{y} * in.window.width + x;
      const PicturePixel& pixel = in.pixels[from];
      if (pixel.cover == 0) continue;
      const std::size_t to = std::size_t{y / 2} * out.window.width + x / 2;
      out.pixels[to].normal += 0.25f * pixel.normal;
      out.pixels[to].color += 0.25f * pixel.color;
      out.pixels[to].cover += 0.25f * pixel.cover;
      if (!in.grain.empty()) out.grain[to] += 0.25f * in.grain[from];
    }
  }
}

}  // namespace mirage
