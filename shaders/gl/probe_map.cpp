#include "shaders/gl/probe_map.h"

#include <glm/gtc/quaternion.hpp>

namespace mirage::gl {
namespace {

constexpr int kProbeMapUnit = 8;  // after those of materials, atlases and the shadow map

Texture texture_of(int width, int height, const std::uint32_t* texels) {
  Texture out = Texture::create();
  glBindTexture(GL_TEXTURE_2D, out.id());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB9_E5, width, height, 0, GL_RGB, GL_UNSIGNED_INT_5_9_9_9_REV,
               texels);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  return out;
}

}  // namespace

ProbeMap ProbeMap::black() {
  const std::uint32_t nothing = 0;
  ProbeMap out;
  out.texels_ = texture_of(1, 1, &nothing);
  return out;
}

ProbeMap ProbeMap::create(const LightProbe& probe) {
  ProbeMap out;
  out.texels_ = texture_of(kProbeWidth, kProbeHeight, probe.texels.data());
  out.id_ = probe.id;
  for (std::size_t i = 0; i < kProbeTerms; ++i) {
    out.irradiance_[i] = glm::vec4(probe.irradiance[i], 0);
  }
  out.bytes_ = 4 * kProbeTexels;
  return out;
}

void ProbeMap::use(Program& program, const ProbeLight& light) const {
  const bool shines = light.id == id_ && light.shines();
  const glm::mat3 turn = glm::mat3_cast(shines ? light.rotation : glm::quat(1, 0, 0, 0));
  std::vector<glm::vec4> values;
  // The rotation to the probe's axes is the inverse: its rows are the columns of the rotation.
  for (int i = 0; i < 3; ++i) values.emplace_back(turn[i], 0);
  values[0].w = shines ? light.strength : 0.0f;
  values.insert(values.end(), irradiance_.begin(), irradiance_.end());
  program.set("u_probe_light", values);
  program.set("u_probe", kProbeMapUnit);
  glActiveTexture(GL_TEXTURE0 + kProbeMapUnit);
  glBindTexture(GL_TEXTURE_2D, texels_.id());
  glActiveTexture(GL_TEXTURE0);
}

}  // namespace mirage::gl
