// KHR_materials_anisotropy in drawing: the shader beside the specification's formula on the CPU,
// its limits, and a brushed plate from a file to the picture.

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <random>

#include "client/hold/tile_cache.h"
#include "server/render/gpu_scene.h"
#include "server/scene/environment/probe_filter.h"
#include "shaders/gl/mesh_pass.h"
#include "shaders/gl/render_target.h"
#include "tests/gl/bench.h"
#include "tests/gl/need_scenes.h"
#include "tests/support/gltf_builder.h"

namespace mirage::test {
namespace {

constexpr int kEdge = 48;
constexpr double kDepth = 2, kHalf = 2;  // distance of the plate from the eye, and half its edge
constexpr double kPi = 3.14159265358979323846;

/// A plate across the view along -z, with a given shading frame.
struct Plate {
  glm::vec3 normal{0, 0, 1};
  glm::vec4 tangent{1, 0, 0, 1};
  bool from_behind = false;
  Material material;
  std::vector<Image> images;
};

class Anisotropy : public ::testing::Test {
 protected:
  Anisotropy() : egl_(gl::EglContext::create("auto")) {
    EXPECT_TRUE(egl_);
    target_ = gl::RenderTarget(kEdge, kEdge, {GL_RGBA32F}, GL_DEPTH_COMPONENT32F);
    EXPECT_TRUE(target_.ok());
  }

  /// Returns linear colours, rows from the bottom. Lights are relative to the eye.
  std::vector<glm::vec4> draw(const Plate& plate, const ObjectLighting& light,
                              const gl::ProbeMap* probe = nullptr) {
    egl_->make_current();
    Mesh mesh;
    for (const glm::vec2 at : {glm::vec2(-1, -1), {1, -1}, {1, 1}, {-1, 1}}) {
      Vertex v;
      v.position = glm::vec3(glm::vec2(kHalf) * at, -kDepth);
      v.normal = plate.normal;
      v.tangent = plate.tangent;
      mesh.vertices.push_back(v);
    }
    mesh.indices = {0, 1, 2, 0, 2, 3};
    if (plate.from_behind) std::swap(mesh.indices[1], mesh.indices[2]);
    if (plate.from_behind) std::swap(mesh.indices[4], mesh.indices[5]);
    mesh.primitives = {{PrimitiveKind::kTriangles, 0, 6, 0}};
    gl::GpuImages images;
    for (std::size_t i = 0; i < plate.images.size(); ++i) images.put(i, plate.images[i], {});
    const gl::GpuMesh gpu(mesh);
    gl::MeshPass pass(gl::MeshOutput::kColor);
    pass.set_probe(probe);
    target_.bind();
    glViewport(0, 0, kEdge, kEdge);
    glClearColor(0, 0, 0, 0);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    pass.begin(glm::perspective(glm::radians(60.0f), 1.0f, 0.1f, 10.0f),
               gl::light_block(light, {}));
    const gl::MeshInstance here;
    Material material = plate.material;
    material.double_sided = true;
    pass.draw(gpu, {material}, images, &here, 1, false);
    pass.end();
    std::vector<glm::vec4> out(kEdge * kEdge);
    glReadPixels(0, 0, kEdge, kEdge, GL_RGBA, GL_FLOAT, out.data());
    return out;
  }

  /// Returns the place of a pixel's centre on the plate, relative to the eye.
  static glm::dvec3 place(std::size_t pixel) {
    const double x = static_cast<double>(pixel % kEdge), y = static_cast<double>(pixel / kEdge);
    const double half = kDepth * std::tan(kPi / 6);
    return {half * (2 * (x + 0.5) / kEdge - 1), half * (2 * (y + 0.5) / kEdge - 1), -kDepth};
  }

