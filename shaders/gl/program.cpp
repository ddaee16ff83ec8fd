#include "shaders/gl/program.h"

#include <atomic>
#include <glm/gtc/type_ptr.hpp>
#include <utility>

#include "shaders/gl/dialect.h"
#include "shaders/gl/gl_object.h"

namespace mirage::gl {
namespace {

constexpr int kMaxIncludeDepth = 5;

std::atomic<std::uint64_t> compiled_so_far{0};

std::string expand(std::string_view source, int depth) {
  std::string out;
  std::size_t at = 0;
  while (at < source.size()) {
    std::size_t end = source.find('\n', at);
    if (end == std::string_view::npos) end = source.size();
    const std::string_view line = source.substr(at, end - at);
    constexpr std::string_view kInclude = "#include \"";
    if (depth < kMaxIncludeDepth && line.rfind(kInclude, 0) == 0) {
      const std::string_view name = line.substr(kInclude.size(), line.rfind('"') - kInclude.size());
      const std::string_view file = shader_source(name);
      out += file.empty() ? "#error no shader file " + std::string(name) : expand(file, depth + 1);
    } else {
      out += line;
    }
    out += '\n';
    at = end + 1;
  }
  return out;
}

std::string info_log(GLuint id, bool program) {
  char text[2048] = {};
  GLsizei length = 0;
  if (program) {
    glGetProgramInfoLog(id, sizeof(text) - 1, &length, text);
  } else {
    glGetShaderInfoLog(id, sizeof(text) - 1, &length, text);
  }
  return std::string(text, static_cast<std::size_t>(length));
}

// Starts compiling a shader. The result is queried after the program is linked: a device compiles
// in parallel, and in a browser the query blocks until it is done.
Result<GLuint> compile(GLenum stage, std::string_view name, const std::string& defines) {
  const std::string_view source = shader_source(name);
  if (source.empty()) {
    return make_error(ErrorId::kGraphicsShader, "no shader file " + std::string(name));
  }
  const std::string text = shader_header() + defines + expand(source, 0);
  const GLuint shader = glCreateShader(stage);
  const char* pointer = text.c_str();
  glShaderSource(shader, 1, &pointer, nullptr);
  glCompileShader(shader);
  return shader;
}

// Returns the compiler's error; "" if it compiled.
std::string compile_problem(GLuint shader, std::string_view name) {
  GLint ok = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
  return ok ? std::string() : std::string(name) + ": " + info_log(shader, false);
}

}  // namespace

std::uint64_t programs_compiled() { return compiled_so_far; }

Program::Program(Program&& other) noexcept
    : id_(std::exchange(other.id_, 0)), locations_(std::move(other.locations_)) {}

Program& Program::operator=(Program&& other) noexcept {
  std::swap(id_, other.id_);
  std::swap(locations_, other.locations_);
  return *this;
}

Program::~Program() {
  if (id_ == 0) return;
  if (!ForgetNames::on()) glDeleteProgram(id_);
  --live_objects();
}

Result<Program> Program::create(std::string_view vertex, std::string_view fragment,
                                const std::vector<std::string>& defines) {
  std::string text;
  for (const std::string& define : defines) text += "#define " + define + "\n";
  Result<GLuint> vs = compile(GL_VERTEX_SHADER, vertex, text);
  if (!vs) return vs.error();
  Result<GLuint> fs = compile(GL_FRAGMENT_SHADER, fragment, text);
  if (!fs) {
    glDeleteShader(*vs);
    return fs.error();
  }
  Program program;
  program.id_ = glCreateProgram();
  ++live_objects();
  glAttachShader(program.id_, *vs);
  glAttachShader(program.id_, *fs);
  glLinkProgram(program.id_);
  GLint ok = 0;
  glGetProgramiv(program.id_, GL_LINK_STATUS, &ok);
  std::string problem;
  if (!ok) problem = compile_problem(*vs, vertex);
  if (!ok && problem.empty()) problem = compile_problem(*fs, fragment);
  if (!ok && problem.empty()) problem = std::string(fragment) + ": " + info_log(program.id_, true);
  glDeleteShader(*vs);
  glDeleteShader(*fs);
  if (!ok) return make_error(ErrorId::kGraphicsShader, problem);
  ++compiled_so_far;
  return program;
}

GLint Program::location(const char* name) {
  const auto found = locations_.find(name);
  if (found != locations_.end()) return found->second;
  const GLint l = glGetUniformLocation(id_, name);
  locations_.emplace(name, l);
  return l;
}

void Program::set(const char* name, int v) { glUniform1i(location(name), v); }
void Program::set(const char* name, float v) { glUniform1f(location(name), v); }
void Program::set(const char* name, const glm::ivec2& v) {
  glUniform2iv(location(name), 1, glm::value_ptr(v));
}
void Program::set(const char* name, const glm::vec2& v) {
  glUniform2fv(location(name), 1, glm::value_ptr(v));
}
void Program::set(const char* name, const glm::vec3& v) {
  glUniform3fv(location(name), 1, glm::value_ptr(v));
}
void Program::set(const char* name, const glm::vec4& v) {
  glUniform4fv(location(name), 1, glm::value_ptr(v));
}
void Program::set(const char* name, const glm::mat4& v) {
  glUniformMatrix4fv(location(name), 1, GL_FALSE, glm::value_ptr(v));
}
void Program::set(const char* name, const std::vector<glm::vec4>& v) {
  if (v.empty()) return;
  glUniform4fv(location(name), static_cast<GLsizei>(v.size()), glm::value_ptr(v[0]));
}

}  // namespace mirage::gl
