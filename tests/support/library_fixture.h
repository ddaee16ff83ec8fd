#pragma once
// Library fixture: a program of others that draws with libmirage-client from a server of its own.

#include <gtest/gtest.h>
#include <mirage/client.h>
#include <mirage/frame.h>
#include <mirage/stats.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include "shaders/gl/egl_context.h"
#include "shaders/gl/gl.h"
#include "tests/support/process.h"

namespace mirage::test {

inline constexpr int kWidth = 160, kHeight = 90;
inline constexpr double kNear = 0.1, kFar = 100;

template <typename T>
T sized() {
  T out{};
  out.size = sizeof(T);
  return out;
}

inline std::int64_t clock_us() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// Looks along -z from (0, 0, z).
inline mirage_view view_from(double z) {
  mirage_view view = sized<mirage_view>();
  view.eye[2] = z;
  view.tan_up = std::tan(0.5 * 1.0471975511965976);
  view.tan_down = -view.tan_up;
  view.tan_right = view.tan_up * kWidth / kHeight;
  view.tan_left = -view.tan_right;
  view.near_m = kNear;
  view.far_m = kFar;
  view.width = kWidth;
  view.height = kHeight;
  return view;
}

using Pixels = std::vector<std::uint8_t>;

/// A framebuffer of a host, with colour and depth.
class Canvas {
 public:
  explicit Canvas(GLenum format = GL_RGBA8, int width = kWidth, int height = kHeight)
      : width_(width), height_(height) {
    glGenFramebuffers(1, &framebuffer_);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glGenRenderbuffers(2, buffers_.data());
    const std::array<GLenum, 2> formats = {format, GL_DEPTH_COMPONENT32F};
    const std::array<GLenum, 2> places = {GL_COLOR_ATTACHMENT0, GL_DEPTH_ATTACHMENT};
    for (int i = 0; i < 2; ++i) {
      const auto at = static_cast<std::size_t>(i);
      glBindRenderbuffer(GL_RENDERBUFFER, buffers_[at]);
      glRenderbufferStorage(GL_RENDERBUFFER, formats[at], width, height);
      glFramebufferRenderbuffer(GL_FRAMEBUFFER, places[at], GL_RENDERBUFFER, buffers_[at]);
    }
    EXPECT_EQ(glCheckFramebufferStatus(GL_FRAMEBUFFER), GLenum{GL_FRAMEBUFFER_COMPLETE});
    clear(1);
  }
  ~Canvas() {
    glDeleteFramebuffers(1, &framebuffer_);
    glDeleteRenderbuffers(2, buffers_.data());
  }
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  /// Clears to black, with this depth everywhere.
  void clear(float depth) const {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glClearColor(0, 0, 0, 0);
    glClearDepthf(depth);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  }
  mirage_target target() const {
    mirage_target out = sized<mirage_target>();
    out.framebuffer = framebuffer_;
    return out;
  }
  Pixels read() const {
    Pixels out(std::size_t{4} * static_cast<std::size_t>(width_ * height_));
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, out.data());
    return out;
  }
  std::vector<float> depth() const {
    std::vector<float> out(static_cast<std::size_t>(width_ * height_));
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glReadPixels(0, 0, width_, height_, GL_DEPTH_COMPONENT, GL_FLOAT, out.data());
    return out;
  }

 private:
  int width_, height_;
  GLuint framebuffer_ = 0;
  std::array<GLuint, 2> buffers_{};
};

class LibraryClient {
 public:
  explicit LibraryClient(const std::string& url, int samples = 1) {
    mirage_client_desc desc = sized<mirage_client_desc>();
    desc.version = MIRAGE_CLIENT_VERSION;
    desc.samples = samples;
    EXPECT_EQ(mirage_client_create(&desc, &client_), MIRAGE_OK);
    mirage_options options = sized<mirage_options>();
    options.frame_ms = 10'000;
    EXPECT_EQ(mirage_set_options(client_, &options), MIRAGE_OK);
    EXPECT_EQ(mirage_connect(client_, url.c_str(), nullptr), MIRAGE_OK);
    EXPECT_EQ(mirage_gl_attach(client_), MIRAGE_OK);
  }
  ~LibraryClient() {
    mirage_gl_detach(client_, 0);
    mirage_client_destroy(client_);
  }
  LibraryClient(const LibraryClient&) = delete;
  LibraryClient& operator=(const LibraryClient&) = delete;

  mirage_client* get() { return client_; }

  /// Runs frames until the picture is at rest and would not get better. Returns false if it never
  /// is.
  bool rest(const mirage_view& view, const mirage_target& target) {
    return rest(std::vector<mirage_view>{view}, {target});
  }
  /// As above, with one target for each of several views.
  bool rest(const std::vector<mirage_view>& views, const std::vector<mirage_target>& targets) {
    const auto count = static_cast<std::int32_t>(views.size());
    for (const std::int64_t end = clock_us() + 60'000'000; clock_us() < end;) {
      EXPECT_EQ(mirage_update(client_, clock_us(), nullptr), MIRAGE_OK);
      mirage_frame_info info = sized<mirage_frame_info>();
      const mirage_result planned = mirage_plan(client_, views.data(), count, clock_us(), &info);
      if (planned == MIRAGE_OK) {
        for (std::int32_t i = 0; i < count; ++i) {
          const mirage_target& target = targets[static_cast<std::size_t>(i)];
          EXPECT_EQ(mirage_draw(client_, i, &target), MIRAGE_OK);
        }
        EXPECT_EQ(mirage_frame_done(client_, 1000), MIRAGE_OK);
        if (info.at_rest == 1) return true;
      } else {
        EXPECT_EQ(planned, MIRAGE_NOT_YET);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return false;
  }
  /// Returns the picture at rest in a canvas that is cleared to this depth.
  Pixels picture(const Canvas& canvas, const mirage_view& view, float depth = 1) {
    EXPECT_TRUE(rest(view, canvas.target()));
    canvas.clear(depth);
    const mirage_target target = canvas.target();
    EXPECT_EQ(mirage_composite(client_, 0, &target), MIRAGE_OK);
    return canvas.read();
  }

 private:
  mirage_client* client_ = nullptr;
};

class Library : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(server_.ready()) << server_.log();
    Result<gl::EglContext> egl = gl::EglContext::create("auto");
    ASSERT_TRUE(egl.ok());
    egl_ = std::move(*egl);
  }

  explicit Library(const std::string& scene = "builtin:knot") : server_(scene) {}

  Server server_;
  gl::EglContext egl_;
};

/// Returns how many of the first three bytes of all pixels differ, by more than `most`.
inline std::size_t different(const Pixels& a, const Pixels& b, int most = 0) {
  EXPECT_EQ(a.size(), b.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    if (i % 4 != 3 && std::abs(a[i] - b[i]) > most) ++count;
  }
  return count;
}

}  // namespace mirage::test
