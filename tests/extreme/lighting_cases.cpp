// L1 to L9: no light, too much of it, impossible values, the same light in other forms, and light
// that always changes.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "client/draw/frame_target.h"
#include "protocol/base/limits.h"
#include "protocol/impostor/lighting_state.h"
#include "protocol/wire/conversions.h"
#include "protocol/wire/message.h"
#include "server/render/gpu_scene.h"
#include "tests/extreme/light_pictures.h"
#include "tests/extreme/light_queue_case.h"
#include "tests/extreme/registry.h"
#include "tests/extreme/shapes.h"

namespace mirage::extreme {
namespace {

constexpr float kLightNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kLightInf = std::numeric_limits<float>::infinity();
constexpr int kLitSize = kLightPictureEdge;
using nlohmann::json;

// L1
Outcome no_light(const Conditions& conditions) {
  Result<std::unique_ptr<Studio>> studio = ball_studio(conditions);
  if (!studio) return no_studio(studio.error());
  const Shots dark = shoot(**studio, only(0, {}));
  Checks checks;
  checks.at_least("covered px", static_cast<double>(covered(dark.truth)), 1000);
  checks.equal("truth", brightest(dark.truth), 0);
  checks.equal("geometry", brightest(dark.mesh), 0);
  checks.equal("lit tile", brightest(dark.lit), 0);
  checks.equal("relit tile", brightest(dark.relit), 0);
  return checks.outcome();
}

// L2: more light never makes anything darker, as a NaN or a wrapped value would. Nothing blended
// becomes brighter than white: its layers are summed in more than 8 bits.
Outcome too_bright(const Conditions& conditions) {
  Result<std::unique_ptr<Studio>> studio = ball_studio(conditions);
  if (!studio) return no_studio(studio.error());
  Checks checks;
  for (const auto& [name, make] : {std::pair{"sun", +[](float i) { return sun(i); }},
                                   {"point",
                                    +[](float i) {
                                      return point_light({1, 2, 3}, i);
                                    }},
                                   {"spot", +spot}}) {
    const Shots plain = shoot(**studio, only(0.1f, {make(1)}));
    for (const float intensity : {1e6f, 1e38f, 3.4e38f}) {
      const Shots bright = shoot(**studio, only(0.1f, {make(intensity)}));
      int dark = darker(plain.truth, bright.truth, 0) + darker(plain.mesh, bright.mesh, 0) +
                 darker(plain.lit, bright.lit, 1) + darker(plain.relit, bright.relit, 1);
      dark += brightest(bright.truth) == 255 && brightest(bright.relit) == 255 ? 0 : 1;
      checks.equal(name + (" " + number_text(intensity)) + ": darker components", dark, 0);
    }
  }
  const Shots plain = shoot(**studio, only(0.1f, {}));
  const Shots ambient = shoot(**studio, only(1e38f, {}));
  checks.equal("ambient 1e38: darker components",
               darker(plain.truth, ambient.truth, 0) + darker(plain.relit, ambient.relit, 1), 0);
  Result<std::unique_ptr<Studio>> glass = ball_studio(conditions, 0.3f, "BLEND");
  if (!glass) return no_studio(glass.error());
  (*glass)->set_light(only(0.1f, {sun(1e6f), point_light({1, 2, 3}, 1e38f)}));
  const Camera camera = (*glass)->camera(0, {0.5, 0.4, 1}, 4, kLitSize);
  const Pixels truth = (*glass)->truth(camera).rgba;
  checks.at_least("blended px", static_cast<double>(covered(truth)), 1000);
  checks.equal("blended: components above alpha",
               above_alpha(truth) + above_alpha((*glass)->meshes(camera)) +
                   above_alpha((*glass)->impostors(camera, DrawMethod::kQuad)),
               0);
  return checks.outcome();
}

// L3: refused by the check, by the server's decoder of what a client sends, and by the importer.
Outcome impossible(const Conditions& conditions) {
  int accepted = 0, tried = 0, decoded = 0;
  const auto attempt = [&](const Lighting& light) {
    ++tried;
    accepted += checked_lighting(light).ok() ? 1 : 0;
    wire::SetLightingT message;
    message.lighting = to_wire(light);
    const Bytes bytes = encode_message(std::move(message));
    Result<Message> back = decode_message(bytes.data(), bytes.size());
    decoded += back && from_wire(*back->body.AsSetLighting()->lighting).ok() ? 1 : 0;
  };
  for (const float bad : {kLightNan, kLightInf, -kLightInf, -1.0f, -1e-30f}) {
    for (int c = 0; c < 3; ++c) {
      Lighting light = only(0.1f, {sun(1), point_light({1, 2, 3}, 1)});
      light.ambient[c] = bad;
      attempt(light);
      light = only(0.1f, {sun(1), point_light({1, 2, 3}, 1)});
      light.lights[1].color[c] = bad;
      attempt(light);
      if (std::isfinite(bad)) continue;
      light.lights[1].color[c] = 1;
      light.lights[1].position[c] = bad;
      attempt(light);
      light = only(0.1f, {sun(1)});
      light.lights[0].direction[c] = bad;
      attempt(light);
    }
    Lighting light = only(0.1f, {point_light({1, 2, 3}, 1)});
    light.lights[0].range = bad;
    attempt(light);
  }
  Lighting no_direction = only(0.1f, {sun(1)});
  no_direction.lights[0].direction = glm::vec3(0);
  attempt(no_direction);
  attempt(only(0.1f, std::vector<Light>(limits::kMaxLights + 1, sun(1))));
  Checks checks;
  checks.equal("accepted of " + std::to_string(tried), accepted, 0);
  checks.equal("accepted over the wire", decoded, 0);
  test::Builder builder = document(dented_ball());
  builder.doc["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "point"}, {"intensity", -5}}, {{"type", "point"}, {"intensity", 5}}};
  builder.doc["nodes"].push_back({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  builder.doc["nodes"].push_back({{"extensions", {{"KHR_lights_punctual", {{"light", 1}}}}}});
  const auto scene = load_scene(write(builder, conditions.folder, "lights"));
  checks.holds("file: negative one left out, the other kept",
               scene && (*scene)->scene.lighting.lights.size() == 1);
  return checks.outcome();
}

/// Points without extent, which are shaded exactly where they are: one at the origin and four
/// around it, in the plane z = 0, which is at right angles to their normals.
Scene points() {
  Scene scene;
  scene.environment.zenith = scene.environment.horizon = scene.environment.nadir = glm::vec3(0);
  scene.materials.emplace_back();
  Mesh& mesh = scene.objects.emplace_back().mesh;
  for (const glm::vec2& at : {glm::vec2(0), {1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
    mesh.indices.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
    Vertex& v = mesh.vertices.emplace_back();
    v.position = glm::vec3(at, 0);
    v.normal = {0, 0, 1};
  }
  mesh.primitives.push_back({PrimitiveKind::kPoints, 0, 5, 0});
  scene.instances.emplace_back();
  return scene;
}

// L4: a light at the ball's centre, on one of its vertices, and at the eye. Also on a drawn point:
// no direction leads to that, so it is not lit.
Outcome light_inside(const Conditions& conditions) {
  Result<std::unique_ptr<Studio>> studio = ball_studio(conditions);
  if (!studio) return no_studio(studio.error());
  const Camera camera = (*studio)->camera(0, {0.5, 0.4, 1}, 4, kLitSize);
  const glm::dvec3 center = (*studio)->scene().instances[0].center;
  const glm::dvec3 vertex((*studio)->prepared().scene.objects[0].mesh.vertices[300].position);
  const Shots dark = shoot(**studio, only(0.1f, {}));
  int wrong = 0, bad = 0;
  for (const glm::dvec3& at : {center, glm::dvec3(0), vertex, camera.pose.eye}) {
    const Shots lit = shoot(**studio, only(0.1f, {point_light(at, 2)}));
    wrong += darker(dark.truth, lit.truth, 0) + darker(dark.mesh, lit.mesh, 0) +
             darker(dark.lit, lit.lit, 1) + darker(dark.relit, lit.relit, 1);
    bad += not_finite((*studio)->make_tile((*studio)->key_for(camera, 0, kLitTile), 0).header);
  }
  Checks checks;
  checks.equal("components darker than without it", wrong, 0);
  checks.equal("header values not finite", bad, 0);
  Result<std::unique_ptr<Studio>> point = Studio::create(points());
  if (!point) return no_studio(point.error());
  const Shots unlit = shoot(**point, only(0.1f, {}));
  const Shots lit = shoot(**point, only(0.1f, {point_light(glm::dvec3(0), 2)}));
  checks.at_least("px of points", static_cast<double>(covered(unlit.truth, 1)), 5);
  checks.equal("light on a point: truth differs by", largest_difference(unlit.truth, lit.truth), 0);
  checks.equal("light on a point: lit tile differs by", largest_difference(unlit.lit, lit.lit), 0);
  return checks.outcome();
}

// L5: a file with 256 lights.
Outcome mostly_black(const Conditions& conditions) {
  const auto file = [&](int count, int shining) {
    test::Builder builder = document(dented_ball());
    json& lights = builder.doc["extensions"]["KHR_lights_punctual"]["lights"];
    for (int i = 0; i < count; ++i) {
      lights.push_back({{"type", "point"}, {"intensity", i == shining ? 9 : 0}});
      builder.doc["nodes"].push_back({{"translation", {2.0 + 0.01 * (i - shining), 2, 3}},
                                      {"extensions", {{"KHR_lights_punctual", {{"light", i}}}}}});
    }
    return Studio::create(write(builder, conditions.folder, "lights"));
  };
  Result<std::unique_ptr<Studio>> one = file(1, 0), many = file(256, 200);
  if (!one || !many) return no_studio((one ? many : one).error());
  const Shots a = shoot(**one, (*one)->prepared().scene.lighting);
  const Shots b = shoot(**many, (*many)->prepared().scene.lighting);
  const auto key = [](Studio& s) {
    const ObjectDescription& o = s.scene().objects[0];
    return object_lighting(s.light(), Similarity{}, o.center, o.radius).hash();
  };
  Checks checks;
  checks.holds("one key", key(**one) == key(**many));
  checks.at_least("brightest", brightest(a.truth), 100);
  checks.equal("truth", largest_difference(a.truth, b.truth), 0);
  checks.equal("geometry", largest_difference(a.mesh, b.mesh), 0);
  checks.equal("lit tile", largest_difference(a.lit, b.lit), 0);
  checks.equal("relit tile", largest_difference(a.relit, b.relit), 0);
  return checks.outcome();
}

// L6
Outcome permuted(const Conditions& conditions) {
  Result<std::unique_ptr<Studio>> studio = ball_studio(conditions);
  if (!studio) return no_studio(studio.error());
  Random random(conditions.seed);
  Lighting light = only(0.05f, {});
  for (std::size_t i = 0; i < limits::kMaxLights; ++i) {
    light.lights.push_back(i % 3 ? point_light(random.direction() * 4.0, 0.4f)
                                 : sun(0.05f, random.direction()));
  }
  const ObjectDescription& object = (*studio)->scene().objects[0];
  const auto hash = [&](const Lighting& l) {
    return object_lighting(l, Similarity{}, object.center, object.radius).hash();
  };
  const Shots first = shoot(**studio, light);
  int worst = 0, keys = 0;
  for (int i = 0; i < 4; ++i) {
    Lighting other = light;
    std::shuffle(other.lights.begin(), other.lights.end(), std::mt19937_64(conditions.seed + i));
    keys += hash(other) == hash(light) ? 0 : 1;
    const Shots shots = shoot(**studio, other);
    worst = std::max({worst, largest_difference(first.truth, shots.truth),
                      largest_difference(first.mesh, shots.mesh),
                      largest_difference(first.lit, shots.lit),
                      largest_difference(first.relit, shots.relit)});
  }
  Checks checks;
  checks.equal("keys that differ", keys, 0);
  checks.at_most("largest difference", worst, 1);
  return checks.outcome();
}

/// Returns the linear radiance of the scene's first mesh, as the shaders write it to a float
/// target.
std::vector<float> radiance(Studio& studio, const Lighting& light) {
  const Camera camera = studio.camera(0, {0.5, 0.4, 1}, 4, kLitSize);
  studio.make_current();
  gl::RenderTarget target(kLitSize, kLitSize, {GL_RGBA32F}, GL_DEPTH_COMPONENT32F);
  target.bind();
  glViewport(0, 0, kLitSize, kLitSize);
  glDisable(GL_SCISSOR_TEST);
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  gl::MeshPass pass(gl::MeshOutput::kColor);
  pass.begin(camera.clip_from_relative(), gl::light_block(light, camera.pose.eye));
  const gl::MeshInstance instance = gl::mesh_instance(Similarity{}, camera.pose.eye, 0);
  pass.draw(studio.gpu().meshes[0], studio.gpu().materials(), studio.gpu().images, &instance, 1,
            false);
  pass.end();
  std::vector<float> out(kLitSize * kLitSize * 4);
  glReadPixels(0, 0, kLitSize, kLitSize, GL_RGBA, GL_FLOAT, out.data());
  return out;
}

// L7: compares in float, before any clamp.
Outcome twice(const Conditions& conditions) {
  Result<std::unique_ptr<Studio>> studio = ball_studio(conditions);
  if (!studio) return no_studio(studio.error());
  Checks checks;
  for (const auto& [name, make] : {std::pair{"sun", +[](float i) { return sun(i); }},
                                   {"point",
                                    +[](float i) {
                                      return point_light({1, 2, 3}, i);
                                    }},
                                   {"spot", +spot}}) {
    const float a = std::string(name) == "sun" ? 0.03f : 0.2f;
    const std::vector<float> once = radiance(**studio, only(0.01f, {make(a)}));
    const std::vector<float> doubled = radiance(**studio, only(0.02f, {make(2 * a)}));
    int differing = 0, lit = 0, clamped = 0;
    for (std::size_t i = 0; i < once.size(); ++i) {
      if (i % 4 == 3) continue;
      differing += doubled[i] == 2 * once[i] ? 0 : 1;
      lit += once[i] > 0.011f ? 1 : 0;
      clamped += doubled[i] >= 1 ? 1 : 0;
    }
    checks.equal(name + std::string(": components not doubled"), differing, 0);
    checks.at_least(name + std::string(": components lit"), lit, 500);
    checks.equal(name + std::string(": clamped"), clamped, 0);
  }
  return checks.outcome();
}

// L8
Outcome minus_zero(const Conditions& conditions) {
  Result<std::unique_ptr<Studio>> studio = ball_studio(conditions);
  if (!studio) return no_studio(studio.error());
  const ObjectDescription& object = (*studio)->scene().objects[0];
  Lighting plain = only(0, {sun(0.5f, {0, -1, 0}), point_light({0, 2, 0}, 1), spot(2)});
  plain.ambient = {0.1f, 0, 0};
  plain.lights[0].color = {0.5f, 0, 0.25f};
  Lighting signed_zeros = plain;
  const auto flip = [](float& v) { v = v == 0 ? -0.0f : v; };
  for (int c = 0; c < 3; ++c) {
    flip(signed_zeros.ambient[c]);
    for (Light& light : signed_zeros.lights) {
      flip(light.color[c]);
      flip(light.direction[c]);
      light.position[c] = light.position[c] == 0 ? -0.0 : light.position[c];
    }
  }
  for (Light& light : signed_zeros.lights) {
    flip(light.range);
    flip(light.cos_outer);
  }
  const auto hash = [&](const Lighting& l) {
    return object_lighting(l, Similarity{}, object.center, object.radius).hash();
  };
  const Camera camera = (*studio)->camera(0, {0.5, 0.4, 1}, 4, kLitSize);
  const auto take = [&](const Lighting& light) {
    (*studio)->set_light(light);
    const MadeTile made = (*studio)->make_tile((*studio)->key_for(camera, 0, kLitTile), 0);
    return std::pair{made.tile.rgba, (*studio)->truth(camera).rgba};
  };
  const auto a = take(plain), b = take(signed_zeros);
  Checks checks;
  checks.holds("one key", hash(plain) == hash(signed_zeros));
  checks.holds("one key of shadows", lighting_hash(plain) == lighting_hash(signed_zeros));
  checks.holds("taken as equal", same_lighting(plain, signed_zeros));
  checks.equal("lit tile", largest_difference(a.first, b.first), 0);
  checks.equal("truth", largest_difference(a.second, b.second), 0);
  return checks.outcome();
}

}  // namespace

std::vector<Case> lighting_cases() {
  return {
      {"L1", "no light", "RGB exactly 0", no_light},
      {"L2", "lights of 1e6, 1e38 and the largest float", "clamped, no Inf", too_bright},
      {"L3", "NaN, infinite and negative lights", "refused", impossible},
      {"L4", "light at the centre, on a vertex, at the eye", "finite", light_inside},
      {"L5", "255 of 256 lights black", "bitwise the one", mostly_black},
      {"L6", "order of 16 lights permuted", "<= 1 LSB", permuted},
      {"L7", "intensity a and 2 a", "I(2a) = 2 I(a) bitwise", twice},
      {"L8", "-0 and 0", "one key", minus_zero},
      {"L9", "new light every frame for 10 s", "bounded queue, newest wins, nobody starves",
       light_every_frame},
  };
}

}  // namespace mirage::extreme
