#pragma once
// Move-only owners of GL names: empty-constructible, never copied, never leaked, counted at exit.

#include <atomic>
#include <cstdint>
#include <utility>

#include "shaders/gl/gl.h"

namespace mirage::gl {

/// Number of GL objects alive in this process; tests and program exits expect 0.
inline std::atomic<int>& live_objects() {
  static std::atomic<int> count{0};
  return count;
}

/// While one exists on a thread, objects that end there forget their names and delete nothing: the
/// context that had them is lost, and the names may be another's.
class ForgetNames {
 public:
  ForgetNames() { ++depth(); }
  ~ForgetNames() { --depth(); }
  ForgetNames(const ForgetNames&) = delete;
  ForgetNames& operator=(const ForgetNames&) = delete;
  static bool on() { return depth() > 0; }

 private:
  static int& depth() {
    thread_local int count = 0;
    return count;
  }
};

template <typename Traits>
class Object {
 public:
  Object() = default;
  explicit Object(GLuint id) : id_(id) {
    if (id_ != 0) ++live_objects();
  }
  Object(const Object&) = delete;
  Object& operator=(const Object&) = delete;
  Object(Object&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
  Object& operator=(Object&& other) noexcept {
    if (this != &other) {
      reset();
      id_ = std::exchange(other.id_, 0);
    }
    return *this;
  }
  ~Object() { reset(); }

  static Object create() { return Object(Traits::create()); }
  GLuint id() const { return id_; }
  explicit operator bool() const { return id_ != 0; }
  void reset() {
    if (id_ == 0) return;
    if (!ForgetNames::on()) Traits::destroy(id_);
    id_ = 0;
    --live_objects();
  }

 private:
  GLuint id_ = 0;
};

#define MIRAGE_GL_TRAITS(Name, gen, del)            \
  struct Name {                                     \
    static GLuint create() {                        \
      GLuint id = 0;                                \
      gen(1, &id);                                  \
      return id;                                    \
    }                                               \
    static void destroy(GLuint id) { del(1, &id); } \
  };
MIRAGE_GL_TRAITS(BufferTraits, glGenBuffers, glDeleteBuffers)
MIRAGE_GL_TRAITS(TextureTraits, glGenTextures, glDeleteTextures)
MIRAGE_GL_TRAITS(FramebufferTraits, glGenFramebuffers, glDeleteFramebuffers)
MIRAGE_GL_TRAITS(RenderbufferTraits, glGenRenderbuffers, glDeleteRenderbuffers)
MIRAGE_GL_TRAITS(VertexArrayTraits, glGenVertexArrays, glDeleteVertexArrays)
#undef MIRAGE_GL_TRAITS

using Buffer = Object<BufferTraits>;
using Texture = Object<TextureTraits>;
using Framebuffer = Object<FramebufferTraits>;
using Renderbuffer = Object<RenderbufferTraits>;
using VertexArray = Object<VertexArrayTraits>;

}  // namespace mirage::gl