  Result<gl::EglContext> egl_;
  gl::RenderTarget target_;
};

double dot(const glm::dvec3& a, const glm::dvec3& b) { return glm::dot(a, b); }

/// Frame of the specification's formulas: along the grain, across it, and the normal.
struct Frame {
  glm::dvec3 t, b, n;
  glm::dvec3 in(const glm::dvec3& v) const { return {dot(t, v), dot(b, v), dot(n, v)}; }
};

// The extension's D_GGX_anisotropic and V_GGX_anisotropic, without its clamp of V.
double distribution(const glm::dvec3& h, double at, double ab) {
  const double a2 = at * ab;
  const glm::dvec3 f(ab * h.x, at * h.y, a2 * h.z);
  const double w2 = a2 / dot(f, f);
  return a2 * w2 * w2 / kPi;
}
double visibility(const glm::dvec3& v, const glm::dvec3& l, double at, double ab) {
  const auto lambda = [&](const glm::dvec3& d) {
    return glm::length(glm::dvec3(at * d.x, ab * d.y, d.z));
  };
  return 0.5 / (l.z * lambda(v) + v.z * lambda(l));
}

/// Returns the colour of the material under one directional light by the specification, times pi as
/// for all lights.
glm::dvec3 expected(const Material& m, double strength, const Frame& frame, const glm::dvec3& eye,
                    const ObjectLight& light) {
  const glm::dvec3 to_light = -glm::dvec3(light.direction), to_eye = glm::normalize(eye);
  const glm::dvec3 l = frame.in(to_light), v = frame.in(to_eye);
  if (l.z <= 0) return glm::dvec3(0);
  const glm::dvec3 half = glm::normalize(to_light + to_eye);
  const double alpha = std::max(double{m.roughness} * m.roughness, 1e-3);
  const double at = glm::mix(alpha, 1.0, strength * strength);
  const glm::dvec3 albedo(m.base_color);
  const glm::dvec3 f0 = glm::mix(glm::dvec3(0.04), albedo, double{m.metallic});
  const glm::dvec3 f = f0 + (1.0 - f0) * std::pow(1 - dot(to_eye, half), 5.0);
  const double lobe = distribution(frame.in(half), at, alpha) * visibility(v, l, at, alpha) * kPi;
  return glm::dvec3(light.color) * l.z *
         ((1.0 - f) * albedo * (1.0 - double{m.metallic}) + f * lobe);
}

struct Dice {
  std::mt19937 engine{20240917};
  double operator()(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine);
  }
  glm::dvec3 direction() {
    glm::dvec3 v;
    do {
      v = {(*this)(-1, 1), (*this)(-1, 1), (*this)(-1, 1)};
    } while (dot(v, v) > 1 || dot(v, v) < 0.01);
    return glm::normalize(v);
  }
};

/// Returns an image of a tangent space value, rounded to 8 bits.
Image texel_image(const glm::dvec3& value) {
  const glm::dvec3 steps = glm::round(value * 255.0);
  return solid_image(glm::u8vec4(steps.x, steps.y, steps.z, 255), false);
}
glm::dvec3 texel_of(const Image& image) {
  return glm::dvec3(image.rgba[0], image.rgba[1], image.rgba[2]) / 255.0;
}

// Directions, turns, strengths, both maps and both sides are random.
TEST_F(Anisotropy, LampsAreTheSpecificationsFormula) {
  Dice dice;
  double brightest = 0;
  for (int round = 0; round < 120; ++round) {
    SCOPED_TRACE(round);
    Plate plate;
    const glm::dvec3 n = glm::normalize(glm::dvec3(0, 0, 1) + 0.9 * dice.direction());
    const glm::dvec3 t = glm::normalize(glm::cross(n, dice.direction()));
    const double sign = round % 3 == 0 ? -1 : 1;
    plate.from_behind = round % 4 == 3;
    plate.normal = plate.from_behind ? -n : n;
    plate.tangent = glm::vec4(t, sign);
    Material& m = plate.material;
    m.base_color = {dice(0, 1), dice(0, 1), dice(0, 1), 1};
    m.metallic = static_cast<float>(dice(0, 1));
    m.roughness = static_cast<float>(dice(0.1, 1));
    m.lobes.anisotropy = static_cast<float>(dice(0.02, 1));
    m.lobes.anisotropy_rotation = static_cast<float>(dice(0, kPi));
    double strength = double{m.lobes.anisotropy}, angle = double{m.lobes.anisotropy_rotation};
    if (round % 2) {
      plate.images.push_back(texel_image({dice(0, 1), dice(0, 1), dice(0.2, 1)}));
      m.lobes.map(LobeMap::kAnisotropy).image = 0;
      const glm::dvec3 texel = texel_of(plate.images[0]);
      angle += std::atan2(2 * texel.y - 1, 2 * texel.x - 1);
      strength *= texel.z;
    }
    const glm::dvec3 up = glm::dvec3(plate.normal);
    glm::dvec3 grain = std::cos(angle) * t + std::sin(angle) * sign * glm::cross(up, t);
    glm::dvec3 shaded = n;
    if (round % 5 == 0) {
      plate.images.push_back(texel_image({dice(0.3, 0.7), dice(0.3, 0.7), 0.95}));
      m.normal_map.image = static_cast<std::int32_t>(plate.images.size()) - 1;
      const glm::dvec3 texel = 2.0 * texel_of(plate.images.back()) - 1.0;
      shaded = glm::normalize(texel.x * t + texel.y * sign * glm::cross(n, t) + texel.z * n);
    }
    grain = glm::normalize(grain - shaded * dot(shaded, grain));
    const Frame frame{grain, glm::cross(shaded, grain), shaded};
    ObjectLighting lighting;
    ObjectLight lamp;
    lamp.color = glm::vec3(0.05f);
    const glm::dvec3 aside = 0.95 * dice.direction();
    lamp.direction = glm::vec3(-glm::normalize(n + aside));
    lighting.lights = {lamp};
    const std::vector<glm::vec4> drawn = draw(plate, lighting);
    for (std::size_t i = 0; i < drawn.size(); ++i) {
      const glm::dvec3 eye = -place(i);
      if (dot(glm::normalize(eye), shaded) < 0.01) continue;  // n.v is kept away from 0 there
      const glm::dvec3 is = glm::min(expected(m, strength, frame, eye, lamp), glm::dvec3(1));
      brightest = std::max(brightest, is.g);
      // Floats differ by a few thousandths where a narrow lobe is steep.
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(double{drawn[i][c]}, is[c], 1e-5 + 5e-3 * is[c]) << i;
    }
  }
  EXPECT_GT(brightest, 0.5) << "no highlight was seen";
}

// The formula that the test compares with is a distribution: the facets' projected areas add up to
// 1.
TEST(AnisotropyFormula, FacetsCoverTheSurfaceOnce) {
  for (const auto& [at, ab] : {std::pair{0.04, 0.04}, {1.0, 0.04}, {0.5, 0.2}, {1.0, 1.0}}) {
    constexpr int kSteps = 2000;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
      for (int k = 0; k < kSteps; ++k) {
        const double z = std::pow((i + 0.5) / kSteps, 0.25);  // dense where the lobe is
        const double weight = 0.25 * std::pow(z, -3.0);
        const double ring = std::sqrt(1 - z * z), angle = 2 * kPi * (k + 0.5) / kSteps;
        const glm::dvec3 h(ring * std::cos(angle), ring * std::sin(angle), z);
        sum += distribution(h, at, ab) * z * weight * 2 * kPi / kSteps / kSteps;
      }
    }
    EXPECT_NEAR(sum, 1, 0.01) << at << " " << ab;
  }
}

