#pragma once
// The descriptions of objects and images that are sent to clients.

#include <map>

#include "protocol/codec/image_codec.h"
#include "protocol/impostor/object_proxy.h"
#include "server/base/workers.h"
#include "server/scene/scene.h"

namespace mirage {

struct MeasuredMotion;

/// Returns the colour and alpha of each material of `mesh`: base colour x texture mean, plus
/// emission; linear.
std::map<std::uint32_t, glm::vec4> material_colors(const Mesh& mesh, const Scene& scene);
/// Returns the mean of these x vertex colours, 0 to 1, weighted by area and opacity. Its alpha is
/// the mean opacity: alpha where a material blends, else 1.
glm::vec4 mean_color(const Mesh& mesh, const std::map<std::uint32_t, glm::vec4>& of_material,
                     const std::vector<Material>& materials);

/// Returns bounds, hull, mean colour and needs of one object.
ObjectDescription describe_object(const SceneObject& object, const Scene& scene,
                                  const Workers& workers = Workers());
/// Replaces the bounds of the bind pose by those of all poses.
void use_motion(const MeasuredMotion& measured, ObjectDescription& description);

/// Returns size, mean colour and alpha test of one of the scene's images.
ImageDescription describe_image(const Scene& scene, std::size_t index);

}  // namespace mirage
