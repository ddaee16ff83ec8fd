// A library to be preloaded (LD_PRELOAD) into a program under test: GL and files that fail.
//   FAULT_GL=map|unmap|fence|error|reset   what fails, from the FAULT_AFTER-th call on
//   FAULT_FOLDER=PATH FAULT_MS=N           opening a file below it takes that long
//   FAULT_CLOCK_S=N                        the wall clock goes back by that much every 2 s

#include <GL/gl.h>
#include <GL/glext.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <stdarg.h>
#include <sys/time.h>
#include <time.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <thread>

namespace {

std::string set_to(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

bool fails(const char* what) {
  static const std::string chosen = set_to("FAULT_GL");
  static const int after = std::atoi(set_to("FAULT_AFTER").c_str());
  static std::atomic<int> calls{0};
  return chosen == what && ++calls > after;
}

template <typename F>
F* original(const char* name) {
  return reinterpret_cast<F*>(dlsym(RTLD_NEXT, name));
}

void wait_for_disk(const char* path) {
  static const std::string folder = set_to("FAULT_FOLDER");
  static const int ms = std::atoi(set_to("FAULT_MS").c_str());
  if (folder.empty() || !path || std::strncmp(path, folder.c_str(), folder.size()) != 0) return;
  std::this_thread::sleep_for(std::chrono::milliseconds(ms));
}

decltype(clock_gettime)* real_clock() {
  static const auto real = original<decltype(clock_gettime)>("clock_gettime");
  return real;
}

/// Returns the seconds by which the wall clock is behind now; they grow every two seconds.
time_t set_back_s() {
  static const time_t step_s = std::atol(set_to("FAULT_CLOCK_S").c_str());
  static const time_t began_s = [] {
    timespec at{};
    real_clock()(CLOCK_MONOTONIC, &at);
    return at.tv_sec;
  }();
  timespec now{};
  real_clock()(CLOCK_MONOTONIC, &now);
  return step_s * ((now.tv_sec - began_s) / 2);
}

}  // namespace

extern "C" {

int clock_gettime(clockid_t clock, timespec* at) noexcept {
  const int result = real_clock()(clock, at);
  if (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE) at->tv_sec -= set_back_s();
  return result;
}

time_t time(time_t* out) noexcept {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  if (out) *out = now.tv_sec;
  return now.tv_sec;
}

int gettimeofday(timeval* at, void*) noexcept {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  *at = {now.tv_sec, now.tv_nsec / 1000};
  return 0;
}

void* glMapBufferRange(GLenum target, GLintptr offset, GLsizeiptr length, GLbitfield access) {
  if (fails("map")) return nullptr;
  static const auto real = original<decltype(glMapBufferRange)>("glMapBufferRange");
  return real(target, offset, length, access);
}

GLboolean glUnmapBuffer(GLenum target) {
  static const auto real = original<decltype(glUnmapBuffer)>("glUnmapBuffer");
  const GLboolean good = real(target);
  return fails("unmap") ? GLboolean{GL_FALSE} : good;
}

GLenum glClientWaitSync(GLsync sync, GLbitfield flags, GLuint64 timeout) {
  if (fails("fence")) return GL_WAIT_FAILED;
  static const auto real = original<decltype(glClientWaitSync)>("glClientWaitSync");
  return real(sync, flags, timeout);
}

GLenum glGetError() {
  static const auto real = original<GLenum()>("glGetError");
  const GLenum found = real();
  return fails("error") ? GLenum{GL_OUT_OF_MEMORY} : found;
}

GLenum glGetGraphicsResetStatus() {
  static const auto real = original<GLenum()>("glGetGraphicsResetStatus");
  const GLenum found = real();
  return fails("reset") ? GLenum{GL_GUILTY_CONTEXT_RESET} : found;
}

int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const unsigned int mode = flags & O_CREAT ? va_arg(rest, unsigned int) : 0;
  va_end(rest);
  wait_for_disk(path);
  static const auto real = original<int(const char*, int, ...)>("open");
  return real(path, flags, mode);
}

FILE* fopen(const char* path, const char* mode) {
  wait_for_disk(path);
  static const auto real = original<FILE*(const char*, const char*)>("fopen");
  return real(path, mode);
}

FILE* fopen64(const char* path, const char* mode) {
  wait_for_disk(path);
  static const auto real = original<FILE*(const char*, const char*)>("fopen64");
  return real(path, mode);
}
}
