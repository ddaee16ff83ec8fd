#include "client/view/window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <utility>

#include "client/draw/insight.h"
#include "client/screen/steering.h"

namespace mirage {

struct Window::Impl {
  GLFWwindow* window = nullptr;
  bool overlay = true;
  bool overlay_key_down = false;
  bool stopped = false;
  bool space_down = false;
  int layer = 0;
  bool dragging = false;
  double last_x = 0, last_y = 0;
  bool refresh = true;
  bool down(int key) const { return glfwGetKey(window, key) == GLFW_PRESS; }
};

Window::Window() : impl_(std::make_unique<Impl>()) {}
Window::Window(Window&&) noexcept = default;
Window& Window::operator=(Window&&) noexcept = default;

Window::~Window() {
  if (!impl_ || !impl_->window) return;
  glfwDestroyWindow(impl_->window);
  glfwTerminate();
}

Result<Window> Window::create(int width, int height) {
  if (!glfwInit()) {
    return make_error(ErrorId::kGraphicsDevice, "there is no display to open a window on",
                      "--offscreen 1280x720 --out DIR renders to files");
  }
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_SRGB_CAPABLE, GLFW_FALSE);
  Window out;
  out.impl_->window = glfwCreateWindow(width, height, "Mirage", nullptr, nullptr);
  if (!out.impl_->window) {
    glfwTerminate();
    return make_error(ErrorId::kGraphicsDevice, "no window with OpenGL 3.3 can be opened");
  }
  glfwMakeContextCurrent(out.impl_->window);
  glfwSwapInterval(1);
  // The implementation keeps its address when the window is moved.
  glfwSetWindowUserPointer(out.impl_->window, out.impl_.get());
  glfwSetWindowRefreshCallback(out.impl_->window, [](GLFWwindow* window) {
    static_cast<Impl*>(glfwGetWindowUserPointer(window))->refresh = true;
  });
  return out;
}

bool Window::poll() {
  glfwPollEvents();
  return after_events();
}

bool Window::wait(double seconds) {
  glfwWaitEventsTimeout(seconds);
  return after_events();
}

void Window::wake() { glfwPostEmptyEvent(); }

double Window::refresh_ms() const {
  constexpr double kUsualHz = 60;
  GLFWmonitor* monitor = glfwGetPrimaryMonitor();
  const GLFWvidmode* mode = monitor ? glfwGetVideoMode(monitor) : nullptr;
  return 1000.0 / (mode && mode->refreshRate > 0 ? mode->refreshRate : kUsualHz);
}

bool Window::take_refresh() { return std::exchange(impl_->refresh, false); }

bool Window::after_events() {
  const bool key = impl_->down(GLFW_KEY_O);
  if (key && !impl_->overlay_key_down) {
    impl_->overlay = !impl_->overlay;
    impl_->refresh = true;
  }
  impl_->overlay_key_down = key;
  const bool space = impl_->down(GLFW_KEY_SPACE);
  if (space && !impl_->space_down) impl_->stopped = !impl_->stopped;
  impl_->space_down = space;
  for (int i = 0; i <= static_cast<int>(kInsightLayers); ++i) {
    if (!impl_->down(GLFW_KEY_1 + i) || impl_->layer == i) continue;
    impl_->layer = i;
    impl_->refresh = true;
  }
  return !glfwWindowShouldClose(impl_->window) && !impl_->down(GLFW_KEY_ESCAPE);
}

void Window::present() { glfwSwapBuffers(impl_->window); }
void Window::framebuffer_size(int& width, int& height) const {
  glfwGetFramebufferSize(impl_->window, &width, &height);
}
int Window::layer() const { return impl_->layer; }
bool Window::overlay() const { return impl_->overlay; }
bool Window::stopped() const { return impl_->stopped; }

void Window::steer(Pose& pose, double seconds, double speed_mps) {
  Steering by;
  double x = 0, y = 0;
  glfwGetCursorPos(impl_->window, &x, &y);
  const bool drag = glfwGetMouseButton(impl_->window, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS;
  if (drag && impl_->dragging) {
    constexpr double kRadiansPerPixel = 0.003;
    by.yaw = (x - impl_->last_x) * kRadiansPerPixel;
    by.pitch = (y - impl_->last_y) * kRadiansPerPixel;
  }
  impl_->dragging = drag;
  impl_->last_x = x;
  impl_->last_y = y;
  const auto axis = [&](int plus, int minus) {
    return static_cast<double>(impl_->down(plus)) - static_cast<double>(impl_->down(minus));
  };
  const double ahead = axis(GLFW_KEY_W, GLFW_KEY_S) + axis(GLFW_KEY_UP, GLFW_KEY_DOWN);
  const double side = axis(GLFW_KEY_D, GLFW_KEY_A) + axis(GLFW_KEY_RIGHT, GLFW_KEY_LEFT);
  const double rise = axis(GLFW_KEY_E, GLFW_KEY_Q);
  const double speed = speed_mps * (impl_->down(GLFW_KEY_LEFT_SHIFT) ? 5.0 : 1.0);
  by.move = glm::dvec3(side, rise, ahead) * (speed * seconds);
  mirage::steer(pose, by);
}

}  // namespace mirage
