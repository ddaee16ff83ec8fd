#pragma once
// GLSL programs. Sources are embedded at build time; variants are #defines put in front.

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "protocol/base/result.h"
#include "shaders/gl/gl.h"

namespace mirage::gl {

/// Returns the text of an embedded shader file, e.g. "mesh/mesh.vert"; empty if there is none.
std::string_view shader_source(std::string_view name);
/// Returns the names of all embedded shader files.
std::vector<std::string_view> shader_names();

/// Returns the number of programs compiled and linked in this process so far.
std::uint64_t programs_compiled();

class Program {
 public:
  Program() = default;
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  Program(Program&& other) noexcept;
  Program& operator=(Program&& other) noexcept;
  ~Program();

  /// Compiles two embedded files; `#include "path"` lines are resolved among the embedded files,
  /// `defines` are "NAME" or "NAME value". Error kGraphicsShader carries the driver's log.
  static Result<Program> create(std::string_view vertex, std::string_view fragment,
                                const std::vector<std::string>& defines);

  void use() const { glUseProgram(id_); }
  explicit operator bool() const { return id_ != 0; }

  // Set uniforms by name. Unknown names are ignored, as a lean variant may lack them.
  void set(const char* name, int value);
  void set(const char* name, float value);
  void set(const char* name, const glm::ivec2& value);
  void set(const char* name, const glm::vec2& value);
  void set(const char* name, const glm::vec3& value);
  void set(const char* name, const glm::vec4& value);
  void set(const char* name, const glm::mat4& value);
  void set(const char* name, const std::vector<glm::vec4>& values);

 private:
  GLint location(const char* name);

  GLuint id_ = 0;
  std::unordered_map<std::string, GLint> locations_;
};

}  // namespace mirage::gl
