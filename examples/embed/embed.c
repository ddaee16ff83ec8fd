/* A cube of one's own among the objects of a Mirage scene, in a window of one's own. C99.
 *   embed [URL [PICTURE.ppm]]     drag to turn; with a file, it saves the picture at rest and ends */
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <math.h>
#include <mirage/client.h>
#include <mirage/frame.h>
#include <stdio.h>

#include "cube.h"

static mirage_client* client;

static int failed(const char* what, mirage_result result) {
  mirage_error error = {.size = sizeof error};
  if (result >= 0) return 0;
  mirage_client_error(client, &error);
  fprintf(stderr, "embed: %s: %s: %s %s\n", what, mirage_result_name(result),
          error.text ? error.text : "", error.hint ? error.hint : "");
  return 1;
}

static void log_line(void* user, int32_t level, const char* text) {
  (void)user;
  fprintf(stderr, "%s: %s\n", level == MIRAGE_LOG_ERROR ? "error" : "warning", text);
}

/* A camera that looks from the home view's eye at its target, turned by `turn` radians about it. */
static mirage_view view_of(const mirage_scene_info* scene, double turn, int width, int height) {
  const double x = scene->home_eye[0] - scene->home_look[0], z = scene->home_eye[2] - scene->home_look[2];
  const double up = tan(0.5 * 1.047), side = up * width / height;
  mirage_view view = {.size = sizeof view};
  const double yaw = atan2(x, z) + turn;
  view.eye[0] = scene->home_look[0] + hypot(x, z) * sin(yaw);
  view.eye[1] = scene->home_eye[1];
  view.eye[2] = scene->home_look[2] + hypot(x, z) * cos(yaw);
  view.rotation[1] = sin(0.5 * yaw);
  view.rotation[3] = cos(0.5 * yaw);
  view.tan_left = -side, view.tan_right = side, view.tan_down = -up, view.tan_up = up;
  view.near_m = 0.01 * scene->radius, view.far_m = 10 * scene->radius;
  view.width = width, view.height = height;
  return view;
}

int main(int argc, char** argv) {
  const char* url = argc > 1 ? argv[1] : "ws://127.0.0.1:9870";
  const char* file = argc > 2 ? argv[2] : NULL;
  const mirage_client_desc desc = {
      .size = sizeof desc, .version = MIRAGE_CLIENT_VERSION, .log = log_line, .name = "embed"};
  if (!glfwInit()) return 1;
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  GLFWwindow* window = glfwCreateWindow(640, 360, "A cube among Mirage's objects", NULL, NULL);
  if (!window) return 1;
  glfwMakeContextCurrent(window);
  make_cube();
  if (mirage_client_create(&desc, &client) != MIRAGE_OK) return 1;
  if (failed("connect", mirage_connect(client, url, NULL))) return 1;
  if (failed("attach", mirage_gl_attach(client))) return 1;

  double turn = 0, before = 0;
  while (!glfwWindowShouldClose(window)) {
    int width, height;
    double x, y;
    glfwPollEvents();
    glfwGetFramebufferSize(window, &width, &height);
    glfwGetCursorPos(window, &x, &y);
    if (glfwGetMouseButton(window, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS) turn -= 0.01 * (x - before);
    before = x;
    const int64_t now_us = (int64_t)(glfwGetTime() * 1e6);
    mirage_scene_info scene = {.size = sizeof scene};
    failed("update", mirage_update(client, now_us, NULL));
    start_picture(width, height);
    if (mirage_scene(client, &scene) == MIRAGE_OK && width > 0 && height > 0) {
      const mirage_view view = view_of(&scene, turn, width, height);
      const mirage_target target = {.size = sizeof target};
      mirage_frame_info info = {.size = sizeof info};
      draw_cube(&view, &scene); /* what is behind it is hidden, and it is hidden by what is in front */
      if (!failed("plan", mirage_plan(client, &view, 1, now_us, &info)) && info.samples > 0) {
        failed("draw", mirage_draw(client, 0, &target));
        if (file && info.at_rest) {
          save_picture(file, width, height);
          glfwSetWindowShouldClose(window, 1);
        }
      }
    }
    glfwSwapBuffers(window);
  }
  mirage_gl_detach(client, 0);
  mirage_client_destroy(client);
  glfwTerminate();
  return 0;
}