// The smaller the strength, the closer to plain shading, without a step at 0.
TEST_F(Anisotropy, LittleOfItIsNextToNone) {
  ObjectLighting lighting;
  ObjectLight lamp;
  lamp.color = glm::vec3(0.1f);
  lamp.direction = glm::normalize(glm::vec3(0.3f, -0.2f, -1));
  lighting.lights = {lamp};
  const Equirect sky{2, 1, {glm::vec3(0.8f, 0.1f, 0.1f), glm::vec3(0.1f)}};
  LightProbe probe = make_probe(sky, {});
  const gl::ProbeMap map = gl::ProbeMap::create(probe);
  lighting.probe.id = probe.id;
  for (const float roughness : {0.15f, 0.4f, 1.0f}) {
    Plate plate;
    plate.material.roughness = roughness;
    const auto plain = draw(plate, lighting, &map);
    plate.material.lobes.anisotropy = 1e-3f;
    const auto little = draw(plate, lighting, &map);
    plate.material.lobes.anisotropy = 0.8f;
    const auto much = draw(plate, lighting, &map);
    double most = 0;
    for (std::size_t i = 0; i < plain.size(); ++i) {
      for (int c = 0; c < 3; ++c) {
        ASSERT_NEAR(little[i][c], plain[i][c], 1e-4f + 0.01f * plain[i][c]) << roughness;
        most = std::max(most, std::abs(double{much[i][c]} - double{plain[i][c]}));
      }
    }
    if (roughness < 1) {
      EXPECT_GT(most, 0.02) << roughness;
    }
  }
}

