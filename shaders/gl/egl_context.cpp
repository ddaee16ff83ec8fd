#include "shaders/gl/egl_context.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <cstring>
#include <utility>

#include "shaders/gl/gl.h"
#include "shaders/gl/renderer.h"

namespace mirage::gl {
namespace {

template <typename F>
F egl_function(const char* name) {
  return reinterpret_cast<F>(eglGetProcAddress(name));
}

std::vector<EGLDeviceEXT> query_devices() {
  const auto query = egl_function<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
  if (!query) return {};
  EGLint count = 0;
  if (!query(0, nullptr, &count) || count <= 0) return {};
  std::vector<EGLDeviceEXT> devices(static_cast<std::size_t>(count));
  if (!query(count, devices.data(), &count)) return {};
  return devices;
}

EGLDisplay platform_display(EGLenum platform, void* native) {
  const auto get = egl_function<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
  return get ? get(platform, native, nullptr) : EGL_NO_DISPLAY;
}

EGLDisplay display_for(const std::string& device) {
  if (device == "surfaceless") {
    return platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY);
  }
  if (device.rfind("device", 0) != 0 || device.size() > 8) return EGL_NO_DISPLAY;
  const std::string digits = device.substr(6);
  if (digits.empty() || digits.find_first_not_of("0123456789") != std::string::npos) {
    return EGL_NO_DISPLAY;
  }
  const std::vector<EGLDeviceEXT> devices = query_devices();
  const std::size_t index = std::stoul(digits);
  if (index >= devices.size()) return EGL_NO_DISPLAY;
  return platform_display(EGL_PLATFORM_DEVICE_EXT, devices[index]);
}

EGLContext make_embedded_context(EGLDisplay display) {
  if (!eglBindAPI(EGL_OPENGL_ES_API)) return EGL_NO_CONTEXT;
  const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_NONE};
  return eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
}

EGLContext make_context(EGLDisplay display) {
  if (!eglBindAPI(EGL_OPENGL_API)) return EGL_NO_CONTEXT;
  const EGLint config_attributes[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE,
                                      EGL_PBUFFER_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (!eglChooseConfig(display, config_attributes, &config, 1, &count) || count == 0) {
    config = EGL_NO_CONFIG_KHR;
  }
  std::vector<EGLint> attributes = {EGL_CONTEXT_MAJOR_VERSION,
                                    3,
                                    EGL_CONTEXT_MINOR_VERSION,
                                    3,
                                    EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                    EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                    EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY,
                                    EGL_LOSE_CONTEXT_ON_RESET,
                                    EGL_NONE};
  const EGLContext told = eglCreateContext(display, config, EGL_NO_CONTEXT, attributes.data());
  if (told != EGL_NO_CONTEXT) return told;
  // This device does not report resets.
  attributes[attributes.size() - 3] = EGL_NONE;
  return eglCreateContext(display, config, EGL_NO_CONTEXT, attributes.data());
}

std::string gl_string(GLenum name) {
  const auto* text = reinterpret_cast<const char*>(glGetString(name));
  return text ? text : "";
}

}  // namespace

EglContext::EglContext(EglContext&& other) noexcept
    : display_(std::exchange(other.display_, nullptr)),
      context_(std::exchange(other.context_, nullptr)),
      software_(other.software_),
      embedded_(other.embedded_) {}

EglContext& EglContext::operator=(EglContext&& other) noexcept {
  std::swap(display_, other.display_);
  std::swap(context_, other.context_);
  std::swap(software_, other.software_);
  std::swap(embedded_, other.embedded_);
  return *this;
}

EglContext::~EglContext() {
  if (!context_) return;
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(display_, context_);
  // The display stays initialised: every context of the process on this device shares it.
}

Result<EglContext> EglContext::create(const std::string& device, bool embedded) {
  if (device == "auto") {
    for (const EglDevice& candidate : list_egl_devices()) {
      if (candidate.usable && !is_software(candidate.renderer)) {
        return create(candidate.name, embedded);
      }
    }
    return create("surfaceless", embedded);
  }
  EglContext out;
  out.display_ = display_for(device);
  if (out.display_ == EGL_NO_DISPLAY) {
    return make_error(ErrorId::kGraphicsDevice, "no EGL device '" + device + "'",
                      "--list-devices shows what there is");
  }
  if (!eglInitialize(out.display_, nullptr, nullptr)) {
    return make_error(ErrorId::kGraphicsDevice, "EGL device '" + device + "' does not initialise");
  }
  out.embedded_ = embedded;
  out.context_ = embedded ? make_embedded_context(out.display_) : make_context(out.display_);
  if (!out.context_ ||
      !eglMakeCurrent(out.display_, EGL_NO_SURFACE, EGL_NO_SURFACE, out.context_)) {
    return make_error(ErrorId::kGraphicsDevice,
                      "EGL device '" + device + "' offers no " +
                          (embedded ? "OpenGL ES 3" : "OpenGL 3.3 core") + " context",
                      "a software renderer comes with libgl1-mesa-dri");
  }
  out.software_ = is_software(gl_string(GL_RENDERER));
  return out;
}

void EglContext::make_current() {
  eglBindAPI(embedded_ ? EGL_OPENGL_ES_API : EGL_OPENGL_API);
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_);
}

std::string EglContext::description() const {
  return gl_string(GL_RENDERER) + ", OpenGL " + gl_string(GL_VERSION);
}

std::vector<EglDevice> list_egl_devices() {
  std::vector<std::string> names = {"surfaceless"};
  for (std::size_t i = 0; i < query_devices().size(); ++i) {
    names.push_back("device" + std::to_string(i));
  }
  std::vector<EglDevice> out;
  for (const std::string& name : names) {
    EglDevice device;
    device.name = name;
    Result<EglContext> context = EglContext::create(name);
    device.usable = context.ok();
    device.renderer = context.ok() ? context->description() : context.error().text;
    out.push_back(device);
  }
  return out;
}

}  // namespace mirage::gl
