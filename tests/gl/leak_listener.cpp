// Leak listener: after all GL tests, every GL object they made must have been released.
#include <gtest/gtest.h>

#include "shaders/gl/gl_object.h"
#include "shaders/gl/health.h"

namespace mirage::test {
namespace {

class LeakListener : public ::testing::EmptyTestEventListener {
  void OnEnvironmentsTearDownEnd(const ::testing::UnitTest&) override {
    EXPECT_EQ(gl::live_objects(), 0) << "GL objects were not released";
  }
};

[[maybe_unused]] const bool listens = [] {
  ::testing::UnitTest::GetInstance()->listeners().Append(new LeakListener);  // owned by gtest
  return true;
}();

TEST(GlObjects, AProgramThatLeavesSomeBehindSaysSo) {
  EXPECT_EQ(gl::exit_without_leaks(0), 0);
  EXPECT_EQ(gl::exit_without_leaks(3), 3);
  ++gl::live_objects();
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(gl::exit_without_leaks(0), static_cast<int>(ExitCode::kInternal));
  EXPECT_NE(::testing::internal::GetCapturedStderr().find("1 GL objects"), std::string::npos);
  --gl::live_objects();
}

}  // namespace
}  // namespace mirage::test
