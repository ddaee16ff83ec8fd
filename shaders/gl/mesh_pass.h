#pragma once
// Draws meshes with the shared shading: the server's tiles and reference frames, the client's
// geometry. Shader variants are keyed by need mask and compiled on first use (or warmed up).

#include <map>
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

/// An instance for a pass whose positions are relative to `eye`.
MeshInstance mesh_instance(const Similarity& world_from_object, const glm::dvec3& eye,
                           std::uint32_t id);

/// Lights as the shader takes them, positions relative to the eye.
struct LightBlock {
  glm::vec3 ambient{0};
  int count = 0;
  std::vector<glm::vec4> lights;
  ProbeLight probe;  ///< in the axes of what is drawn
  int sun = -1;      ///< which of them casts shadows (sun_of); never one of an object's own space
};
LightBlock light_block(const ObjectLighting& lighting, const glm::vec3& eye);
LightBlock light_block(const Lighting& lighting, const glm::dvec3& eye);

/// What the pass writes besides colour.
enum class MeshOutput : std::uint8_t {
  kColor,    ///< nothing (client geometry, lit tiles)
  kId,       ///< the instance id, an integer (reference frames)
  kSurface,  ///< colour is not shaded; normal, then metallic, roughness, occlusion (relit tiles)
  kBehind,   ///< nothing, of what lies behind set_floor() (layered tiles)
  kShadow,   ///< colour is without shadows; the same with them (shadow tiles)
  kDepth,    ///< not even colour (shadow maps)
  // Of blended surfaces, where more than a little of them shows (common/seen.glsl):
  kFront,  ///< depth and id, no colour: what is nearest (reference frames)
  kRange,  ///< nearest and farthest window depth, no colour, by GL_MAX (tiles): 1 - depth, depth
};

class MeshPass {
 public:
  explicit MeshPass(MeshOutput output) : output_(output) {}

  /// For a multisampled target, drawn beside a supersampled truth: textures are read this many
  /// levels sharper, those of alpha tests `tested_levels`.
  void sharpen(float levels, float tested_levels) {
    mip_bias_ = -levels;
    tested_mip_bias_ = -tested_levels;
  }
  /// Lines and points are one pixel wide: `samples` of a target with so many to a pixel's side.
  void set_stroke(float samples) { stroke_ = samples; }

  /// Draws every surface with these features too, those it does not have with neutral textures,
  /// white vertices and a test that passes: a renderer without need analysis, for proofs that
  /// leaving out changes nothing. Before the first draw.
  void force(NeedMask needs);

  /// Compiles the variant for these needs, with `fades` also the one that dithers. Error
  /// kGraphicsShader.
  Result<void> compile(NeedMask needs, bool fades);
  /// The variants of a mesh, ahead of its first draw: what does not compile is not drawn.
  Result<void> warm_up(const GpuMesh& mesh, const std::vector<Material>& materials, bool fades);

  /// `mapping` is that of the matrix.
  void begin(const glm::mat4& clip_from_relative, const LightBlock& lights,
             DepthMapping mapping = DepthMapping::kForward);
  /// Fog over what is drawn from now on; without any density variants without fog are used.
  void set_fog(const glm::vec3& color, float density_per_m) {
    fog_color_ = color;
    fog_density_ = density_per_m;
  }
  /// Shadows of the sun on what is drawn from now on, relative to `eye`; nullptr: none, and
  /// variants without shadows are used.
  void set_shadow(const ShadowMap* map, const glm::dvec3& eye) {
    shadow_ = map;
    eye_ = eye;
  }
  /// Draws only what lies farther than a texture says, a texel of it for each `samples` a side.
  void set_floor(GLuint depths, int samples) {
    floor_ = depths;
    floor_samples_ = samples;
  }
  /// Light from all around on what is drawn from now on; nullptr: none, and variants without it are
  /// used.
  void set_probe(const ProbeMap* probe) { probe_ = probe; }
  /// What is seen where no object is, linear: of it is what shows tinted through a surface.
  void set_backdrop(const glm::vec3& color) { backdrop_ = color; }
  /// Draws the opaque and masked primitives (`blended` false) or the blended ones (true).
  void draw(const GpuMesh& mesh, const std::vector<Material>& materials, const GpuImages& images,
            const MeshInstance* instances, std::size_t count, bool blended);
  void end();

  int draw_calls() const { return draw_calls_; }
  void reset_draw_calls() { draw_calls_ = 0; }
  /// Names of the variants compiled so far: their defines.
  std::vector<std::string> variants() const;

 private:
  /// Alpha-tested surfaces first write their depth by a shader that only tests, then are shaded
  /// where that depth is theirs: leaves lie many deep (a third less client time in a forest).
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
  Texture white_, flat_, along_;  ///< neutral maps, of what is forced: 1, no slope, the tangent
  std::map<NeedMask, Program> programs_;
  Buffer instance_buffer_;
  glm::mat4 clip_from_relative_{1};
  GLenum nearer_ = GL_LESS;
  LightBlock lights_;
  float mip_bias_ = 0;
  float tested_mip_bias_ = 0;
  float stroke_ = 1;
  glm::vec3 fog_color_{0};
  float fog_density_ = 0;
  const ShadowMap* shadow_ = nullptr;
  const ProbeMap* probe_ = nullptr;
  glm::vec3 backdrop_{0.216f};
  GLuint floor_ = 0;
  int floor_samples_ = 1;
  ProbeMap black_probe_;  ///< of what is forced
  glm::dvec3 eye_{0};     ///< positions are relative to it, world; for shadows only
  int draw_calls_ = 0;
};

}  // namespace mirage::gl
