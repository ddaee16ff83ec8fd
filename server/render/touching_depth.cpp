#include "server/render/touching_depth.h"

#include "server/prepare/prepared_scene.h"
#include "server/render/gpu_scene.h"

namespace mirage {
namespace {

// Returns the placement in a space of what `world_from_object` places in the world.
Similarity seen_from(const Similarity& world_from_space, const Similarity& world_from_object) {
  const glm::dquat back = glm::conjugate(glm::dquat(world_from_space.rotation));
  const double scale = world_from_space.scale;
  Similarity out;
  out.position = back * (world_from_object.position - world_from_space.position) / scale;
  out.rotation = glm::quat(back * glm::dquat(world_from_object.rotation));
  out.scale = static_cast<float>(world_from_object.scale / scale);
  return out;
}

}  // namespace

Result<void> TouchingDepth::warm_up() {
  const std::vector<Touching>& touching = scene_->prepared->touching;
  for (std::size_t object = 0; object < touching.size(); ++object) {
    gl::MeshPass& meshes = object < scene_->prepared->objects.size() ? pushed_ : ground_;
    for (const std::uint32_t i : touching[object].others) {
      const gl::GpuMesh& mesh = scene_->meshes[scene_->prepared->scene.instances[i].object];
      if (Result<void> made = meshes.warm_up(mesh, scene_->materials(), false); !made) return made;
    }
  }
  return {};
}

void TouchingDepth::push(const gl::RenderTarget& drawn, int width, const RowBand& rows,
                         const View& view, const std::vector<std::uint32_t>& instances) {
  const int low = static_cast<int>(rows.low), high = static_cast<int>(rows.high);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, drawn.framebuffer());
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, own_.framebuffer());
  glBlitFramebuffer(0, low, width, high, 0, low, width, high, GL_DEPTH_BUFFER_BIT, GL_NEAREST);
  drawn.bind();
  glViewport(0, 0, width, width);
  const DepthCode code(view.capture.radius, view.capture.distance);
  // Rounding to a code may bring the pushed depth half a step nearer.
  const double reach = view.capture.depth_slack(code.far_depth) + code.quantum();
  pushed_.set_clear_of(own_.depth(), static_cast<float>(code.near_depth),
                       static_cast<float>(code.far_depth), static_cast<float>(reach));
  draw_with(pushed_, view, instances);
}

void TouchingDepth::draw_ground(const View& view, const std::vector<std::uint32_t>& instances) {
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  glDisable(GL_DEPTH_CLAMP);  // what is before the capture's near plane hides nothing
  draw_with(ground_, view, instances);
  glEnable(GL_DEPTH_CLAMP);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

void TouchingDepth::draw_with(gl::MeshPass& meshes, const View& view,
                              const std::vector<std::uint32_t>& instances) {
  meshes.begin(view.clip_from_relative, {});
  for (const std::uint32_t i : instances) {
    const Instance& other = scene_->prepared->scene.instances[i];
    const Similarity at = seen_from(view.world_from_space, other.world_from_object);
    const gl::MeshInstance instance = gl::mesh_instance(at, view.eye, i);
    meshes.draw(scene_->mesh_for_group(other.object, at.scale, view.capture), scene_->materials(),
                scene_->images, &instance, 1, false);
  }
  meshes.end();
}

}  // namespace mirage
