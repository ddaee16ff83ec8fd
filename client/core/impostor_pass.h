#pragma once
// Draws impostors from the atlas: one instanced call per method and pass (solid, then soft) for
// quads, cuboids and marched depth, one per object for convex hulls. Keeps to the GLES 3.0 subset.

#include <map>
#include <vector>

#include "client/core/scene_view.h"
#include "client/core/selector.h"
#include "protocol/result.h"
#include "shaders/gl/gl_object.h"
#include "shaders/gl/program.h"

namespace mirage {

struct ProxyVertex {
  glm::vec3 position, normal;
  float parallax;  ///< object units, see ConvexHull
};

class ImpostorPass {
 public:
  /// Error kGraphicsShader, kGraphicsGl (atlas too large).
  static Result<ImpostorPass> create(int atlas_edge, int atlas_layers);

  /// Proxies of a new scene.
  void reset(const SceneView& scene);
  /// Puts a tile's planes, with a gutter of nothing, where its record says.
  void upload(const TileRecord& record, const std::vector<std::uint8_t>& rgba);
  void draw(const Camera& camera, const SceneView& scene, const DrawList& list,
            const Lighting& lighting);

  int draw_calls() const { return draw_calls_; }
  void reset_draw_calls() { draw_calls_ = 0; }
  std::size_t gpu_bytes() const { return gpu_bytes_; }

 private:
  struct Proxy {
    gl::VertexArray vao;
    gl::Buffer vertices;
    int vertex_count = 0;
  };
  static Proxy make_proxy(const std::vector<ProxyVertex>& triangles);
  template <typename InstanceT>
  void draw_instances(const Proxy& proxy, const std::vector<InstanceT>& instances, bool cull);
  void draw_method(const Camera& camera, const SceneView& scene, const DrawList& list,
                   DrawMethod method, bool soft);
  void draw_relief(const Camera& camera, const SceneView& scene, const DrawList& list);
  void use_atlas(gl::Program& program, const Camera& camera);
  void draw_placeholders(const Camera& camera, const SceneView& scene, const DrawList& list,
                         const Lighting& lighting);

  gl::Texture color_;
  gl::Texture depth_;
  std::map<DrawMethod, gl::Program> programs_;
  gl::Program relief_;
  gl::Program merged_;
  gl::Texture tile_rows_;  ///< of merged impostors, see relief_instance.h
  gl::Program placeholder_;
  gl::Buffer instances_;
  Proxy quad_;
  Proxy cube_;
  std::vector<Proxy> hulls_;
  std::vector<Proxy> warp_proxies_;
  int draw_calls_ = 0;
  std::size_t gpu_bytes_ = 0;
};

}  // namespace mirage
