#pragma once
// Draws impostors from the atlas, back to front: one instanced call per run of one method, for
// convex hulls and warps of one object. Keeps to the GLES 3.0 subset.

#include <map>
#include <set>
#include <vector>

#include "client/draw/impostor_atlas.h"
#include "client/draw/proxy_triangles.h"
#include "client/frame/draw_list.h"
#include "client/scene/scene_view.h"
#include "protocol/base/result.h"
#include "shaders/gl/gl_object.h"
#include "shaders/gl/mesh_pass.h"
#include "shaders/gl/probe_map.h"
#include "shaders/gl/program.h"

namespace mirage {

class ImpostorPass {
 public:
  /// `flat`: which flat methods will be drawn; their programs are made now, and no others. Error
  /// kGraphicsShader, kGraphicsGl (atlas too large).
  static Result<ImpostorPass> create(int atlas_edge, int atlas_layers, std::set<DrawMethod> flat);

  /// Proxies of a new scene, and programs with or without its fog, shadows and probe. Error
  /// kGraphicsShader: those there were stay.
  Result<void> reset(const SceneView& scene);
  /// The first tile in layers brings its program. Errors kGraphicsGl, kGraphicsShader.
  Result<void> upload(const TileRecord& record, const TilePixels& pixels);
  /// `shadow_atlas`: of ShadowAtlas, 0 when no impostor wears a shadow.
  /// `mapping`: of the target's depth. `probe`: the scene's, nullptr for none.
  void draw(const Camera& camera, DepthMapping mapping, const SceneView& scene,
            const DrawList& list, const Lighting& lighting, GLuint shadow_atlas,
            const gl::ProbeMap* probe);

  int draw_calls() const { return draw_calls_; }
  void reset_draw_calls() { draw_calls_ = 0; }
  std::size_t gpu_bytes() const { return atlas_.gpu_bytes(); }

 private:
  struct Proxy {
    gl::VertexArray vao;
    gl::Buffer vertices;
    int vertex_count = 0;
  };
  /// What a scene has, beyond what every scene may: defines of its programs.
  struct Variant {
    bool fog = false, shadows = false, probe = false;
  };
  static Result<gl::Program> make_program(const char* name, std::vector<std::string> defines,
                                          const Variant& v);
  Result<void> make_programs(const Variant& v);
  static Proxy make_proxy(const std::vector<ProxyVertex>& triangles);
  template <typename InstanceT>
  void draw_instances(const Proxy& proxy, const std::vector<InstanceT>& instances, bool cull);
  /// Which fragments of an impostor are drawn at once. kAll: all of them, and all write depth:
  /// behind a soft edge only what comes later, though it is farther, is missing. Flat groups and
  /// what is seen through are soft within, and parts of one thing meet at soft edges: their solid
  /// fragments come first, the soft ones write no depth.
  enum class Fragments { kAll, kSolid, kSoft };
  using DrawnImpostors = std::vector<const DrawnImpostor*>;
  static Fragments fragments_of(const DrawnImpostor& drawn, const SceneView& scene, bool solid);
  /// `solid`: the solid fragments that come first, else all others, in the order of the list.
  void draw_runs(const Camera& camera, const SceneView& scene, const DrawList& list, bool solid);
  /// A run of impostors that are drawn alike; not empty.
  void draw_flat(const Camera& camera, const SceneView& scene, const DrawnImpostors& run,
                 Fragments fragments);
  void draw_relief(const Camera& camera, const SceneView& scene, const DrawnImpostors& run);
  void use_atlas(gl::Program& program, const Camera& camera, bool relit);
  void draw_placeholders(const Camera& camera, const SceneView& scene, const DrawList& list,
                         const Lighting& lighting);

  const Proxy& hull(const SceneView& scene, std::uint32_t object);
  const Proxy& warp_proxy(const SceneView& scene, std::uint32_t object);

  ImpostorAtlas atlas_;
  std::set<DrawMethod> flat_;                                    ///< methods with programs
  std::map<std::pair<DrawMethod, bool>, gl::Program> programs_;  ///< and whether for relit tiles
  gl::Program relief_;
  gl::Program relit_relief_;
  gl::Program layered_relief_;  ///< of tiles in two layers; none before the first
  gl::Program placeholder_;
  gl::Buffer instances_;
  Proxy quad_;
  Proxy cube_;
  std::map<std::uint32_t, Proxy> hulls_, warp_proxies_;  ///< by object, made when first drawn
  gl::LightBlock lights_;                                ///< of the frame
  Variant variant_;                                      ///< of the programs
  GLuint shadow_atlas_ = 0;
  const gl::ProbeMap* probe_ = nullptr;
  DepthMapping mapping_ = DepthMapping::kForward;
  glm::vec3 shadow_tint_{1};
  glm::vec3 fog_color_{0};
  float fog_density_ = 0;
  int draw_calls_ = 0;
};

}  // namespace mirage
