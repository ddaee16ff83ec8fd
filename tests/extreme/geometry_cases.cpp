// G5 to G10: meshes of any size, flattened, turned inside out. The others are in
// geometry_vertex_cases.cpp and geometry_file_cases.cpp.

#include <algorithm>
#include <cmath>
#include <cstring>

#include "client/draw/frame_target.h"
#include "protocol/base/stable_math.h"
#include "server/render/gpu_scene.h"
#include "server/scene/gltf/gltf_import.h"
#include "tests/extreme/geometry_file_cases.h"
#include "tests/extreme/geometry_vertex_cases.h"
#include "tests/extreme/registry.h"
#include "tests/extreme/shapes.h"
#include "tests/extreme/studio.h"

namespace mirage::extreme {
namespace {

constexpr int kGeometrySize = 96;

/// Pictures of the same object: the truth and four ways to draw it.
struct Pictures {
  Pixels truth, mesh, quad, relief, relit;
};

Result<Pictures> take_pictures(const std::string& file, const glm::dvec3& direction,
                               const glm::dvec3& eye_grid = glm::dvec3(0)) {
  Result<std::unique_ptr<Studio>> studio = Studio::create(file);
  if (!studio) return studio.error();
  if ((*studio)->scene().instances.empty()) return make_error(ErrorId::kSceneEmpty, "left out");
  Camera camera = (*studio)->camera(0, direction, 4, kGeometrySize);
  if (eye_grid != glm::dvec3(0)) {
    const glm::dvec3 center = (*studio)->scene().instances[0].center;
    camera.pose.eye = center + glm::round((camera.pose.eye - center) / eye_grid) * eye_grid;
  }
  return Pictures{(*studio)->truth(camera).rgba, (*studio)->meshes(camera),
                  (*studio)->impostors(camera, DrawMethod::kQuad),
                  (*studio)->impostors(camera, DrawMethod::kDepth),
                  (*studio)->impostors(camera, DrawMethod::kDepth, kRelitTile)};
}

void compare(Checks& checks, const std::string& name, const Result<Pictures>& plain,
             const Result<Pictures>& other) {
  if (!plain || !other) {
    checks.failed(name + (plain ? other : plain).error().line());
    return;
  }
  checks.at_most(name + "truth", largest_difference(plain->truth, other->truth), 1);
  checks.at_most(name + "geometry", largest_difference(plain->mesh, other->mesh), 1);
  checks.at_most(name + "quad", largest_difference(plain->quad, other->quad), 1);
  checks.at_most(name + "relief", largest_difference(plain->relief, other->relief), 1);
  checks.at_most(name + "relit", largest_difference(plain->relit, other->relit), 1);
}

// G5, G6: scales by the node, and (where a float holds its vertices) by the mesh itself.
Outcome at_scales(const Conditions& conditions, const std::vector<double>& scales, bool in_mesh) {
  Checks checks;
  const glm::dvec3 direction(0.5, 0.4, 1);
  const Result<Pictures> plain =
      take_pictures(write(document(dented_ball()), conditions.folder, "plain"), direction);
  if (plain)
    checks.at_least("covered px of the plain one", static_cast<double>(covered(plain->truth)),
                    1000);
  for (const double scale : scales) {
    test::Builder by_node = document(dented_ball());
    by_node.doc["nodes"][0]["scale"] = {scale, scale, scale};
    compare(checks, "node x " + number_text(scale) + ": ", plain,
            take_pictures(write(by_node, conditions.folder, "node"), direction));
    if (!in_mesh) continue;
    compare(checks, "mesh x " + number_text(scale) + ": ", plain,
            take_pictures(write(document(scaled(dented_ball(), scale)), conditions.folder, "mesh"),
                          direction));
  }
  return checks.outcome();
}
Outcome tiny(const Conditions& c) { return at_scales(c, {1e-30, 1e-20}, true); }
Outcome huge(const Conditions& c) { return at_scales(c, {1e20}, true); }

// G7
Outcome at_offset(const Conditions& conditions) {
  const glm::dvec3 grid(1.0 / 1048576);  // of places that a double at 1e9 m holds
  test::Builder away = document(dented_ball());
  away.doc["nodes"][0]["translation"] = {1e9, -1e9, 1e9};
  Checks checks;
  compare(checks, "",
          take_pictures(write(document(dented_ball()), conditions.folder, "plain"), {0.5, 0.4, 1},
                        grid),
          take_pictures(write(away, conditions.folder, "away"), {0.5, 0.4, 1}, grid));
  return checks.outcome();
}

// G8: every other triangle has no area: two equal corners, three on a line, equal places.
Outcome zero_area(const Conditions& conditions) {
  const Shape plain = dented_ball();
  Shape mixed = plain;
  mixed.indices.clear();
  Random random(conditions.seed);
  for (std::size_t i = 0; i < plain.indices.size(); i += 3) {
    const std::uint32_t* at = &plain.indices[i];
    mixed.indices.insert(mixed.indices.end(), at, at + 3);
    const std::uint32_t a = at[0], b = at[static_cast<int>(random.uniform(0, 3))];
    mixed.indices.insert(mixed.indices.end(), {a, b, a});
  }
  Result<std::unique_ptr<Studio>> one =
      Studio::create(write(document(plain), conditions.folder, "a"));
  Result<std::unique_ptr<Studio>> two =
      Studio::create(write(document(mixed), conditions.folder, "b"));
  if (!one || !two) return no_studio((one ? two : one).error());
  int differing = 0;
  for (int i = 0; i < 6; ++i) {
    const Camera camera = (*one)->camera(0, random.direction(), 4, kGeometrySize);
    const TileKey key = (*one)->key_for(camera, 0, i % 2 ? kRelitTile : kLitTile);
    const MadeTile a = (*one)->make_tile(key, 0), b = (*two)->make_tile(key, 0);
    differing += a.header.content_hash == b.header.content_hash &&
                         a.header.dz_hull == b.header.dz_hull && covered(a.tile.rgba, 1) > 0
                     ? 0
                     : 1;
    differing += (*one)->truth(camera).rgba == (*two)->truth(camera).rgba ? 0 : 1;
  }
  Checks checks;
  checks.equal("tiles and truths that differ", differing, 0);
  checks.holds("one key", (*one)->prepared().revision == (*two)->prepared().revision);
  return checks.outcome();
}

// G9: compares with the adjugate in long double.
Outcome flattened(const Conditions& conditions) {
  const Shape shape = dented_ball();
  test::Builder builder = document(shape);
  builder.doc["nodes"][0]["scale"] = {1, 1e-6, 1};
  const Result<Scene> scene = import_gltf(write(builder, conditions.folder, "flat"));
  if (!scene) return no_studio(scene.error());
  const Similarity& m = scene->instances[0].world_from_object;
  double off_length = 0, off_direction = 0;
  const std::vector<Vertex>& vertices = scene->objects[0].mesh.vertices;
  std::size_t at = 0;
  for (std::size_t i = 0; i < shape.vertices(); ++i) {
    // Unused vertices are left out, so vertices are found by position.
    const glm::dvec3 p(shape.positions[i * 3], shape.positions[i * 3 + 1] * 1e-6,
                       shape.positions[i * 3 + 2]);
    if (at >= vertices.size()) break;
    const glm::dvec3 q =
        glm::dquat(m.rotation) * (double{m.scale} * glm::dvec3(vertices[at].position));
    if (glm::length(p - q) > 1e-6) continue;
    const long double x = shape.normals[i * 3], y = shape.normals[i * 3 + 1] * 1e6L,
                      z = shape.normals[i * 3 + 2];
    const long double l = std::sqrt(x * x + y * y + z * z);
    const glm::dvec3 n = glm::dquat(m.rotation) * glm::dvec3(vertices[at].normal);
    off_length = std::max(off_length, std::abs(glm::length(glm::dvec3(vertices[at].normal)) - 1));
    off_direction = std::max(off_direction, glm::length(n - glm::dvec3(x / l, y / l, z / l)));
    ++at;
  }
  Checks checks;
  checks.equal("vertices compared", static_cast<double>(at), static_cast<double>(vertices.size()));
  checks.at_most("length off by", off_length, 1e-5);
  checks.at_most("direction off by", off_direction, 1e-5);
  return checks.outcome();
}

Lighting mirrored(Lighting lighting) {
  for (Light& light : lighting.lights) {
    light.direction.x = -light.direction.x;
    light.position.x = -light.position.x;
  }
  return lighting;
}

Pixels mirrored(const Pixels& image, std::size_t width) {
  Pixels out(image.size());
  for (std::size_t i = 0; i < image.size() / 4; ++i) {
    const std::size_t y = i / width, x = width - 1 - i % width;
    std::memcpy(&out[i * 4], &image[(y * width + x) * 4], 4);
  }
  return out;
}

// Returns the shape with x reversed and the triangles turned, in the file's own data.
Shape mirrored(Shape shape) {
  for (std::size_t i = 0; i < shape.positions.size(); i += 3) {
    shape.positions[i] = -shape.positions[i];
    shape.normals[i] = -shape.normals[i];
  }
  for (std::size_t i = 0; i < shape.indices.size(); i += 3)
    std::swap(shape.indices[i + 1], shape.indices[i + 2]);
  return shape;
}

// G10: a scene mirrored by its node, seen from the mirrored eye under the mirrored light. It is
// bitwise the one whose data are mirrored, and mirrored back it is the plain one. The latter holds
// to 1 LSB in a few components: rasterisers count from one corner, and on some processors llvmpipe
// rounds differently from left and right.
Outcome mirror(const Conditions& conditions) {
  test::Builder turned = document(dented_ball());
  turned.doc["nodes"][0]["scale"] = {-1, 1, 1};
  const auto studio = [&](const test::Builder& builder, const char* name) {
    return Studio::create(write(builder, conditions.folder, name));
  };
  Result<std::unique_ptr<Studio>> plain = studio(document(dented_ball()), "plain");
  Result<std::unique_ptr<Studio>> other = studio(turned, "turned");
  Result<std::unique_ptr<Studio>> data = studio(document(mirrored(dented_ball())), "data");
  for (const auto* one : {&plain, &other, &data})
    if (!*one) return no_studio(one->error());
  const Lighting light = mirrored((*plain)->light());
  (*other)->set_light(light);
  (*data)->set_light(light);
  int from_data = 0, from_plain = 0;
  double differing = 0, components = 0;
  for (const glm::dvec3& direction :
       {glm::dvec3(0, 0, 1), glm::dvec3(0, 0.6, 0.8), glm::dvec3(0, 0, -1)}) {
    const Camera camera = (*plain)->camera(0, direction, 4, kGeometrySize);
    Camera there = camera;
    const glm::dvec3 center = (*plain)->scene().instances[0].center;
    there.pose.eye.x = -camera.pose.eye.x;
    there.pose = look_at(there.pose.eye, {-center.x, center.y, center.z});
    there.near_m = camera.near_m;
    there.far_m = camera.far_m;
    const Pixels image = (*other)->truth(there).rgba, back = mirrored(image, kGeometrySize);
    const Pixels expected = (*plain)->truth(camera).rgba;
    from_data = std::max(from_data, largest_difference((*data)->truth(there).rgba, image));
    from_plain = std::max(from_plain, largest_difference(expected, back));
    for (std::size_t i = 0; i < back.size(); ++i) differing += back[i] != expected[i] ? 1 : 0;
    components += static_cast<double>(back.size());
  }
  Checks checks;
  checks.equal("largest difference from mirrored data", from_data, 0);
  checks.at_most("from the plain one, mirrored back", from_plain, 1);
  checks.at_most("share of components that differ there", differing / components, 1e-4);
  return checks.outcome();
}

}  // namespace

std::vector<Case> geometry_cases() {
  std::vector<Case> cases = geometry_vertex_cases();
  const std::vector<Case> own = {
      {"G5", "scale 1e-30 and 1e-20, of the node and of the mesh",
       "image equals the plain one within 1 LSB", tiny},
      {"G6", "scale 1e20, of the node and of the mesh", "image equals the plain one within 1 LSB",
       huge},
      {"G7", "offset 1e9 m", "image equals the plain one within 1 LSB", at_offset},
      {"G8", "50 % triangles without area", "bitwise the mesh without them", zero_area},
      {"G9", "scale (1, 1e-6, 1)", "unit normals to 1e-5", flattened},
      {"G10", "mirroring scale", "bitwise the mirrored image", mirror},
  };
  for (const std::vector<Case>& more : {own, geometry_file_cases()}) {
    cases.insert(cases.end(), more.begin(), more.end());
  }
  return cases;
}

}  // namespace mirage::extreme
