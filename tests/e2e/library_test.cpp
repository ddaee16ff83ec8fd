// libmirage-client as a program of others meets it: the shared library, a server, a context of its
// own, and what goes wrong.
#include <OpenImageIO/imageio.h>

#include <csignal>
#include <fstream>
#include <functional>
#include <limits>

#include "tests/support/failing_memory.h"
#include "tests/support/library_fixture.h"

namespace mirage::test {
namespace {

/// Returns the last frame of a still eye in mirage-view, the bottom row first. On virtual time all
/// tiles are there by then, however busy the machine is.
Pixels by_viewer(const Server& server) {
  const std::string folder = scratch_folder();
  const Finished done = run(
      {binary("mirage-view"), server.url(), "--offscreen",
       std::to_string(kWidth) + "x" + std::to_string(kHeight), "--frames", "300", "--virtual-time",
       "--frame-ms", "0", "--msaa", "1", "--path", "#eye=0,0,9&look=0,0,0", "--out", folder},
      200);
  EXPECT_EQ(done.exit_code, 0) << done.output;
  const auto in = OIIO::ImageInput::open(folder + "/frame_00299.png");
  if (!in) return {};
  constexpr std::size_t kRow = std::size_t{4} * kWidth;
  Pixels top_first(kRow * kHeight, 255), out(top_first.size());
  EXPECT_TRUE(
      in->read_image(0, 0, 0, in->spec().nchannels, OIIO::TypeDesc::UINT8, top_first.data(), 4));
  for (std::size_t y = 0; y < kHeight; ++y) {
    std::copy_n(&top_first[(kHeight - 1 - y) * kRow], kRow, &out[y * kRow]);
  }
  return out;
}

// Geometry would be worth its bytes or not by how fast it comes, so there is none.
TEST_F(Library, ThePictureIsThatOfTheViewerInEveryKindOfFramebuffer) {
  const Server server("builtin:knot", {"--no-geometry"});
  ASSERT_TRUE(server.ready()) << server.log();
  const Pixels expected = by_viewer(server);
  LibraryClient client(server.url());
  const Canvas plain, encoding(GL_SRGB8_ALPHA8);
  const mirage_view view = view_from(9);
  EXPECT_EQ(different(client.picture(plain, view), expected), 0u);
  encoding.clear(1);
  mirage_target target = encoding.target();
  target.color = MIRAGE_COLOR_SRGB;
  ASSERT_EQ(mirage_composite(client.get(), 0, &target), MIRAGE_OK);
  EXPECT_EQ(different(encoding.read(), expected), 0u);
}

TEST_F(Library, ThePictureLiesWhereTheTargetSays) {
  LibraryClient client(server_.url());
  const Canvas own, large(GL_RGBA8, 2 * kWidth, 2 * kHeight);
  const Pixels picture = client.picture(own, view_from(9));
  large.clear(1);
  mirage_target target = large.target();
  target.x = 33;
  target.y = 21;
  ASSERT_EQ(mirage_composite(client.get(), 0, &target), MIRAGE_OK);
  const Pixels all = large.read();
  std::size_t outside = 0, inside = 0;
  for (int y = 0; y < 2 * kHeight; ++y) {
    for (int x = 0; x < 2 * kWidth; ++x) {
      const std::size_t at = std::size_t{4} * static_cast<std::size_t>(y * 2 * kWidth + x);
      const int px = x - 33, py = y - 21;
      if (px < 0 || py < 0 || px >= kWidth || py >= kHeight) {
        outside += all[at] + all[at + 1] + all[at + 2] > 0 ? 1 : 0;
        continue;
      }
      const std::size_t of = std::size_t{4} * static_cast<std::size_t>(py * kWidth + px);
      for (std::size_t c = 0; c < 3; ++c) inside += all[at + c] != picture[of + c] ? 1 : 0;
    }
  }
  EXPECT_EQ(outside, 0u);
  EXPECT_EQ(inside, 0u);
}

// Window depth of a plane at a distance, as the host's projection has it.
double host_depth(const mirage_view& view, double d) {
  const double n = view.near_m, f = view.far_m;
  if (view.depth == MIRAGE_DEPTH_LOGARITHMIC) return std::log2(1 + d) / std::log2(1 + f);
  if (view.depth == MIRAGE_DEPTH_REVERSED) return f > 0 ? n * (f - d) / (d * (f - n)) : n / d;
  return f > 0 ? f * (d - n) / (d * (f - n)) : 1 - n / d;
}

// A plane of the host through the middle of the knot hides its far half, however depth is kept; and
// the depth that is written is that of the knot: the near half is in front of the plane everywhere.
TEST_F(Library, ThePictureAndTheHostHideEachOtherByDepth) {
  LibraryClient client(server_.url());
  const Canvas canvas;
  const Pixels whole = client.picture(canvas, view_from(9));
  std::vector<std::size_t> seen;
  for (const auto& [kind, far] : {std::pair{MIRAGE_DEPTH_FORWARD, kFar},
                                  {MIRAGE_DEPTH_FORWARD, 0.0},
                                  {MIRAGE_DEPTH_REVERSED, kFar},
                                  {MIRAGE_DEPTH_REVERSED, 0.0},
                                  {MIRAGE_DEPTH_LOGARITHMIC, kFar}}) {
    mirage_view view = view_from(9);
    view.depth = kind;
    view.far_m = far;
    const bool reversed = kind == MIRAGE_DEPTH_REVERSED;
    const auto plane = static_cast<float>(host_depth(view, 9));
    const Pixels cut = client.picture(canvas, view, plane);
    std::size_t shown = 0;
    const std::vector<float> depth = canvas.depth();
    for (std::size_t i = 0; i < depth.size(); ++i) {
      const bool drawn = cut[4 * i] + cut[4 * i + 1] + cut[4 * i + 2] > 0;
      shown += drawn ? 1 : 0;
      const bool nearer = reversed ? depth[i] > plane : depth[i] < plane;
      EXPECT_EQ(drawn, nearer || (drawn && depth[i] == plane)) << "pixel " << i;
    }
    seen.push_back(shown);
    // The picture behind the plane at the far end shows whole.
    const Pixels behind = client.picture(canvas, view, reversed ? 0 : 1);
    EXPECT_EQ(different(behind, whole), 0u) << "kind " << kind;
  }
  EXPECT_GT(seen[0], 200u);
  EXPECT_LT(seen[0], std::size_t{kWidth} * kHeight / 4) << "the sky is behind the plane";
  const auto [fewest, most] = std::minmax_element(seen.begin(), seen.end());
  EXPECT_LE(*most - *fewest, 4u) << "the same, however it is kept";
}

TEST_F(Library, DistanceOfTheKnotIsKnownUnderTheCursor) {
  LibraryClient client(server_.url());
  const Canvas canvas;
  ASSERT_TRUE(client.rest(view_from(9), canvas.target()));
  double distance = 0;
  ASSERT_EQ(mirage_depth_at(client.get(), 0, kWidth / 2 + 8, kHeight / 2, &distance), MIRAGE_OK);
  EXPECT_GT(distance, 6);
  EXPECT_LT(distance, 10);
  EXPECT_EQ(mirage_depth_at(client.get(), 0, 1, 1, &distance), MIRAGE_NOT_YET);
  EXPECT_EQ(mirage_depth_at(client.get(), 0, -1, 1, &distance), MIRAGE_BAD_ARGUMENT);
}

// Without the sky, the host's picture stays where there is no object.
TEST_F(Library, WithoutItsSkyThePictureIsLaidOverTheHosts) {
  LibraryClient client(server_.url());
  mirage_options options = sized<mirage_options>();
  ASSERT_EQ(mirage_get_options(client.get(), &options), MIRAGE_OK);
  options.no_sky = 1;
  ASSERT_EQ(mirage_set_options(client.get(), &options), MIRAGE_OK);
  const Canvas canvas;
  ASSERT_TRUE(client.rest(view_from(9), canvas.target()));
  glBindFramebuffer(GL_FRAMEBUFFER, canvas.target().framebuffer);
  glClearColor(0, 0, 1, 1);
  glClearDepth(1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  const mirage_target target = canvas.target();
  ASSERT_EQ(mirage_composite(client.get(), 0, &target), MIRAGE_OK);
  const Pixels mixed = canvas.read();
  std::size_t host = 0, knot = 0, edge = 0;
  for (std::size_t i = 0; i < mixed.size(); i += 4) {
    const bool blue = mixed[i] == 0 && mixed[i + 1] == 0 && mixed[i + 2] == 255;
    const bool orange = mixed[i] > mixed[i + 2];
    ++(blue ? host : orange ? knot : edge);
  }
  EXPECT_GT(host, 5000u);
  EXPECT_GT(knot, 500u);
  EXPECT_LT(edge, knot / 2) << "mixed along the outline only";
}

// A scene that stands elsewhere, turned and ten times as large looks the same from there.
TEST_F(Library, AMovedSceneIsSeenFromWhereItStands) {
  LibraryClient client(server_.url());
  const Canvas canvas;
  const Pixels plain = client.picture(canvas, view_from(9));
  const std::vector<float> depth = canvas.depth();
  mirage_transform moved = sized<mirage_transform>();
  moved.rotation[1] = std::sqrt(0.5);  // a quarter turn about y: -z becomes -x
  moved.rotation[3] = std::sqrt(0.5);
  moved.translation[0] = 1000;
  moved.translation[1] = -20;
  moved.scale = 10;
  ASSERT_EQ(mirage_set_transform(client.get(), &moved), MIRAGE_OK);
  mirage_view view = view_from(0);
  view.eye[0] = 1000 + 90;
  view.eye[1] = -20;
  view.rotation[1] = moved.rotation[1];
  view.rotation[3] = moved.rotation[3];
  view.near_m *= 10;
  view.far_m *= 10;
  EXPECT_EQ(different(client.picture(canvas, view), plain, 1), 0u);
  const std::vector<float> again = canvas.depth();
  for (std::size_t i = 0; i < depth.size(); ++i) ASSERT_NEAR(again[i], depth[i], 1e-4);
  mirage_scene_info info = sized<mirage_scene_info>();
  ASSERT_EQ(mirage_scene(client.get(), &info), MIRAGE_OK);
  EXPECT_NEAR(info.center[0], 1000, 1);
  EXPECT_NEAR(info.home_eye[0], 1000 + 10 * 4, 5);
  EXPECT_STREQ(info.name, "builtin:knot");
}

// An asymmetric camera sees a part of what a symmetric one sees.
TEST_F(Library, APartOfTheViewIsThatPartOfThePicture) {
  LibraryClient client(server_.url());
  const Canvas canvas, part(GL_RGBA8, kWidth / 2, kHeight);
  const Pixels whole = client.picture(canvas, view_from(9));
  mirage_view right = view_from(9);
  right.tan_left = 0;
  right.width = kWidth / 2;
  const Pixels half = client.picture(part, right);
  std::size_t apart = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth / 2; ++x) {
      const auto of = static_cast<std::size_t>(4 * (y * kWidth + x + kWidth / 2));
      const auto at = static_cast<std::size_t>(4 * (y * (kWidth / 2) + x));
      for (std::size_t c = 0; c < 3; ++c) {
        apart += std::abs(int{whole[of + c]} - int{half[at + c]}) > 3 ? 1 : 0;
      }
    }
  }
  EXPECT_LT(apart, 60u) << "of " << 3 * kWidth / 2 * kHeight;
}

/// GL values of a context, as numbers.
std::vector<double> values() {
  std::vector<double> out;
  const auto numbers = [&](GLenum name, int count) {
    std::array<GLfloat, 4> v{};
    glGetFloatv(name, v.data());
    out.insert(out.end(), v.begin(), v.begin() + count);
  };
  for (const GLenum name : {GL_DEPTH_TEST,
                            GL_BLEND,
                            GL_CULL_FACE,
                            GL_SCISSOR_TEST,
                            GL_STENCIL_TEST,
                            GL_POLYGON_OFFSET_FILL,
                            GL_SAMPLE_ALPHA_TO_COVERAGE,
                            GL_SAMPLE_COVERAGE,
                            GL_RASTERIZER_DISCARD,
                            GL_FRAMEBUFFER_SRGB,
                            GL_SAMPLE_SHADING,
                            GL_PROGRAM_POINT_SIZE,
                            GL_COLOR_LOGIC_OP,
                            GL_PRIMITIVE_RESTART,
                            GL_PRIMITIVE_RESTART_FIXED_INDEX,
                            GL_DEPTH_CLAMP,
                            GL_SAMPLE_MASK,
                            GL_SAMPLE_ALPHA_TO_ONE,
                            GL_POLYGON_SMOOTH,
                            GL_LINE_SMOOTH,
                            GL_MULTISAMPLE,
                            GL_DITHER,
                            GL_CLIP_DISTANCE0,
                            GL_CLIP_DISTANCE1,
                            GL_TEXTURE_CUBE_MAP_SEAMLESS}) {
    out.push_back(glIsEnabled(name));
  }
  for (const GLenum name : {GL_DEPTH_FUNC,
                            GL_DEPTH_WRITEMASK,
                            GL_DEPTH_CLEAR_VALUE,
                            GL_BLEND_SRC_RGB,
                            GL_BLEND_SRC_ALPHA,
                            GL_BLEND_DST_RGB,
                            GL_BLEND_DST_ALPHA,
                            GL_BLEND_EQUATION_RGB,
                            GL_BLEND_EQUATION_ALPHA,
                            GL_CULL_FACE_MODE,
                            GL_FRONT_FACE,
                            GL_CLIP_ORIGIN,
                            GL_CLIP_DEPTH_MODE,
                            GL_PROVOKING_VERTEX,
                            GL_LINE_WIDTH,
                            GL_MIN_SAMPLE_SHADING_VALUE,
                            GL_CURRENT_PROGRAM,
                            GL_VERTEX_ARRAY_BINDING,
                            GL_ARRAY_BUFFER_BINDING,
                            GL_PIXEL_PACK_BUFFER_BINDING,
                            GL_PIXEL_UNPACK_BUFFER_BINDING,
                            GL_READ_FRAMEBUFFER_BINDING,
                            GL_DRAW_FRAMEBUFFER_BINDING,
                            GL_RENDERBUFFER_BINDING,
                            GL_ACTIVE_TEXTURE,
                            GL_UNPACK_ALIGNMENT,
                            GL_UNPACK_ROW_LENGTH,
                            GL_UNPACK_SKIP_ROWS,
                            GL_UNPACK_SKIP_PIXELS,
                            GL_UNPACK_IMAGE_HEIGHT,
                            GL_UNPACK_SKIP_IMAGES,
                            GL_UNPACK_SWAP_BYTES,
                            GL_UNPACK_LSB_FIRST,
                            GL_PACK_ALIGNMENT,
                            GL_PACK_ROW_LENGTH,
                            GL_PACK_SKIP_ROWS,
                            GL_PACK_SKIP_PIXELS,
                            GL_PACK_SWAP_BYTES,
                            GL_STENCIL_FUNC,
                            GL_STENCIL_WRITEMASK,
                            GL_LOGIC_OP_MODE}) {
    numbers(name, 1);
  }
  numbers(GL_DEPTH_RANGE, 2);
  numbers(GL_POLYGON_MODE, 2);
  for (const GLenum name :
       {GL_VIEWPORT, GL_SCISSOR_BOX, GL_COLOR_CLEAR_VALUE, GL_BLEND_COLOR, GL_COLOR_WRITEMASK}) {
    numbers(name, 4);
  }
  std::array<GLfloat, 4> attribute{};
  for (GLuint i = 1; i < 16; ++i) {
    glGetVertexAttribfv(i, GL_CURRENT_VERTEX_ATTRIB, attribute.data());
    out.insert(out.end(), attribute.begin(), attribute.end());
  }
  GLint unit = 0;
  glGetIntegerv(GL_ACTIVE_TEXTURE, &unit);
  for (GLenum i = 0; i < 16; ++i) {
    glActiveTexture(GL_TEXTURE0 + i);
    for (const GLenum name :
         {GL_TEXTURE_BINDING_2D, GL_TEXTURE_BINDING_2D_ARRAY, GL_TEXTURE_BINDING_CUBE_MAP,
          GL_TEXTURE_BINDING_3D, GL_SAMPLER_BINDING}) {
      numbers(name, 1);
    }
  }
  glActiveTexture(static_cast<GLenum>(unit));
  return out;
}

/// Sets everything to something that a renderer would stumble over.
void set_odd_values() {
  for (const GLenum name :
       {GL_SCISSOR_TEST, GL_STENCIL_TEST, GL_BLEND, GL_CULL_FACE, GL_DEPTH_TEST,
        GL_POLYGON_OFFSET_FILL, GL_SAMPLE_ALPHA_TO_COVERAGE, GL_RASTERIZER_DISCARD,
        GL_COLOR_LOGIC_OP, GL_PRIMITIVE_RESTART, GL_DEPTH_CLAMP, GL_SAMPLE_MASK, GL_CLIP_DISTANCE0,
        GL_CLIP_DISTANCE1, GL_FRAMEBUFFER_SRGB, GL_SAMPLE_SHADING}) {
    glEnable(name);
  }
  glDisable(GL_MULTISAMPLE);
  glScissor(3, 4, 5, 6);
  glStencilFunc(GL_NEVER, 1, 255);
  glBlendFuncSeparate(GL_ZERO, GL_ONE, GL_DST_COLOR, GL_SRC_ALPHA);
  glBlendEquationSeparate(GL_MIN, GL_FUNC_REVERSE_SUBTRACT);
  glBlendColor(0.1f, 0.2f, 0.3f, 0.4f);
  glCullFace(GL_FRONT_AND_BACK);
  glFrontFace(GL_CW);
  glDepthFunc(GL_NEVER);
  glDepthMask(GL_FALSE);
  glClearDepth(0.25);
  glDepthRange(0.75, 0.25);
  glColorMask(GL_TRUE, GL_FALSE, GL_TRUE, GL_FALSE);
  glClearColor(0.5f, 0.25f, 0.75f, 0.125f);
  glViewport(7, 8, 9, 10);
  glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
  glPolygonOffset(10, 1000);
  glClipControl(GL_UPPER_LEFT, GL_ZERO_TO_ONE);
  glProvokingVertex(GL_FIRST_VERTEX_CONVENTION);
  glLogicOp(GL_XOR);
  glSampleMaski(0, 0);
  glPrimitiveRestartIndex(2);
  glMinSampleShading(0.5f);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 8);
  for (const GLenum name : {GL_UNPACK_ROW_LENGTH, GL_UNPACK_SKIP_ROWS, GL_UNPACK_SKIP_PIXELS,
                            GL_UNPACK_IMAGE_HEIGHT, GL_UNPACK_SKIP_IMAGES, GL_UNPACK_SWAP_BYTES,
                            GL_PACK_ROW_LENGTH, GL_PACK_SKIP_ROWS, GL_PACK_SKIP_PIXELS}) {
    glPixelStorei(name, 1);
  }
  std::array<GLuint, 4> names{};
  glGenBuffers(3, names.data());
  glBindBuffer(GL_ARRAY_BUFFER, names[0]);
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, names[1]);
  glBindBuffer(GL_PIXEL_PACK_BUFFER, names[2]);
  glGenVertexArrays(1, &names[3]);
  glBindVertexArray(names[3]);
  GLuint sampler = 0, texture = 0;
  glGenSamplers(1, &sampler);
  glSamplerParameteri(sampler, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glSamplerParameteri(sampler, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glSamplerParameteri(sampler, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glGenTextures(1, &texture);
  for (GLuint i = 0; i < 16; ++i) {
    glActiveTexture(GL_TEXTURE0 + i);
    glBindTexture(GL_TEXTURE_2D, texture);
    glBindSampler(i, sampler);
  }
  glVertexAttrib4f(5, 0.5f, 0, 0.25f, 1);
  glActiveTexture(GL_TEXTURE7);
}

// Each call with GL, from the first program to the picture at rest, in a context where everything
// is set to something odd.
TEST_F(Library, GlValuesStayAndOddOnesChangeNoPicture) {
  const Canvas usual;
  Pixels expected;
  {
    LibraryClient client(server_.url(), 4);
    expected = client.picture(usual, view_from(9));
  }
  Result<gl::EglContext> second = gl::EglContext::create("auto");
  ASSERT_TRUE(second.ok());
  const Canvas canvas;
  set_odd_values();
  const std::vector<double> before = values();
  ASSERT_EQ(glGetError(), GLenum{GL_NO_ERROR});
  const auto check = [&](const char* call) {
    const std::vector<double> now = values();
    for (std::size_t i = 0; i < now.size(); ++i) {
      ASSERT_EQ(now[i], before[i]) << call << ", value " << i;
    }
    ASSERT_EQ(glGetError(), GLenum{GL_NO_ERROR}) << call;
  };
  {
    LibraryClient client(server_.url(), 4);
    check("attach");
    const mirage_view view = view_from(9);
    mirage_target target = canvas.target();
    target.no_depth = 1;  // an earlier, coarser picture would hide the edges
    bool rests = false;
    for (int i = 0; i < 3000 && !rests; ++i) {
      ASSERT_EQ(mirage_update(client.get(), clock_us(), nullptr), MIRAGE_OK);
      check("update");
      mirage_frame_info info = sized<mirage_frame_info>();
      if (mirage_plan(client.get(), &view, 1, clock_us(), &info) == MIRAGE_OK) {
        check("plan");
        ASSERT_EQ(mirage_draw(client.get(), 0, &target), MIRAGE_OK);
        check("draw");
        mirage_textures textures = sized<mirage_textures>();
        ASSERT_EQ(mirage_draw_textures(client.get(), 0, &textures), MIRAGE_OK);
        check("draw_textures");
        rests = info.at_rest == 1;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    ASSERT_TRUE(rests);
  }
  check("detach");
  // Read with values as they are at first.
  for (const GLenum name : {GL_SCISSOR_TEST, GL_RASTERIZER_DISCARD, GL_FRAMEBUFFER_SRGB}) {
    glDisable(name);
  }
  glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  for (const GLenum name : {GL_PACK_ROW_LENGTH, GL_PACK_SKIP_ROWS, GL_PACK_SKIP_PIXELS}) {
    glPixelStorei(name, 0);
  }
  EXPECT_EQ(different(canvas.read(), expected), 0u);
  second = gl::EglContext::create("auto");
}

// OpenGL ES 3.0 draws forward depth and always encodes sRGB targets; the picture is nearly the
// same.
TEST_F(Library, OpenGlEsDrawsThePictureAsWell) {
  const mirage_view view = view_from(9);
  Pixels expected;
  {
    const Canvas canvas;
    LibraryClient client(server_.url());
    expected = client.picture(canvas, view);
  }
  Result<gl::EglContext> embedded = gl::EglContext::create("auto", true);
  ASSERT_TRUE(embedded.ok());
  {
    const Canvas canvas;
    const std::vector<GLenum> names = {GL_DEPTH_FUNC,     GL_BLEND_SRC_RGB,   GL_CULL_FACE_MODE,
                                       GL_ACTIVE_TEXTURE, GL_CURRENT_PROGRAM, GL_UNPACK_ALIGNMENT};
    const auto values_of = [&] {
      std::vector<GLint> out(names.size());
      for (std::size_t i = 0; i < names.size(); ++i) glGetIntegerv(names[i], &out[i]);
      return out;
    };
    glDepthFunc(GL_ALWAYS);
    glCullFace(GL_FRONT);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 8);
    const std::vector<GLint> before = values_of();
    LibraryClient client(server_.url());
    const Pixels picture = client.picture(canvas, view);
    EXPECT_LT(different(picture, expected, 8), expected.size() / 200);
    EXPECT_EQ(values_of(), before);
    EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
  }
  *embedded = gl::EglContext();
  egl_.make_current();
}

TEST_F(Library, TwoClientsInOneProgramDrawAsEachAlone) {
  const Server other("builtin:knot?r=0.2");
  const Canvas canvas;
  const mirage_view view = view_from(9);
  LibraryClient one(server_.url());
  const Pixels alone = one.picture(canvas, view);
  LibraryClient two(other.url());
  const Pixels thin = two.picture(canvas, view);
  EXPECT_GT(different(alone, thin), 1000u);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(different(one.picture(canvas, view), alone), 0u);
    EXPECT_EQ(different(two.picture(canvas, view), thin), 0u);
  }
}

TEST_F(Library, AfterALostContextThePictureComesBackInTheNextOne) {
  LibraryClient client(server_.url());
  const mirage_view view = view_from(9);
  Pixels before;
  {
    const Canvas canvas;
    before = client.picture(canvas, view);
  }
  egl_ = gl::EglContext();  // with all names of the client
  Result<gl::EglContext> next = gl::EglContext::create("auto");
  ASSERT_TRUE(next.ok());
  GLuint names[64] = {};
  glGenTextures(64, names);  // names that the lost context has had as well
  for (const GLuint name : names) glBindTexture(GL_TEXTURE_2D, name);
  ASSERT_EQ(mirage_gl_detach(client.get(), 1), MIRAGE_OK);
  for (const GLuint name : names) EXPECT_TRUE(glIsTexture(name)) << "another's was deleted";
  mirage_target target = sized<mirage_target>();
  EXPECT_EQ(mirage_draw(client.get(), 0, &target), MIRAGE_WRONG_STATE);
  ASSERT_EQ(mirage_gl_attach(client.get()), MIRAGE_OK);
  const Canvas canvas;
  EXPECT_EQ(different(client.picture(canvas, view), before), 0u);
  egl_ = std::move(*next);
}

TEST_F(Library, AServerThatGoesAwayLeavesThePicture) {
  LibraryClient client(server_.url());
  const Canvas canvas;
  const mirage_view view = view_from(9);
  const Pixels before = client.picture(canvas, view);
  const mirage_target target = canvas.target();
  server_.stop(SIGTERM);
  std::uint32_t events = 0, all = 0;
  for (int i = 0; i < 500 && (all & MIRAGE_EVENT_DOWN) == 0; ++i) {
    mirage_update(client.get(), clock_us(), &events);
    all |= events;
    ASSERT_EQ(mirage_plan(client.get(), &view, 1, clock_us(), nullptr), MIRAGE_OK);
    ASSERT_EQ(mirage_draw(client.get(), 0, &target), MIRAGE_OK);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_TRUE(all & MIRAGE_EVENT_DOWN);
  EXPECT_EQ(different(canvas.read(), before), 0u);
  ASSERT_EQ(mirage_disconnect(client.get()), MIRAGE_OK);
  ASSERT_EQ(mirage_update(client.get(), clock_us(), nullptr), MIRAGE_OK);
  ASSERT_EQ(mirage_plan(client.get(), &view, 1, clock_us(), nullptr), MIRAGE_OK);
  const Server again("builtin:knot?r=0.2");
  ASSERT_EQ(mirage_connect(client.get(), again.url().c_str(), nullptr), MIRAGE_OK);
  bool other = false;
  for (int i = 0; i < 100 && !other; ++i)
    other = different(client.picture(canvas, view), before) > 0;
  EXPECT_TRUE(other) << "another server, another picture";
}

TEST_F(Library, BadInputIsAnErrorValue) {
  mirage_client* none = nullptr;
  EXPECT_EQ(mirage_client_create(nullptr, &none), MIRAGE_BAD_ARGUMENT);
  EXPECT_EQ(mirage_client_create(nullptr, nullptr), MIRAGE_BAD_ARGUMENT);
  mirage_client_desc desc = sized<mirage_client_desc>();
  desc.version = 7'000'000;
  EXPECT_EQ(mirage_client_create(&desc, &none), MIRAGE_UNSUPPORTED);
  desc.version = MIRAGE_CLIENT_VERSION;
  for (const auto& change : std::vector<std::function<void(mirage_client_desc&)>>{
           [](auto& d) { d.atlas_mb = -1; }, [](auto& d) { d.samples = 99; },
           [](auto& d) { d.tau_px = std::nan(""); }, [](auto& d) { d.size = 0; }}) {
    mirage_client_desc bad = desc;
    change(bad);
    EXPECT_EQ(mirage_client_create(&bad, &none), MIRAGE_BAD_ARGUMENT);
    EXPECT_EQ(none, nullptr);
  }
  // A program of an older library has a shorter struct, one of a newer a longer one.
  desc.size = 2 * sizeof(std::uint32_t);
  ASSERT_EQ(mirage_client_create(&desc, &none), MIRAGE_OK);
  EXPECT_EQ(mirage_update(none, 0, nullptr), MIRAGE_WRONG_STATE);
  EXPECT_EQ(mirage_connect(none, "ftp://nonsense", nullptr), MIRAGE_BAD_ARGUMENT);
  mirage_error error = sized<mirage_error>();
  EXPECT_EQ(mirage_client_error(none, &error), MIRAGE_OK);
  EXPECT_EQ(error.result, MIRAGE_BAD_ARGUMENT);
  EXPECT_STREQ(error.id, "usage");
  EXPECT_STRNE(error.text, "");
  mirage_client_destroy(none);
  mirage_client_destroy(nullptr);
  EXPECT_EQ(mirage_connect(nullptr, "ws://x", nullptr), MIRAGE_BAD_ARGUMENT);

  LibraryClient client(server_.url());
  const Canvas canvas;
  const mirage_view good = view_from(9);
  const mirage_target target = canvas.target();
  EXPECT_EQ(mirage_draw(client.get(), 0, &target), MIRAGE_WRONG_STATE) << "before a plan";
  const Pixels before = client.picture(canvas, good);
  const double inf = std::numeric_limits<double>::infinity();
  for (const auto& change : std::vector<std::function<void(mirage_view&)>>{
           [](auto& v) { v.width = 0; }, [](auto& v) { v.height = 16385; },
           [](auto& v) { v.tan_left = v.tan_right; },
           [](auto& v) { std::swap(v.tan_left, v.tan_right); },
           [](auto& v) { v.tan_up = std::nan(""); }, [inf](auto& v) { v.tan_up = inf; },
           [](auto& v) { v.eye[1] = std::nan(""); }, [](auto& v) { v.eye[0] = 1e300; },
           [](auto& v) { v.rotation[0] = 5; }, [](auto& v) { v.rotation[3] = std::nan(""); },
           [](auto& v) { v.near_m = 0; }, [](auto& v) { v.far_m = 0.01; },
           [](auto& v) { v.depth = 9; }, [](auto& v) { v.size = 3; },
           [](auto& v) { v.depth = MIRAGE_DEPTH_LOGARITHMIC, v.far_m = 0; }}) {
    mirage_view bad = good;
    change(bad);
    EXPECT_EQ(mirage_plan(client.get(), &bad, 1, clock_us(), nullptr), MIRAGE_BAD_ARGUMENT);
  }
  EXPECT_EQ(mirage_plan(client.get(), nullptr, 1, clock_us(), nullptr), MIRAGE_BAD_ARGUMENT);
  EXPECT_EQ(mirage_update(client.get(), 5, nullptr), MIRAGE_BAD_ARGUMENT) << "time goes back";
  ASSERT_EQ(mirage_plan(client.get(), &good, 1, clock_us(), nullptr), MIRAGE_OK);
  EXPECT_EQ(mirage_draw(client.get(), 1, &target), MIRAGE_BAD_ARGUMENT);
  mirage_target strange = target;
  strange.color = 7;
  EXPECT_EQ(mirage_draw(client.get(), 0, &strange), MIRAGE_BAD_ARGUMENT);
  mirage_transform flat = sized<mirage_transform>();
  flat.scale = -1;
  EXPECT_EQ(mirage_set_transform(client.get(), &flat), MIRAGE_BAD_ARGUMENT);
  mirage_light dark{};
  mirage_lighting lighting = sized<mirage_lighting>();
  lighting.count = 1;
  lighting.lights = &dark;
  EXPECT_EQ(mirage_set_lighting(client.get(), &lighting), MIRAGE_BAD_ARGUMENT) << "no direction";
  std::thread([&] {
    EXPECT_EQ(mirage_update(client.get(), clock_us(), nullptr), MIRAGE_WRONG_THREAD);
  }).join();
  mirage_target nowhere = target;
  nowhere.framebuffer = 777;
  ASSERT_EQ(mirage_plan(client.get(), &good, 1, clock_us(), nullptr), MIRAGE_OK);
  EXPECT_EQ(mirage_draw(client.get(), 0, &nowhere), MIRAGE_BAD_ARGUMENT);
  EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
  EXPECT_EQ(different(client.picture(canvas, good), before), 0u) << "nothing of it did harm";
}

/// Runs a call whose allocations fail from the `nth` on. Returns false if it took fewer.
template <typename Call>
bool without_memory(long nth, const Call& call) {
  allocations_left = nth;
  call();
  const bool failed = allocations_left == 0;
  allocations_left = -1;
  return failed;
}

// Memory runs out at any point of any call, then is there again: no crash, and in the end the same
// picture.
TEST_F(Library, WhereverMemoryRunsOutThePictureComesBack) {
  const Canvas canvas;
  const mirage_view view = view_from(9), aside = view_from(8.5);
  const mirage_target target = canvas.target();
  int failures = 0;
  const auto may_fail = [&](mirage_result result) {
    failures += result == MIRAGE_OUT_OF_MEMORY ? 1 : 0;
    EXPECT_TRUE(result == MIRAGE_OK || result == MIRAGE_NOT_YET || result == MIRAGE_WRONG_STATE ||
                result == MIRAGE_OUT_OF_MEMORY)
        << mirage_result_name(result);
  };
  Pixels expected;
  {
    LibraryClient client(server_.url());
    expected = client.picture(canvas, view);
    bool more = true;
    for (long nth = 0; more && nth < 20'000; nth += 1 + nth / 2) {
      more = without_memory(nth, [&] {
        may_fail(mirage_update(client.get(), clock_us(), nullptr));
        may_fail(mirage_plan(client.get(), &aside, 1, clock_us(), nullptr));
        may_fail(mirage_draw(client.get(), 0, &target));
        may_fail(mirage_reference_ask(client.get(), &aside));
      });
      // Also while a session begins.
      may_fail(mirage_update(client.get(), clock_us(), nullptr));
    }
    EXPECT_EQ(different(client.picture(canvas, view), expected), 0u);
  }
  mirage_client_desc desc = sized<mirage_client_desc>();
  desc.version = MIRAGE_CLIENT_VERSION;
  bool more = true;
  for (long nth = 0; more && nth < 100'000; nth += 1 + nth) {
    mirage_client* client = nullptr;
    more = without_memory(nth, [&] {
      may_fail(mirage_client_create(&desc, &client));
      if (!client) return;
      may_fail(mirage_connect(client, server_.url().c_str(), nullptr));
      may_fail(mirage_gl_attach(client));
      mirage_update(client, clock_us(), nullptr);
    });
    mirage_gl_detach(client, 0);
    mirage_client_destroy(client);
  }
  EXPECT_GT(failures, 20);
  LibraryClient after(server_.url());
  EXPECT_EQ(different(after.picture(canvas, view), expected), 0u);
}

// A call with GL in no context, or in another one, does nothing; afterwards the picture is right.
TEST_F(Library, AnotherContextThanThatOfAttachIsRefused) {
  LibraryClient client(server_.url());
  const Canvas canvas;
  const mirage_view view = view_from(9);
  const mirage_target target = canvas.target();
  ASSERT_EQ(mirage_update(client.get(), clock_us(), nullptr), MIRAGE_OK);
  Result<gl::EglContext> other = gl::EglContext::create("auto");
  ASSERT_TRUE(other.ok());
  GLuint samplers[8] = {};
  glGenSamplers(8, samplers);  // names that the client has as well
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(mirage_update(client.get(), clock_us(), nullptr), MIRAGE_GRAPHICS);
    EXPECT_EQ(mirage_plan(client.get(), &view, 1, clock_us(), nullptr), MIRAGE_GRAPHICS);
    EXPECT_EQ(mirage_draw(client.get(), 0, &target), MIRAGE_GRAPHICS);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));  // tiles arrive meanwhile
  }
  EXPECT_EQ(mirage_gl_detach(client.get(), 0), MIRAGE_GRAPHICS);
  EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
  *other = gl::EglContext();  // none is current
  EXPECT_EQ(mirage_update(client.get(), clock_us(), nullptr), MIRAGE_GRAPHICS);
  mirage_error error = sized<mirage_error>();
  ASSERT_EQ(mirage_client_error(client.get(), &error), MIRAGE_OK);
  EXPECT_STREQ(error.text, "no GL context is current");
  egl_.make_current();
  const Pixels picture = client.picture(canvas, view);
  LibraryClient second(server_.url());
  EXPECT_EQ(different(second.picture(canvas, view), picture), 0u);
}

