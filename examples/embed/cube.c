#define GL_GLEXT_PROTOTYPES
#include "cube.h"

#include <GL/glcorearb.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static GLuint program, vertices;

static const char* const vertex_text =
    "#version 330 core\n"
    "uniform vec3 u_center, u_right, u_up, u_back;\n"
    "uniform float u_edge;\n"
    "uniform vec4 u_tangents;\n" /* left, right, down, up */
    "uniform vec2 u_planes;\n"
    "out vec3 v_normal;\n"
    "void main() {\n"
    "  int face = gl_VertexID / 6, corner = gl_VertexID % 6, axis = face >> 1;\n"
    "  float side = (face & 1) == 0 ? -1.0 : 1.0;\n"
    "  vec2 at = vec2(corner == 1 || corner == 2 || corner == 4, corner == 2 || corner == 4 || corner == 5) * 2.0 - 1.0;\n"
    "  vec3 p = axis == 0 ? vec3(side, at) : axis == 1 ? vec3(at.y, side, at.x) : vec3(at, side);\n"
    "  v_normal = axis == 0 ? vec3(side, 0, 0) : axis == 1 ? vec3(0, side, 0) : vec3(0, 0, side);\n"
    "  mat3 turn = mat3(0.8, 0.0, -0.6, 0.0, 1.0, 0.0, 0.6, 0.0, 0.8);\n"
    "  v_normal = turn * v_normal;\n"
    "  vec3 r = u_center + 0.5 * u_edge * (turn * p);\n" /* relative to the eye */
    "  vec3 v = vec3(dot(r, u_right), dot(r, u_up), dot(r, u_back));\n"
    "  vec4 t = u_tangents;\n"
    "  float n = u_planes.x, f = u_planes.y;\n"
    "  gl_Position = vec4((2.0 * v.x + (t.x + t.y) * v.z) / (t.y - t.x),\n"
    "                     (2.0 * v.y + (t.z + t.w) * v.z) / (t.w - t.z),\n"
    "                     -(f + n) / (f - n) * v.z - 2.0 * f * n / (f - n), -v.z);\n"
    "}\n";
static const char* const fragment_text =
    "#version 330 core\n"
    "in vec3 v_normal;\n"
    "out vec4 o_color;\n"
    "void main() { o_color = vec4(vec3(0.95, 0.55, 0.1) * (0.6 + 0.4 * dot(v_normal, vec3(-0.3, 0.8, 0.5))), 1.0); }\n";

static GLuint shader(GLenum kind, const char* text) {
  GLint compiled = 0;
  const GLuint name = glCreateShader(kind);
  glShaderSource(name, 1, &text, NULL);
  glCompileShader(name);
  glGetShaderiv(name, GL_COMPILE_STATUS, &compiled);
  if (!compiled) {
    char log[1024] = "";
    glGetShaderInfoLog(name, sizeof log, NULL, log);
    fprintf(stderr, "embed: %s\n", log);
    exit(1);
  }
  return name;
}

void make_cube(void) {
  program = glCreateProgram();
  glAttachShader(program, shader(GL_VERTEX_SHADER, vertex_text));
  glAttachShader(program, shader(GL_FRAGMENT_SHADER, fragment_text));
  glLinkProgram(program);
  glGenVertexArrays(1, &vertices);
}

void start_picture(int width, int height) {
  glViewport(0, 0, width, height);
  glClearColor(0.2f, 0.2f, 0.25f, 1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

void draw_cube(const mirage_view* view, const mirage_scene_info* scene) {
  /* At the point that the home view looks at; in places that is near, so some way behind it. */
  double ahead[3], length = 0, away, edge;
  for (int i = 0; i < 3; ++i) ahead[i] = scene->home_look[i] - scene->home_eye[i];
  for (int i = 0; i < 3; ++i) length += ahead[i] * ahead[i];
  length = sqrt(length);
  away = fmax(length, 0.3 * scene->radius);
  edge = 0.15 * away;
  const double *q = view->rotation, x = q[0], y = q[1], z = q[2], w = q[3];
  const double axes[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)},
                             {2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)},
                             {2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)}};
  const char* const names[3] = {"u_right", "u_up", "u_back"};
  glUseProgram(program);
  glBindVertexArray(vertices);
  glEnable(GL_DEPTH_TEST);
  for (int i = 0; i < 3; ++i) {
    glUniform3f(glGetUniformLocation(program, names[i]), (float)axes[i][0], (float)axes[i][1], (float)axes[i][2]);
  }
  for (int i = 0; i < 3; ++i) ahead[i] = scene->home_eye[i] + ahead[i] * away / length - view->eye[i];
  glUniform3f(glGetUniformLocation(program, "u_center"), (float)ahead[0], (float)ahead[1], (float)ahead[2]);
  glUniform1f(glGetUniformLocation(program, "u_edge"), (float)edge);
  glUniform4f(glGetUniformLocation(program, "u_tangents"), (float)view->tan_left, (float)view->tan_right,
              (float)view->tan_down, (float)view->tan_up);
  glUniform2f(glGetUniformLocation(program, "u_planes"), (float)view->near_m, (float)view->far_m);
  glDrawArrays(GL_TRIANGLES, 0, 36);
}

void save_picture(const char* path, int width, int height) {
  unsigned char* rgb = malloc((size_t)width * height * 3);
  FILE* file = fopen(path, "wb");
  if (!rgb || !file) exit(1);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, rgb);
  fprintf(file, "P6\n%d %d\n255\n", width, height);
  for (int row = height - 1; row >= 0; --row) fwrite(rgb + (size_t)row * width * 3, 1, (size_t)width * 3, file);
  if (fclose(file) != 0) exit(1);
  free(rgb);
}
