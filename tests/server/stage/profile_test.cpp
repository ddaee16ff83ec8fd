// Render profile: everything that draws and encodes tiles is part of the revision.
#include <gtest/gtest.h>

#include <set>

#include "server/stage/render_profile.h"
#include "shaders/gl/program.h"

namespace mirage::test {
namespace {

TEST(ServerProfile, EverythingThatTilesDependOnCounts) {
  const RenderProfile here = render_profile("llvmpipe, OpenGL 4.5", 2);
  EXPECT_EQ(here.hash(), render_profile("llvmpipe, OpenGL 4.5", 2).hash());
  std::set<std::uint64_t> hashes = {here.hash(), render_profile("llvmpipe, OpenGL 4.6", 2).hash(),
                                    render_profile("llvmpipe, OpenGL 4.5", 3).hash()};
  RenderProfile changed = here;
  changed.shaders ^= 1;
  hashes.insert(changed.hash());
  ASSERT_GE(here.codecs.size(), 2u);
  for (std::size_t i = 0; i < here.codecs.size(); ++i) {
    changed = here;
    changed.codecs[i] += "1";
    hashes.insert(changed.hash());
  }
  EXPECT_EQ(hashes.size(), 4 + here.codecs.size());
}

TEST(ServerProfile, ShadersAreAllThere) {
  EXPECT_GT(gl::shader_names().size(), 20u);
  for (const std::string_view name : gl::shader_names()) {
    EXPECT_FALSE(gl::shader_source(name).empty()) << name;
  }
}

TEST(ServerProfile, ARevisionIsOfBoth) {
  EXPECT_NE(profiled_revision(1, 2), profiled_revision(2, 1));
  EXPECT_NE(profiled_revision(1, 2), profiled_revision(1, 3));
  EXPECT_EQ(profiled_revision(1, 2), profiled_revision(1, 2));
}

}  // namespace
}  // namespace mirage::test
