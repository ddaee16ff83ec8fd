#pragma once
// Told scene: a prepared scene as a client learns it, without a socket.

#include "protocol/wire/conversions.h"
#include "server/prepare/prepared_scene.h"
#include "server/session/scene_pages.h"
#include "tests/support/core_scene.h"

namespace mirage::test {

inline std::vector<PacketPtr> pages_of(TreeTelling telling) {
  std::vector<PacketPtr> out;
  while (PacketPtr page = telling.next_page()) out.push_back(std::move(page));
  return out;
}

inline Result<void> take(SceneView& scene, const std::vector<PacketPtr>& pages) {
  for (const PacketPtr& page : pages) {
    Message m = decode_message(page->data(), page->size()).take();
    Result<void> taken;
    if (const auto* images = m.body.AsImagePage()) taken = scene.accept(*images);
    if (const auto* objects = m.body.AsObjectPage()) taken = scene.accept(*objects);
    if (const auto* instances = m.body.AsInstancePage()) taken = scene.accept(*instances);
    if (!taken) return taken;
  }
  return {};
}

inline wire::WelcomeT welcome_of(const PreparedScene& prepared, bool geometry = false) {
  SceneOptions options;
  options.objects = static_cast<std::uint32_t>(prepared.objects.size());
  options.geometry = geometry;
  wire::WelcomeT welcome =
      make_welcome(prepared.scene.instances.size(), prepared.grouping.groups.size(),
                   prepared.grouping.roots.size(), options);
  welcome.images = static_cast<std::uint32_t>(prepared.images.size());
  welcome.bounds_center = std::make_unique<wire::Vec3d>(to_wire(prepared.bounds_center));
  welcome.bounds_radius = prepared.bounds_radius;
  return welcome;
}

/// Returns what a client knows before it asks for more.
inline SceneView as_told(const PreparedScene& prepared, bool geometry = false) {
  SceneView scene;
  EXPECT_TRUE(scene.accept(welcome_of(prepared, geometry)).ok());
  EXPECT_TRUE(take(scene, make_scene_pages(prepared)).ok());
  return scene;
}

}  // namespace mirage::test
