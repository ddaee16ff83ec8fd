#include "server/session/scene_pages.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "protocol/base/limits.h"
#include "protocol/codec/image_codec.h"
#include "protocol/wire/conversions.h"
#include "server/prepare/grouping.h"
#include "server/prepare/prepared_scene.h"

namespace mirage {
namespace {

// Number of instances and groups sent after the welcome. It covers a whole scene of a few thousand
// instances (a tenth of a second at 20 Mbit/s). A larger scene begins with those that the home view
// needs, plus a margin.
constexpr std::size_t kToldAtOnce = 3000;
constexpr double kHomeMargin = 1.5;
// Instances and groups per page, unless a group has more members. A page has 20 KB, so the nearest
// groups can be asked for while the rest is still arriving.
constexpr std::size_t kRecordsPerPage = 256;

void add_image_pages(const PreparedScene& scene, std::vector<PacketPtr>& pages) {
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
  info->opacity = o.opacity;
  info->name = o.name;
  info->faces_sine = o.faces.sine;
  if (o.faces.sine < 1) info->faces_axis = std::make_unique<wire::Vec3f>(to_wire(o.faces.axis));
  info->needs = o.needs;
  info->triangles = o.triangles;
  info->surrounds = o.surrounds;
  for (const LodInfo& lod : o.lods) {
    info->lods.emplace_back(lod.triangles, lod.bytes, lod.error, lod.spread, lod.shading);
  }
  for (const glm::vec3& v : o.hull.vertices) info->hull_vertices.push_back(to_wire(v));
  info->hull_indices = o.hull.indices;
  info->clip_s = o.motion.clip_s;
  info->speed = o.motion.speed;
  info->jump = o.motion.jump;
  info->wrap_jump = o.motion.wrap_jump;
  info->hidden = o.motion.hidden;
  info->track_clip_s = o.track.clip_s;
  for (const glm::vec3& place : o.track.places) info->track.push_back(to_wire(place));
  info->hull_parallax = o.hull.parallax;
  info->cut = o.cut;
  return info;
}

void add_object_pages(const PreparedScene& scene, std::vector<PacketPtr>& pages) {
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

// Returns the opening for the home view, with a margin around it.
Opening home_opening(const PreparedScene& scene) {
  Opening opening;
  opening.eye = scene.scene.home.eye;
  opening.forward = scene.scene.home.target - scene.scene.home.eye;
  opening.rule.margin = kHomeMargin;
  opening.least = kToldAtOnce;
  return opening;
}

Opening opening_of(const wire::OpenRequestT& request) {
  Opening opening;
  opening.eye = from_wire(*request.eye);
  opening.forward = from_wire(*request.forward);
  opening.rule = {request.focal_px, request.tau_px, request.speed_mps, request.margin};
  return opening;
}

// Returns the cut instances among `asked`, each once. A client that asks for parts needs them.
std::deque<std::uint32_t> cut_instances(const PreparedScene& scene,
                                        const std::vector<std::uint32_t>& asked) {
  std::set<std::uint32_t> seen;
  std::deque<std::uint32_t> out;
  for (const std::uint32_t id : asked) {
    if (id < scene.instance_count() && scene.cut(id) && seen.insert(id).second) out.push_back(id);
  }
  return out;
}

}  // namespace

TreeTelling::TreeTelling(const PreparedScene& scene, const wire::OpenRequestT& request)
    : scene_(scene),
      opening_(scene, request.groups, opening_of(request)),
      cut_(cut_instances(scene, request.groups)) {
  page_.request_id = request.request_id;
}

TreeTelling::TreeTelling(const PreparedScene& scene)
    : scene_(scene),
      roots_(scene.grouping.roots.begin(), scene.grouping.roots.end()),
      opening_(scene, scene.grouping.roots, home_opening(scene)) {}

PacketPtr TreeTelling::next_page() {
  if (done_) return nullptr;
  while (!roots_.empty()) {
    if (!has_room(1)) return finish_page(false);
    add_record(roots_.front());
    roots_.pop_front();
  }
  for (;;) {
    if (!opened_) opened_ = opening_.next();
    if (!opened_ && !cut_.empty()) {
      opened_ = cut_.front();
      cut_.pop_front();
    }
    if (!opened_) break;
    const std::vector<std::uint32_t> members = scene_.members(*opened_);
    if (!has_room(members.size())) return finish_page(false);
    page_.opened.push_back(*opened_);
    for (const std::uint32_t member : members) add_record(member);
    opened_.reset();
  }
  done_ = true;
  return finish_page(true);
}

bool TreeTelling::has_room(std::size_t records) const {
  const std::size_t here = page_.instances.size() + page_.groups.size();
  return here == 0 || (here + records <= kRecordsPerPage && page_.opened.size() < kRecordsPerPage);
}

PacketPtr TreeTelling::finish_page(bool last) {
  const std::uint32_t request = page_.request_id;
  page_.last = last;
  PacketPtr out = std::make_shared<const Bytes>(encode_message(std::move(page_)));
  page_ = {};
  page_.request_id = request;
  return out;
}

void TreeTelling::add_record(std::uint32_t id) {
  const std::uint32_t parent = scene_.parent(id);
  if (const InstanceGroup* group = scene_.group_of_instance(id)) {
    const GroupBounds& b = group->bounds;
    std::uint32_t mean = 0;
    for (int c = 0; c < 3; ++c) {
      mean |= static_cast<std::uint32_t>(std::lround(b.mean_color[c] * 255.0f)) << (8 * c);
    }
    page_.groups.emplace_back(to_wire(b.center), to_wire(b.half), mean, b.needs, id, parent,
                              group->first_leaf, group->leaves,
                              static_cast<std::uint8_t>(group->importance));
    return;
  }
  const Instance& instance = scene_.scene.instances[id];
  const Similarity& m = instance.world_from_object;
  page_.instances.emplace_back(to_wire(m.position), to_wire(m.rotation), m.scale, id,
                               instance.object, parent, instance.clip_offset_s,
                               static_cast<std::uint8_t>(instance.importance));
}

std::vector<PacketPtr> make_scene_pages(const PreparedScene& scene) {
  std::vector<PacketPtr> pages;
  add_image_pages(scene, pages);
  add_object_pages(scene, pages);
  TreeTelling tree(scene);
  while (PacketPtr page = tree.next_page()) pages.push_back(std::move(page));
  return pages;
}

}  // namespace mirage
