#include "server/lod/lod_shading.h"

#include <algorithm>
#include <glm/gtc/quaternion.hpp>
#include <utility>

namespace mirage {
namespace {

// in mean light, a turn of a normal or grain shows at half its size
constexpr float kNormalWeight = 0.5f;
// Halvings between the picture drawn of a level and the first that is compared: 4 x 4 pixels give
// a mean.
constexpr std::size_t kFiner = 2;
constexpr float kWhole = 0.99f;  // less cover is an edge, which MeshLod::error covers

/// Returns the view from a side, along an axis of a tilted frame, so that few faces are seen
/// exactly edge-on.
glm::mat3 rotation_of(std::size_t side) {
  const glm::mat3 askew = glm::mat3_cast(glm::normalize(glm::quat(0.93f, 0.21f, 0.27f, 0.13f)));
  const int axis = static_cast<int>(side % 3);
  const float sign = side < 3 ? 1.0f : -1.0f;
  glm::vec3 right(0), up(0), toward(0);
  toward[axis] = sign;
  right[(axis + 1) % 3] = sign;
  up[(axis + 2) % 3] = 1;
  return glm::transpose(glm::mat3(right, up, toward)) * askew;
}

bool has_grain(const Mesh& mesh, const std::vector<Material>& materials) {
  return std::any_of(mesh.primitives.begin(), mesh.primitives.end(), [&](const Primitive& p) {
    return materials[p.material].lobes.anisotropy > 0;
  });
}

struct Difference {
  double sum = 0;
  std::size_t pixels = 0;
};

Difference difference_of(const MeshPicture& a, const MeshPicture& b) {
  Difference out;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    const PicturePixel &p = a.pixels[i], &q = b.pixels[i];
    if (p.cover < kWhole || q.cover < kWhole) continue;
    const glm::vec3 normal = kNormalWeight * (p.normal - q.normal), color = p.color - q.color;
    out.sum += double{glm::dot(normal, normal)} + double{glm::dot(color, color)} / 3;
    ++out.pixels;
    if (a.grain.empty()) continue;
    const glm::vec3 grain = kNormalWeight * (a.grain[i] - b.grain[i]);
    out.sum += double{glm::dot(grain, grain)};
  }
  return out;
}

}  // namespace

MeshShading::MeshShading(const Mesh& full, const std::vector<Material>& materials,
                         const std::vector<Image>& images, const Workers& workers)
    : materials_(materials),
      images_(images),
      workers_(workers),
      frame_(frame_around(full)),
      grained_(has_grain(full, materials)) {
  if (!(frame_.extent > 0)) return;
  workers_.each(kSides, [&](std::size_t side) {
    MeshPicture& picture = sides_[side].full.emplace_back();
    picture.window = window_around(full, frame_, rotation_of(side));
    draw(full, side, 0, picture);
  });
}

void MeshShading::draw(const Mesh& mesh, std::size_t side, std::size_t halvings,
                       MeshPicture& out) const {
  PictureFrame frame = frame_;
  frame.edge >>= halvings;
  draw_picture(mesh, materials_, images_, frame, rotation_of(side), grained_, out);
}

float MeshShading::size_of(const Mesh& level) {
  if (!(frame_.extent > 0)) return 0;
  const std::size_t drawn = same_at_ - std::min(same_at_, kFiner);
  for (std::size_t at = drawn; (frame_.edge >> at) >= kCoarsestEdge; ++at) {
    std::array<Difference, kSides> differences;
    workers_.each(kSides, [&](std::size_t i) {
      Side& side = sides_[i];
      if (at == drawn) {
        side.level[0].window = side.full[drawn].window;
        draw(level, i, drawn, side.level[0]);
      } else {
        halve(side.level[0], side.level[1]);
        std::swap(side.level[0], side.level[1]);
      }
      if (side.full.size() == at) {
        MeshPicture half;
        halve(side.full.back(), half);
        side.full.push_back(std::move(half));
      }
      if (at >= same_at_) differences[i] = difference_of(side.full[at], side.level[0]);
    });
    if (at < same_at_) continue;
    Difference all;
    for (const Difference& one : differences) {
      all.sum += one.sum;
      all.pixels += one.pixels;
    }
    same_at_ = at;
    if (all.sum <= kSameShading * kSameShading * static_cast<double>(all.pixels)) {
      return at == 0 ? 0 : frame_.extent / static_cast<float>(frame_.edge >> at);
    }
  }
  return frame_.extent / (0.5f * static_cast<float>(kCoarsestEdge));
}

}  // namespace mirage
