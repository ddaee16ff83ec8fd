#include "client/price/frame_work.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "client/frame/draw_list.h"
#include "client/frame/drawn_mesh.h"
#include "client/frame/planned_frame.h"
#include "client/hold/tile_cache.h"
#include "client/scene/scene_view.h"
#include "protocol/impostor/camera.h"
#include "protocol/impostor/object_proxy.h"
#include "protocol/model/need_mask.h"

namespace mirage {
namespace {
constexpr double kDiscShare = 0.785398;  // area of a disc over that of the square around it
// Returns the number of different levels of geometry, however often each is drawn.
std::size_t levels_drawn(const SceneView& scene, const std::vector<DrawnMesh>& meshes) {
  std::set<std::pair<std::uint32_t, std::uint8_t>> levels;
  for (const DrawnMesh& mesh : meshes) {
    levels.emplace(scene.instances[mesh.instance].object, mesh.lod);
  }
  return levels.size();
}

}  // namespace

const char* work_name(Work kind) {
  switch (kind) {
    case Work::kFrame:
      return "frame";
    case Work::kPixel:
      return "pixel";
    case Work::kSample:
      return "sample";
    case Work::kMesh:
      return "mesh";
    case Work::kTriangle:
      return "triangle";
    case Work::kTestedTriangle:
      return "tested_triangle";
    case Work::kTestedTriangleSample:
      return "tested_triangle_sample";
    case Work::kMeshPixel:
      return "mesh_pixel";
    case Work::kTestedPixel:
      return "tested_pixel";
    case Work::kTestedSample:
      return "tested_sample";
    case Work::kFlatPixel:
      return "flat_pixel";
    case Work::kReliefPixel:
      return "relief_pixel";
    case Work::kImpostorSample:
      return "impostor_sample";
    case Work::kViewPixel:
      return "view_pixel";
    case Work::kCount:
      break;
  }
  return "";
}

FrameWork& FrameWork::operator+=(const FrameWork& other) {
  for (std::size_t i = 0; i < kWorks; ++i) amount[i] += other.amount[i];
  return *this;
}

double shown_area_px(const Camera& camera, const glm::dvec3& center, double radius) {
  const double w = camera.width, h = camera.height;
  const double distance2 = glm::dot(center, center), depth = glm::dot(center, camera.forward());
  if (!(radius > 0) || depth < -radius) return 0;
  if (!(distance2 > radius * radius) || depth <= radius) return w * h;
  const double focal = camera.focal_px();
  // The sphere is seen as an ellipse. `half` is half the edge of the square around a disc of the
  // same area.
  const double half = focal * radius * std::pow(distance2 - radius * radius, 0.25) /
                      std::pow(depth * depth - radius * radius, 0.75);
  const double x = 0.5 * w + focal * glm::dot(center, camera.right()) / depth;
  const double y = 0.5 * h + focal * glm::dot(center, camera.up()) / depth;
  const double across = std::min(w, x + half) - std::max(0.0, x - half);
  const double along = std::min(h, y + half) - std::max(0.0, y - half);
  return across > 0 && along > 0 ? kDiscShare * across * along : 0;
}

FrameWork target_work(const Camera& camera, int samples) {
  FrameWork work;
  const double pixels = static_cast<double>(camera.width) * camera.height;
  work[Work::kFrame] = 1;
  work[Work::kPixel] = pixels;
  work[Work::kSample] = pixels * (samples - 1);
  return work;
}

FrameWork mesh_work(const SceneView& scene, const Camera& camera, std::uint32_t instance,
                    std::size_t lod, int samples) {
  const InstanceView& view = scene.instances[instance];
  const ObjectDescription& object = scene.objects[view.object];
  const double area = shown_area_px(camera, view.center - camera.pose.eye, view.radius);
  const double triangles = lod < object.lods.size() ? object.lods[lod].triangles : 0;
  FrameWork work;
  if (object.needs & kNeedAlphaMask) {
    work[Work::kTestedTriangle] = triangles;
    work[Work::kTestedTriangleSample] = triangles * (samples - 1);
    work[Work::kTestedPixel] = area;
    work[Work::kTestedSample] = area * (samples - 1);
  } else {
    work[Work::kTriangle] = triangles;
    work[Work::kMeshPixel] = area;
  }
  return work;
}

FrameWork impostor_work(const SceneView& scene, const Camera& camera, std::uint32_t instance,
                        const TileRecord& tile, DrawMethod method, int samples) {
  const InstanceView& view = scene.instances[instance];
  const double edge = tile.capture.edge;
  // Share of the captured square that the crop fills on the screen.
  const double share = tile.crop.w * tile.crop.h / (edge * edge) / kDiscShare;
  const double area =
      std::min(share, 1.0) * shown_area_px(camera, view.center - camera.pose.eye, view.radius);
  FrameWork work;
  work[method == DrawMethod::kDepth ? Work::kReliefPixel : Work::kFlatPixel] = area;
  work[Work::kImpostorSample] = area * (samples - 1);
  return work;
}

FrameWork work_of(const PlannedFrame& frame, const Camera& drawn_camera, int samples) {
  const SceneView& scene = *frame.scene;
  const DrawList& list = frame.list;
  FrameWork work = target_work(drawn_camera, samples);
  for (const DrawnMesh& mesh : list.meshes) {
    work += mesh_work(scene, drawn_camera, mesh.instance, mesh.lod, samples);
  }
  work[Work::kMesh] = static_cast<double>(levels_drawn(scene, list.meshes));
  for (const DrawnImpostor& drawn : list.impostors) {
    work += impostor_work(scene, drawn_camera, drawn.instance, *drawn.tile, drawn.method, samples);
  }
  if (list.view) work[Work::kViewPixel] = work[Work::kPixel];
  return work;
}

}  // namespace mirage
