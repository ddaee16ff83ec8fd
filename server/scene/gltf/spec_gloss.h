#pragma once
// Converts KHR_materials_pbrSpecularGlossiness to metallic-roughness, as in the extension's
// appendix: the metalness for which both describe the same diffuse and specular brightness.

#include <glm/glm.hpp>

#include "protocol/model/model.h"

namespace mirage::gltf {

/// Linear colours, 0..1.
struct SpecGloss {
  glm::vec4 diffuse{1};
  glm::vec3 specular{1};
  float glossiness = 1;
};

struct MetalRough {
  glm::vec3 base{1};  ///< linear
  float metallic = 0;
  float roughness = 0;
};

MetalRough metal_rough_of(const glm::vec3& diffuse, const glm::vec3& specular, float glossiness);

/// True if the material is not metallic, whatever its diffuse colour. Its base colour is then the
/// diffuse colour times a number.
bool never_metal(const glm::vec3& specular);

/// Images of a texel-by-texel conversion. They include the factors, except the alpha of `diffuse`.
struct MetalRoughImages {
  Image base;         ///< sRGB
  Image metal_rough;  ///< G roughness, B metallic
};

/// Converts `diffuse` (sRGB, alpha kept) and `specular_glossiness` (sRGB, glossiness in alpha);
/// nullptr stands for an image of ones. The results have the larger size of both; the smaller image
/// is interpolated.
MetalRoughImages convert_images(const Image* diffuse, const Image* specular_glossiness,
                                const SpecGloss& factors);

}  // namespace mirage::gltf
