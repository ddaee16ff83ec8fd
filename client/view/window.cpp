#include "client/view/window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <set>
#include <utility>

#include "client/draw/insight.h"

namespace mirage {

struct Window::Impl {
  GLFWwindow* window = nullptr;
  bool overlay = true;
  bool stopped = false;
  int layer = 0;
  bool dragging = false;
  double last_x = 0, last_y = 0;
  double scrolled = 0;  ///< steps
  std::optional<glm::dvec2> aim_at;
  std::set<int> held;                ///< keys that were down after the last events
  std::set<WindowCommand> commands;  ///< commands that are not taken yet
  bool refresh = true;
  /// True once for each time that a key goes down.
  bool pressed(int key) {
    if (!down(key)) return held.erase(key), false;
    return held.insert(key).second;
  }
  bool down(int key) const { return glfwGetKey(window, key) == GLFW_PRESS; }
  /// Returns a place of the window as 0 to 1, right and down.
  glm::dvec2 place(double x, double y) const {
    int width = 0, height = 0;
    glfwGetWindowSize(window, &width, &height);
    return {x / std::max(1, width), y / std::max(1, height)};
  }
  void scroll(double steps) {
    double x = 0, y = 0;
    glfwGetCursorPos(window, &x, &y);
    scrolled += steps;
    aim_at = place(x, y);
  }
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
  glfwSetScrollCallback(out.impl_->window, [](GLFWwindow* window, double, double steps) {
    static_cast<Impl*>(glfwGetWindowUserPointer(window))->scroll(steps);
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
  if (impl_->pressed(GLFW_KEY_O)) {
    impl_->overlay = !impl_->overlay;
    impl_->refresh = true;
  }
  if (impl_->pressed(GLFW_KEY_SPACE)) impl_->stopped = !impl_->stopped;
  constexpr std::pair<int, WindowCommand> kCommands[] = {{GLFW_KEY_M, WindowCommand::kSteerMode},
                                                         {GLFW_KEY_G, WindowCommand::kFly},
                                                         {GLFW_KEY_N, WindowCommand::kNextClip},
                                                         {GLFW_KEY_B, WindowCommand::kNextVariant}};
  for (const auto& [key, command] : kCommands) {
    if (impl_->pressed(key)) impl_->commands.insert(command);
  }
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

Steering Window::take_steering(double seconds) {
  Steering by;
  int width = 0, height = 0;
  glfwGetWindowSize(impl_->window, &width, &height);
  double x = 0, y = 0;
  glfwGetCursorPos(impl_->window, &x, &y);
  const auto pressed = [&](int button) {
    return glfwGetMouseButton(impl_->window, button) == GLFW_PRESS;
  };
  const bool turns = pressed(GLFW_MOUSE_BUTTON_LEFT);
  const bool pans = pressed(GLFW_MOUSE_BUTTON_RIGHT) || pressed(GLFW_MOUSE_BUTTON_MIDDLE);
  const glm::dvec2 way =
      glm::dvec2(x - impl_->last_x, y - impl_->last_y) / std::max(1.0, 1.0 * height);
  if (impl_->dragging && (turns || pans)) (pans ? by.pan : by.drag) = way;
  if ((turns || pans) && !impl_->dragging) impl_->aim_at = impl_->place(x, y);
  impl_->dragging = turns || pans;
  impl_->last_x = x;
  impl_->last_y = y;
  by.zoom = std::exchange(impl_->scrolled, 0);
  const auto axis = [&](int plus, int minus) {
    return static_cast<double>(impl_->down(plus)) - static_cast<double>(impl_->down(minus));
  };
  const double ahead = axis(GLFW_KEY_W, GLFW_KEY_S) + axis(GLFW_KEY_UP, GLFW_KEY_DOWN);
  const double side = axis(GLFW_KEY_D, GLFW_KEY_A) + axis(GLFW_KEY_RIGHT, GLFW_KEY_LEFT);
  const double rise = axis(GLFW_KEY_E, GLFW_KEY_Q);
  constexpr double kFast = 5;  // with Shift
  const double fast = impl_->down(GLFW_KEY_LEFT_SHIFT) ? kFast : 1;
  by.move = glm::dvec3(side, rise, ahead) * (fast * seconds);
  return by;
}

std::optional<glm::dvec2> Window::take_aim() { return std::exchange(impl_->aim_at, std::nullopt); }
bool Window::take(WindowCommand command) { return impl_->commands.erase(command) > 0; }

}  // namespace mirage
