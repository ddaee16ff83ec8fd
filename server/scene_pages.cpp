#include "server/scene_pages.h"

#include <algorithm>

#include "protocol/limits.h"
#include "protocol/message.h"

namespace mirage {
namespace {

void add_image_pages(const PreparedScene& scene, std::vector<FramePtr>& pages) {
  const std::vector<ImageDescription>& images = scene.images;
  for (std::size_t first = 0; first < images.size(); first += limits::kImagesPerPage) {
    wire::ImagePageT page;
    page.first = static_cast<std::uint32_t>(first);
    const std::size_t end = std::min(first + limits::kImagesPerPage, images.size());
    for (std::size_t i = first; i < end; ++i) {
      const ImageDescription& image = images[i];
      std::uint32_t mean = 0;
      for (std::size_t c = 0; c < 4; ++c) mean |= std::uint32_t{image.mean[c]} << (8 * c);
      page.images.emplace_back(static_cast<std::uint16_t>(image.width),
                               static_cast<std::uint16_t>(image.height), mean, image.alpha_cutoff,
                               image.srgb);
    }
    pages.push_back(std::make_shared<const Bytes>(encode_message(std::move(page))));
  }
}

std::unique_ptr<wire::ObjectInfoT> object_info(const ObjectDescription& o) {
  auto info = std::make_unique<wire::ObjectInfoT>();
  info->center = std::make_unique<wire::Vec3f>(to_wire(o.center));
  info->radius = o.radius;
  info->box_min = std::make_unique<wire::Vec3f>(to_wire(o.box_min));
  info->box_max = std::make_unique<wire::Vec3f>(to_wire(o.box_max));
  info->mean_color = std::make_unique<wire::Vec3f>(to_wire(o.mean_color));
  info->needs = o.needs;
  info->triangles = o.triangles;
  info->surrounds = o.surrounds;
  info->group = o.group;
  for (const LodInfo& lod : o.lods) {
    info->lods.emplace_back(lod.triangles, lod.bytes, lod.error, lod.spread);
  }
  for (const glm::vec3& v : o.hull.vertices) info->hull_vertices.push_back(to_wire(v));
  info->hull_indices = o.hull.indices;
  info->clip_s = o.motion.clip_s;
  info->speed = o.motion.speed;
  info->jump = o.motion.jump;
  info->wrap_jump = o.motion.wrap_jump;
  info->hull_parallax = o.hull.parallax;
  return info;
}

void add_object_pages(const PreparedScene& scene, std::vector<FramePtr>& pages) {
  const std::vector<ObjectDescription>& objects = scene.objects;
  for (std::size_t first = 0; first < objects.size(); first += limits::kObjectsPerPage) {
    wire::ObjectPageT page;
    page.first = static_cast<std::uint32_t>(first);
    const std::size_t end = std::min(first + limits::kObjectsPerPage, objects.size());
    for (std::size_t i = first; i < end; ++i) {
      page.objects.push_back(object_info(objects[i]));
    }
    pages.push_back(std::make_shared<const Bytes>(encode_message(std::move(page))));
  }
}

void add_instance_pages(const PreparedScene& scene, std::vector<FramePtr>& pages) {
  const std::size_t instances = scene.instance_count();
  for (std::size_t first = 0; first < instances; first += limits::kInstancesPerPage) {
    wire::InstancePageT page;
    page.first = static_cast<std::uint32_t>(first);
    const std::size_t end = std::min(first + limits::kInstancesPerPage, instances);
    for (std::size_t i = first; i < end; ++i) {
      const Instance instance = scene.instance(i);
      const Similarity& m = instance.world_from_object;
      page.instances.emplace_back(to_wire(m.position), to_wire(m.rotation), m.scale,
                                  instance.object, scene.parent(i), instance.clip_offset_s,
                                  static_cast<std::uint8_t>(instance.importance));
    }
    pages.push_back(std::make_shared<const Bytes>(encode_message(std::move(page))));
  }
}

}  // namespace

std::vector<FramePtr> make_scene_pages(const PreparedScene& scene) {
  std::vector<FramePtr> pages;
  add_image_pages(scene, pages);
  add_object_pages(scene, pages);
  add_instance_pages(scene, pages);
  return pages;
}

}  // namespace mirage