// A mirror of full strength shows what a mirror shows across the grain. Along the grain it shows
// what is on the other side: the right half of the surroundings is white.
TEST_F(Anisotropy, SurroundingsAreSeenByTheBentNormal) {
  Equirect image{64, 32, std::vector<glm::vec3>(64 * 32)};
  for (int i = 0; i < 64 * 32; ++i) {
    const bool right = equirect_direction(image, i % 64, i / 64).x > 0;
    image.texels[static_cast<std::size_t>(i)] = glm::vec3(right ? 0.8f : 0.0f);
  }
  const LightProbe probe = make_probe(image, {});
  const gl::ProbeMap map = gl::ProbeMap::create(probe);
  ObjectLighting lighting;
  lighting.probe.id = probe.id;
  const auto brighter_on_the_right = [&](float strength, float rotation) {
    Plate plate;
    plate.material.roughness = 0.05f;
    plate.material.lobes.anisotropy = strength;
    plate.material.lobes.anisotropy_rotation = rotation;
    const auto drawn = draw(plate, lighting, &map);
    double sum = 0;
    for (std::size_t i = 0; i < drawn.size(); ++i) {
      sum += (place(i).x > 0 ? 1 : -1) * double{drawn[i].g};
    }
    return sum / static_cast<double>(drawn.size());
  };
  const auto half_turn = static_cast<float>(kPi / 2);
  EXPECT_GT(brighter_on_the_right(0, 0), 0.2) << "a mirror shows the side it is looked at towards";
  EXPECT_LT(brighter_on_the_right(1, 0), -0.2);
  EXPECT_GT(brighter_on_the_right(1, half_turn), 0.2) << "the grain runs along the edge";
}

/// A square plate in x and y with texture coordinates and no tangents, brushed along `rotation`.
std::string brushed_plate(double rotation) {
  Builder builder;
  const int position = builder.vec3({-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0});
  const int normal = builder.vec3({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
  const int uv = builder.vec2({0, 1, 1, 1, 1, 0, 0, 0});
  builder.mesh({{"POSITION", position}, {"NORMAL", normal}, {"TEXCOORD_0", uv}},
               builder.indices({0, 1, 2, 0, 2, 3}));
  builder.primitive()["material"] = 0;
  builder.doc["materials"] = {
      {{"pbrMetallicRoughness", {{"metallicFactor", 1}, {"roughnessFactor", 0.25}}},
       {"extensions",
        {{"KHR_materials_anisotropy",
          {{"anisotropyStrength", 0.7}, {"anisotropyRotation", rotation}}}}}}};
  builder.doc["extensionsUsed"] = {"KHR_materials_anisotropy"};
  return builder.glb();
}

/// Returns the spread of a highlight right and up, px: roots of the second moments of its
/// brightness.
glm::dvec2 spread(const std::vector<std::uint8_t>& rgba) {
  constexpr int kSize = Bench::kSize;
  double sum = 0;
  glm::dvec2 mean(0), square(0);
  for (int y = kSize / 4; y < kSize * 3 / 4; ++y) {
    for (int x = kSize / 4; x < kSize * 3 / 4; ++x) {
      const double v = rgba[static_cast<std::size_t>(4 * (y * kSize + x)) + 1] / 255.0;
      const double weight = v * v;
      const glm::dvec2 at(x, y);
      sum += weight;
      mean += weight * at;
      square += weight * at * at;
    }
  }
  mean /= sum;
  return glm::sqrt(square / sum - mean * mean);
}

// A highlight is stretched along the grain: from a file to the picture, as tile and as geometry.
TEST(AnisotropyPicture, ABrushedPlatesHighlightIsStretchedAlongTheGrain) {
  const TempFolder folder;
  for (const bool turned : {false, true}) {
    SCOPED_TRACE(turned);
    const std::string file = folder.write("plate.glb", brushed_plate(turned ? kPi / 2 : 0.0));
    const auto bench = Bench::create(file, BenchLight::kLit);
    ASSERT_TRUE(bench);
    Lighting light;
    light.ambient = glm::vec3(0);
    Light lamp;
    lamp.kind = LightKind::kPoint;
    lamp.color = glm::vec3(0.5f);
    lamp.position = {0, 0, 3};
    light.lights = {lamp};
    bench->set_light(light);
    const Camera camera = bench->camera(2.5, {0, 0, 1});
    TileCache cache = bench->make_cache();
    const TileRecordPtr tile = bench->tile_for(camera, cache);
    ASSERT_TRUE(tile);
    for (const auto& [what, drawn] :
         {std::pair{"tile", bench->picture(camera, tile, DrawMethod::kQuad)},
          std::pair{"geometry", bench->mesh_picture(camera)},
          std::pair{"truth", bench->truth(camera, 2)}}) {
      const glm::dvec2 size = spread(drawn);
      const double along = turned ? size.y : size.x, across = turned ? size.x : size.y;
      std::printf("[ FIGURES  ] %-8s spread %.1f px along the grain, %.1f across\n", what, along,
                  across);
      EXPECT_GT(along, 1.5 * across) << what;
    }
  }
}

}  // namespace
}  // namespace mirage::test
