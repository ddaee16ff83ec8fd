// An eye inside a room that is one mesh, whose geometry is not sent: it sees impostors of the
// walls.

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/gltf_builder.h"
#include "tests/support/room.h"
#include "tests/support/viewed.h"

namespace mirage::test {
namespace {

/// The room as a file, with a camera in it.
std::string room_file() {
  const Mesh mesh = room_mesh();
  std::vector<float> positions, normals;
  std::vector<std::uint16_t> colors;
  for (const Vertex& v : mesh.vertices) {
    for (int k = 0; k < 3; ++k) positions.push_back(v.position[k]);
    for (int k = 0; k < 3; ++k) normals.push_back(v.normal[k]);
    for (int k = 0; k < 4; ++k) colors.push_back(v.color[k]);
  }
  Builder builder;
  const int position = builder.vec3(positions);
  const int normal = builder.vec3(normals);
  const int color = builder.accessor(colors, "VEC4", 5123, 4, true);
  const int indices = builder.accessor(mesh.indices, "SCALAR", 5125, 1);
  builder.doc["meshes"] = {
      {{"primitives",
        {{{"attributes", {{"POSITION", position}, {"NORMAL", normal}, {"COLOR_0", color}}},
          {"indices", indices},
          {"material", 0}}}}}};
  builder.doc["materials"] = {{{"pbrMetallicRoughness", {{"metallicFactor", 0}}}}};
  builder.doc["cameras"] = {
      {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}}};
  builder.doc["nodes"] = {{{"mesh", 0}}, {{"camera", 0}, {"translation", {0, 0, 1.5}}}};
  builder.doc["scenes"] = {{{"nodes", {0, 1}}}};
  builder.doc["scene"] = 0;
  const std::string path = scratch_folder() + "/room.glb";
  std::ofstream(path, std::ios::binary) << builder.glb();
  return path;
}

TEST(Parts, AnEyeInsideOfOneMeshSeesItsWalls) {
  const std::string folder = scratch_folder();
  const Server server(room_file(), {"--no-geometry", "--references"});
  ASSERT_TRUE(server.ready()) << server.log();
  const nlohmann::json s =
      view(server,
           "--offscreen 320x180 --path builtin:still --net rtt=100,rate=20,server-ms=5,seed=1 "
           "--fps 8 --reference 40 --reference-samples 4 --frames 41 --out " +
               folder,
           folder)
          .stats;
  ASSERT_TRUE(s.is_object());
  EXPECT_EQ(s["quality"]["bound_violations"], 0);
  EXPECT_GT(s["quality"]["compared_pixels"], 40'000) << "walls count";
  EXPECT_LT(s["placeholder_fraction"], 0.5);
  EXPECT_LT(s["quality"]["flip"]["mean"], 0.03);
}

}  // namespace
}  // namespace mirage::test
