#pragma once
// Draws meshes with the shared shading: the server's tiles and reference frames, the client's
// geometry. Shader variants are keyed by need mask, and compiled at first use or by warm_up().

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "protocol/base/result.h"
#include "protocol/impostor/lighting_state.h"
#include "shaders/gl/gpu_model.h"
#include "shaders/gl/probe_map.h"
#include "shaders/gl/program.h"
#include "shaders/gl/shadow_map.h"
#include "shaders/gl/view_depth.h"

namespace mirage::gl {

/// Per-instance vertex attributes of mesh.vert.
struct MeshInstance {
  glm::vec4 rotation{0, 0, 0, 1};        ///< xyzw
  glm::vec4 position_scale{0, 0, 0, 1};  ///< relative to the eye
  std::uint32_t id = 0;
  float fade = 1;  ///< share of the pixels drawn, by ordered dither
};

/// Returns an instance for a pass whose positions are relative to `eye`.
MeshInstance mesh_instance(const Similarity& world_from_object, const glm::dvec3& eye,
                           std::uint32_t id);

/// Lights in the shader's form, with positions relative to the eye.
struct LightBlock {
  glm::vec3 ambient{0};
  int count = 0;
  std::vector<glm::vec4> lights;
  ProbeLight probe;  ///< in the axes of the drawn space
  /// index of the light that casts shadows (sun_of); -1 in an object's own space
  int sun = -1;
};
LightBlock light_block(const ObjectLighting& lighting, const glm::vec3& eye);
LightBlock light_block(const Lighting& lighting, const glm::dvec3& eye);

/// The output of the pass besides colour.
enum class MeshOutput : std::uint8_t {
  kColor,    ///< none (client geometry, lit tiles)
  kId,       ///< integer instance id (reference frames)
  kSurface,  ///< unshaded colour; normal; metallic, roughness, occlusion (relit tiles)
  kBehind,   ///< none; draws only surfaces behind set_floor() (layered tiles)
  kShadow,   ///< colour without shadows, and colour with them (shadow tiles)
  kDepth,    ///< not even colour (shadow maps)
  kClear,    ///< no colour; pushes the depths of set_clear_of() behind the surfaces drawn (tiles)
  kTint,     ///< none; a colour of set_tint() in the place of each surface's (client insight)
  // The next two draw blended surfaces that are visible enough (common/seen.glsl).
  kFront,  ///< depth and id of the nearest surface, no colour (reference frames)
  kRange,  ///< window depths by GL_MAX: 1 - nearest, farthest; no colour (tiles)
};

class MeshPass {
 public:
  explicit MeshPass(MeshOutput output) : output_(output) {}

  /// Makes textures read this many mip levels sharper, those of alpha tests `tested_levels`. It is
  /// for a multisampled target that is compared with a supersampled truth.
  void sharpen(float levels, float tested_levels) {
    mip_bias_ = -levels;
    tested_mip_bias_ = -tested_levels;
  }
  /// Sets the width of lines and points, one pixel: `samples` samples on a target with so many per
  /// pixel side.
  void set_stroke(float samples) { stroke_ = samples; }
  /// Leaves out blended surfaces of less alpha; kFront and kRange alone.
  void set_least_alpha(float alpha) { least_alpha_ = alpha; }

  /// Draws every surface with these features as well. Missing ones use neutral textures, white
  /// vertices and an alpha test that passes. This is a renderer without need analysis, for proofs
  /// that leaving out changes nothing. Call it before the first draw.
  void force(NeedMask needs);

  /// Compiles the variant for these needs, and with `fades` also the dithering one. Error
  /// kGraphicsShader.
  Result<void> compile(NeedMask needs, bool fades);
  /// Compiles the variants of a mesh ahead of its first draw. A mesh whose shader fails to compile
  /// is not drawn.
  Result<void> warm_up(const GpuMesh& mesh, const std::vector<Material>& materials, bool fades);