/// Updates until a problem is told, 20 s at most. Returns its line; empty: none was.
std::string problem_of(mirage_client* client) {
  std::uint32_t events = 0;
  for (int i = 0; i < 4000; ++i) {
    EXPECT_EQ(mirage_update(client, clock_us(), &events), MIRAGE_OK);
    if ((events & MIRAGE_EVENT_PROBLEM) != 0) {
      mirage_error error = sized<mirage_error>();
      EXPECT_EQ(mirage_client_error(client, &error), MIRAGE_OK);
      return std::string(mirage_result_name(error.result)) + ": " + error.text;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return {};
}

TEST_F(Library, WhoeverDoesNotAnswerIsTold) {
  for (const char* url :
       {"ws://127.0.0.1:1", "ws://no.such.host.invalid:9870", "unix:/nonexistent/socket", "foo"}) {
    LibraryClient nowhere(url);
    const std::string problem = problem_of(nowhere.get());
    EXPECT_EQ(problem.rfind("network: no server answers at ", 0), 0u) << url << ": " << problem;
    const mirage_view view = view_from(9);
    EXPECT_EQ(mirage_plan(nowhere.get(), &view, 1, clock_us(), nullptr), MIRAGE_NOT_YET);
    mirage_scene_info scene = sized<mirage_scene_info>();
    EXPECT_EQ(mirage_scene(nowhere.get(), &scene), MIRAGE_NOT_YET);
  }
  LibraryClient choosy(server_.url() + "?clip=nope");
  EXPECT_EQ(problem_of(choosy.get()), "bad-argument: the scene has no clip 'nope'");
}

TEST_F(Library, AWrongTokenIsTold) {
  const std::string file = scratch_folder() + "/tokens";
  std::ofstream(file) << "right-0123456789abcdef\n";
  const Server guarded("builtin:knot", {"--token-file", file});
  ASSERT_TRUE(guarded.ready()) << guarded.log();
  LibraryClient client(guarded.url());
  EXPECT_EQ(problem_of(client.get()), "refused: the server refused the token");
  ASSERT_EQ(mirage_connect(client.get(), guarded.url().c_str(), "right-0123456789abcdef"),
            MIRAGE_OK);
  const Canvas canvas;
  EXPECT_TRUE(client.rest(view_from(9), canvas.target()));
}

TEST_F(Library, FullRendersComeByTheSameCamera) {
  const Server generous("builtin:knot", {"--references"});
  LibraryClient client(generous.url());
  const Canvas canvas;
  mirage_view view = view_from(9);
  view.tan_left *= 0.5;  // as asymmetric cameras see it
  const Pixels picture = client.picture(canvas, view);
  ASSERT_EQ(mirage_reference_ask(client.get(), &view), MIRAGE_OK);
  mirage_image image = sized<mirage_image>();
  mirage_result taken = MIRAGE_NOT_YET;
  for (int i = 0; i < 2000 && taken == MIRAGE_NOT_YET; ++i) {
    ASSERT_EQ(mirage_update(client.get(), clock_us(), nullptr), MIRAGE_OK);
    taken = mirage_reference_take(client.get(), &image);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  ASSERT_EQ(taken, MIRAGE_OK);
  ASSERT_EQ(image.width, kWidth);
  Pixels truth(image.bytes);
  constexpr std::size_t kRow = std::size_t{4} * kWidth;
  for (std::size_t y = 0; y < kHeight; ++y) {
    std::copy_n(image.rgba + (kHeight - 1 - y) * kRow, kRow, &truth[y * kRow]);
  }
  EXPECT_LT(different(truth, picture, 24), std::size_t{kWidth} * kHeight / 100);
  const Server silent("builtin:knot", {"--no-reference"});
  LibraryClient mean(silent.url());
  ASSERT_TRUE(mean.rest(view, canvas.target()));
  ASSERT_EQ(mirage_reference_ask(mean.get(), &view), MIRAGE_OK);
  taken = MIRAGE_NOT_YET;
  for (int i = 0; i < 2000 && taken == MIRAGE_NOT_YET; ++i) {
    mirage_update(mean.get(), clock_us(), nullptr);
    taken = mirage_reference_take(mean.get(), &image);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_EQ(taken, MIRAGE_REFUSED);
}

}  // namespace
}  // namespace mirage::test
