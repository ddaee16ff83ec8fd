#include "tests/support/large_scene.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/glm.hpp>
#include <iterator>
#include <map>

#include "modules/image_library.h"
#include "tests/support/gltf_builder.h"

namespace mirage::test {
namespace {

constexpr double kPi = 3.14159265358979323846;

// Returns the distance of the surface from the middle in the direction `d`.
double bumps(const glm::dvec3& d, int mesh) {
  double height = 1, size = 0.12;
  glm::dvec3 at = d * (2.0 + 0.3 * mesh);
  for (int octave = 0; octave < 6; ++octave, size *= 0.5) {
    height += size * std::sin(at.x + 1.7 * mesh) * std::sin(at.y + octave) * std::sin(at.z);
    at = 2.1 * glm::dvec3(at.y, at.z, at.x) + 0.7;
  }
  return height;
}

struct Ball {
  std::vector<float> positions, normals, uvs;
  std::vector<std::uint32_t> indices;
};

// Returns rows of quads from pole to pole. The first and the last column are one place with two
// coordinates.
Ball make_ball(std::uint64_t triangles, int mesh) {
  const auto rows = static_cast<std::uint32_t>(std::max(4.0, std::sqrt(double(triangles) / 4)));
  const std::uint32_t columns = 2 * rows;
  std::vector<glm::dvec3> points;
  for (std::uint32_t y = 0; y <= rows; ++y) {
    const double polar = kPi * y / rows;
    for (std::uint32_t x = 0; x <= columns; ++x) {
      const double turn = 2 * kPi * (x % columns) / columns;
      const glm::dvec3 d(std::sin(polar) * std::cos(turn), std::cos(polar),
                         std::sin(polar) * std::sin(turn));
      points.push_back(d * bumps(d, mesh));
    }
  }
  Ball out;
  const auto at = [&](std::uint32_t x, std::uint32_t y) { return y * (columns + 1) + x; };
  for (std::uint32_t y = 0; y <= rows; ++y) {
    for (std::uint32_t x = 0; x <= columns; ++x) {
      const glm::dvec3 along =
          points[at((x + 1) % columns, y)] - points[at((x + columns - 1) % columns, y)];
      const glm::dvec3 down =
          points[at(x, std::min(y + 1, rows))] - points[at(x, y == 0 ? 0 : y - 1)];
      const glm::dvec3 across = glm::cross(along, down);
      const double length = glm::length(across);
      const glm::dvec3& p = points[at(x, y)];
      const glm::dvec3 normal = length > 0 ? across / length : glm::normalize(p);
      for (int c = 0; c < 3; ++c) out.positions.push_back(static_cast<float>(p[c]));
      for (int c = 0; c < 3; ++c) out.normals.push_back(static_cast<float>(normal[c]));
      out.uvs.insert(out.uvs.end(), {4.0f * static_cast<float>(x) / static_cast<float>(columns),
                                     2.0f * static_cast<float>(y) / static_cast<float>(rows)});
    }
  }
  for (std::uint32_t y = 0; y < rows; ++y) {
    for (std::uint32_t x = 0; x < columns; ++x) {
      const std::uint32_t a = at(x, y), b = at(x + 1, y), c = at(x, y + 1), d = at(x + 1, y + 1);
      if (y > 0) out.indices.insert(out.indices.end(), {a, b, c});
      if (y + 1 < rows) out.indices.insert(out.indices.end(), {b, d, c});
    }
  }
  return out;
}

// Returns waves of many lengths with grain over them, which compress like a photograph.
Result<std::string> encoded_texture(int index, int edge, bool normal_map) {
  std::vector<std::uint8_t> rgb(3 * static_cast<std::size_t>(edge) * edge);
  std::uint32_t grain = 12345u + static_cast<std::uint32_t>(index);
  std::vector<double> along(static_cast<std::size_t>(edge));
  for (int y = 0; y < edge; ++y) {
    for (int x = 0; x < edge; ++x) {
      grain = grain * 1664525u + 1013904223u;
      const double u = 2 * kPi * x / edge, v = 2 * kPi * y / edge;
      const double wave = std::sin(3 * u + index) * std::cos(5 * v) +
                          0.5 * std::sin(17 * u + 13 * v) + 0.25 * std::sin(71 * u - 53 * v);
      const double noise = double(grain >> 24) / 255.0 - 0.5;
      std::uint8_t* at = &rgb[3 * (static_cast<std::size_t>(y) * edge + x)];
      if (normal_map) {
        at[0] = static_cast<std::uint8_t>(128 + 20 * wave + 6 * noise);
        at[1] = static_cast<std::uint8_t>(128 - 20 * wave);
        at[2] = static_cast<std::uint8_t>(240 - 4 * wave);
      } else {
        at[0] = static_cast<std::uint8_t>(140 + 40 * wave + 24 * noise);
        at[1] = static_cast<std::uint8_t>(120 + 30 * wave + 24 * noise);
        at[2] = static_cast<std::uint8_t>(90 + 20 * wave + 24 * noise);
      }
    }
  }
  const Result<const ImageLibrary*> library = image_library();
  if (!library) return library.error();
  const Result<std::vector<std::uint8_t>> file = (*library)->encode(
      normal_map ? "map.png" : "map.jpg", {edge, edge, 3, rgb.data()}, "jpeg:90");
  if (!file) return file.error();
  return std::string(file->begin(), file->end());
}

Result<void> add_textures(Builder& builder, const LargeScene& scene) {
  const int colors = (2 * scene.textures + 2) / 3;
  std::map<int, std::string> encoded;  // a few pictures by turns; each is decoded nevertheless
  for (int i = 0; i < scene.textures; ++i) {
    const bool normal_map = i >= colors;
    std::string& bytes = encoded[normal_map ? -1 : i % 3];
    if (bytes.empty()) {
      Result<std::string> made = encoded_texture(i, scene.texture_edge, normal_map);
      if (!made) return made.error();
      bytes = made.take();
    }
    const int view = builder.view(std::vector<char>(bytes.begin(), bytes.end()));
    builder.doc["images"].push_back(
        {{"bufferView", view}, {"mimeType", normal_map ? "image/png" : "image/jpeg"}});
    builder.doc["textures"].push_back({{"source", i}});
  }
  for (int i = 0; i < colors; ++i) {
    json material = {
        {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", i}}}, {"metallicFactor", 0}}}};
    const int map = colors + i / 2;
    if (map < scene.textures) material["normalTexture"] = {{"index", map}};
    builder.doc["materials"].push_back(material);
  }
  return {};
}

}  // namespace

Result<std::uint64_t> write_large_glb(const std::string& path, const LargeScene& scene) {
  Builder builder;
  if (Result<void> added = add_textures(builder, scene); !added) return added.error();
  const int materials =
      builder.doc.contains("materials") ? static_cast<int>(builder.doc["materials"].size()) : 0;
  const int places = scene.meshes * scene.copies;
  const int across = static_cast<int>(std::ceil(std::sqrt(double(places))));
  const auto put = [&](json& node, int place) {
    node["translation"] = {3.0 * (place % across), 1.0, 3.0 * (place / across)};
  };
  for (int i = 0; i < scene.meshes; ++i) {
    const std::uint64_t fifth = scene.meshes == 1 ? scene.triangles : scene.triangles / 5;
    const std::uint64_t own =
        i == 0 ? fifth : (scene.triangles - fifth) / static_cast<std::uint64_t>(scene.meshes - 1);
    const Ball ball = make_ball(own, i);
    const json attributes = {{"POSITION", builder.vec3(ball.positions)},
                             {"NORMAL", builder.vec3(ball.normals)},
                             {"TEXCOORD_0", builder.vec2(ball.uvs)}};
    builder.mesh(attributes, builder.accessor(ball.indices, "SCALAR", 5125, 1));
    if (materials > 0) {
      builder.doc["meshes"].back()["primitives"][0]["material"] = i % materials;
    }
    put(builder.doc["nodes"].back(), i * scene.copies);
    for (int copy = 1; copy < scene.copies; ++copy) {
      json node = builder.doc["nodes"].back();
      put(node, i * scene.copies + copy);
      builder.doc["nodes"].push_back(node);
    }
  }
  const std::string bytes = builder.glb();
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) return make_error(ErrorId::kIo, "cannot write '" + path + "'");
  return bytes.size();
}

}  // namespace mirage::test
