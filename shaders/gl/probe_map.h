#pragma once
// A light probe on the GPU: its reflections as a texture, its irradiance as uniforms.

#include <vector>

#include "protocol/impostor/light_probe.h"
#include "protocol/model/scene_types.h"
#include "shaders/gl/gl_object.h"
#include "shaders/gl/program.h"

namespace mirage::gl {

class ProbeMap {
 public:
  /// Returns a probe without light, for shaders that always read one.
  static ProbeMap black();
  static ProbeMap create(const LightProbe& probe);

  /// Passes the probe to a program that includes common/probe.glsl, turned and scaled by `light`.
  /// If `light` names another probe, it passes no light.
  void use(Program& program, const ProbeLight& light) const;

  std::size_t gpu_bytes() const { return bytes_; }

 private:
  Texture texels_;
  std::uint64_t id_ = 0;
  std::vector<glm::vec4> irradiance_ = std::vector<glm::vec4>(kProbeTerms, glm::vec4(0));
  std::size_t bytes_ = 0;
};

}  // namespace mirage::gl