  /// Begins drawing. `mapping`: that of the matrix.
  void begin(const glm::mat4& clip_from_relative, const LightBlock& lights,
             DepthMapping mapping = DepthMapping::kForward);
  /// Sets the fog for later draws; a density of 0 selects variants without fog.
  void set_fog(const glm::vec3& color, float density_per_m) {
    fog_color_ = color;
    fog_density_ = density_per_m;
  }
  /// Sets the sun's shadows for later draws, relative to `eye`; nullptr selects variants without
  /// shadows.
  void set_shadow(const ShadowMap* map, const glm::dvec3& eye) {
    shadow_ = map;
    eye_ = eye;
  }
  /// Draws only surfaces behind the depths of a texture, which has one texel for each `samples` a
  /// side.
  void set_floor(GLuint depths, int samples) {
    floor_ = depths;
    floor_samples_ = samples;
  }
  /// Pushes depths of the target that lie less than `reach` behind the drawn surface to `reach`
  /// behind it. `depths` is a copy of these depths at the same size, between planes `near` and
  /// `far`. All but the texture in units of view depth.
  void set_clear_of(GLuint depths, float near, float far, float reach) {
    floor_ = depths;
    clear_of_ = {near, far, reach};
  }
  /// Sets the colour that kTint shows, without blending.
  void set_tint(const glm::vec4& tint) { tint_ = tint; }
  /// Sets the light from all around for later draws; nullptr selects variants without it.
  void set_probe(const ProbeMap* probe) { probe_ = probe; }
  /// Sets how colours are shown in later draws, and the background colour, which is seen tinted
  /// through transmissive surfaces: the horizon's.
  void set_surroundings(const Environment& environment) {
    backdrop_ = environment.horizon;
    neutral_ = environment.tone == ToneCurve::kNeutral;
  }
  /// Draws the opaque and masked primitives (`blended` false) or the blended ones (true).
  void draw(const GpuMesh& mesh, const std::vector<Material>& materials, const GpuImages& images,
            const MeshInstance* instances, std::size_t count, bool blended);
  void end();

  int draw_calls() const { return draw_calls_; }
  void reset_draw_calls() { draw_calls_ = 0; }
  /// Returns the names of the variants compiled so far: their defines.
  std::vector<std::string> variants() const;

 private:
  /// Alpha-tested surfaces are drawn twice: a shader that only tests writes their depth, then they
  /// are shaded where that depth is theirs. Leaves overlap many deep, so this saves a third of the
  /// client's time in a forest.
  enum class Stage : std::uint8_t { kWhole, kDepth, kTested };
  std::vector<Stage> stages(NeedMask needs) const;
  bool of_blended() const { return output_ == MeshOutput::kFront || output_ == MeshOutput::kRange; }
  Result<Program*> program(NeedMask needs, bool fade, Stage stage);
  void use(Program& p, const Material& material, NeedMask needs, const GpuImages& images,
           Stage stage);
  void bind_material(Program& p, const Material& material, NeedMask needs, const GpuImages& images,
                     Stage stage);
  const Texture& neutral_map(LobeMap which) const;
  void bind_lobes(Program& p, const Lobes& lobes, NeedMask needs, const GpuImages& images,
                  std::vector<glm::vec4>& transforms);
  void bind_instances(const MeshInstance* instances, std::size_t count);

  const MeshOutput output_;
  NeedMask forced_ = 0;
  Texture white_, flat_, along_;  ///< neutral maps of forced features: 1, no slope, the tangent
  std::map<NeedMask, Program> programs_;
  Buffer instance_buffer_;
  glm::mat4 clip_from_relative_{1};
  GLenum nearer_ = GL_LESS;
  LightBlock lights_;
  float mip_bias_ = 0;
  float tested_mip_bias_ = 0;
  std::optional<bool> samples_;  ///< the context shades samples; asked at the first begin()
  float stroke_ = 1;
  float least_alpha_ = 0;
  glm::vec3 fog_color_{0};
  float fog_density_ = 0;
  const ShadowMap* shadow_ = nullptr;
  const ProbeMap* probe_ = nullptr;
  bool neutral_ = false;  ///< ToneCurve::kNeutral
  glm::vec3 backdrop_{0.216f};
  GLuint floor_ = 0;
  int floor_samples_ = 1;
  glm::vec3 clear_of_{0};
  glm::vec4 tint_{0};
  ProbeMap black_probe_;  ///< for forced features
  glm::dvec3 eye_{0};     ///< origin of positions, world; used for shadows only
  int draw_calls_ = 0;
};

}  // namespace mirage::gl
