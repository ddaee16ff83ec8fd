#include "server/bake/bake_error.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "protocol/quality/metrics.h"
#include "server/bake/encode.h"

namespace mirage {
namespace {

constexpr double kDegree = 0.017453292519943295;
constexpr float kPi = 3.14159265f;
constexpr float kBackground = 0.216f;  // linear; sRGB 128
constexpr int kTruthSamples = 4, kBakeSamples = 2;

// Returns direction i of n: evenly over the upper half of the sphere from 5 degrees up, as the
// field's protocol has them, or over the whole sphere. `offset` turns them about the axis.
glm::dvec3 view_direction(BakeLayout layout, int i, int n, int offset) {
  const double low = layout == BakeLayout::kHemi ? std::sin(5 * kDegree) : -1;
  const double y = layout == BakeLayout::kRing ? 0 : low + (1 - low) * (i + 0.5) / n;
  const double azimuth = 2.399963 * i + 1.7 * offset, ring = std::sqrt(1 - y * y);
  return {ring * std::cos(azimuth), y, ring * std::sin(azimuth)};
}

double nearest_frame_deg(const BakeMaster& master, const glm::dvec3& direction) {
  const FrameBlend blend = frame_blend(master.layout, master.grid, direction);
  double most = -1;
  for (const glm::ivec2& at : blend.frame) {
    most = std::max(most, glm::dot(direction, master.basis(at.x, at.y).toward));
  }
  return std::acos(std::clamp(most, -1.0, 1.0)) / kDegree;
}

std::vector<std::uint8_t> shaded(const std::vector<glm::vec4>& color,
                                 const std::vector<glm::vec3>& normal) {
  const glm::vec3 sun = glm::normalize(glm::vec3(2, 3, 1));
  std::vector<std::uint8_t> out;
  out.reserve(4 * color.size());
  for (std::size_t i = 0; i < color.size(); ++i) {
    const float light = (0.6f + 2.5f * std::max(0.0f, glm::dot(normal[i], sun))) / kPi;
    const glm::vec3 shown = glm::vec3(color[i]) * light + (1 - color[i].a) * kBackground;
    for (int c = 0; c < 3; ++c) {
      out.push_back(std::uint8_t(std::lround(255 * srgb_of(std::clamp(shown[c], 0.0f, 1.0f)))));
    }
    out.push_back(std::uint8_t(std::lround(255 * std::clamp(color[i].a, 0.0f, 1.0f))));
  }
  return out;
}

Result<std::vector<std::uint8_t>> truth(BakeRenderer& renderer, const BakeSubject& subject,
                                        const BakeMaster& master, const BakeCamera& camera,
                                        int edge) {
  const double r = master.radius, d = camera.radii * r, near = std::max(d - r, 1e-3 * r);
  const double half = camera.half_tangent() * near;
  const FrameBasis axes = camera.basis();
  const glm::dmat4 view = glm::transpose(glm::dmat4(glm::dmat3(axes.right, axes.up, axes.toward)));
  const glm::mat4 clip(glm::frustum(-half, half, -half, half, near, d + r) * view);
  const Result<BakeRenderer::Picture> picture =
      renderer.draw(subject, clip, master.center + camera.direction * d, edge, kTruthSamples);
  if (!picture) return picture.error();
  return shaded(picture->color, picture->normal);
}

}  // namespace

Result<std::vector<BakeErrorRow>> measure_bake(BakeRenderer& renderer, const BakeSubject& subject,
                                               const BakeMaster& master, const ErrorEffort& effort,
                                               const Workers& workers) {
  struct Sums {
    MeasureMean psnr, ssim, iou;
  };
  const auto edge = static_cast<std::uint32_t>(effort.edge);
  std::vector<BakeErrorRow> rows;
  for (const double radii : effort.radii) {
    std::vector<Sums> sums(effort.methods.size());
    double angle = 0;
    for (int i = 0; i < effort.directions; ++i) {
      const BakeCamera camera{view_direction(master.layout, i, effort.directions, effort.offset),
                              radii};
      angle += nearest_frame_deg(master, camera.direction) / effort.directions;
      const Result<std::vector<std::uint8_t>> due =
          truth(renderer, subject, master, camera, effort.edge);
      if (!due) return due.error();
      for (std::size_t m = 0; m < effort.methods.size(); ++m) {
        const BakePicture drawn =
            draw_bake(master, camera, effort.methods[m], effort.edge, kBakeSamples, workers);
        const std::vector<std::uint8_t> shown = shaded(drawn.color, drawn.normal);
        const FieldFidelity f =
            field_fidelity({edge, edge, due->data()}, {edge, edge, shown.data()});
        sums[m].psnr.add(f.psnr_db);
        sums[m].ssim.add(f.ssim);
        sums[m].iou.add(f.iou);
      }
    }
    for (std::size_t m = 0; m < effort.methods.size(); ++m) {
      rows.push_back({effort.methods[m], radii, angle, sums[m].psnr.mean(), sums[m].ssim.mean(),
                      sums[m].iou.mean()});
    }
  }
  return rows;
}

}  // namespace mirage
