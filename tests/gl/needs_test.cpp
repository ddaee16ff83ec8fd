// Leaving out (numerics.md section 5), rule by rule. Where a feature is neutral, nothing changes,
// to the last byte; where it is not, something does. A neutral element changes neither key nor
// variant.

#include <gtest/gtest.h>

#include <set>

#include "protocol/base/limits.h"
#include "server/prove/left_out.h"
#include "server/prove/need_proof.h"
#include "server/render/gpu_scene.h"
#include "server/render/tile_shot.h"
#include "server/tile/tile_encode.h"
#include "shaders/gl/egl_context.h"
#include "tests/gl/need_scenes.h"

namespace mirage::test {
namespace {

TileJob job_of(const PreparedScene& scene, std::size_t object, std::uint8_t channels,
               const glm::dvec3& direction = {0.3, 0.8, 0.5}) {
  const ObjectDescription& o = scene.objects[object];
  TileJob job;
  job.key.scene_revision = scene.revision;
  job.key.object = static_cast<std::uint32_t>(object);
  job.key.cell = *view_cell_from_direction(direction, 8);
  job.key.distance = *distance_bucket_from_radii(4, 2);
  job.key.size_class = 4;
  job.key.channels = channels;
  if ((o.needs & kNeedLighting) && channels == kLitTile) {
    job.lighting = object_lighting(scene.scene.lighting,
                                   scene.instance(first_instances(scene)[object]).world_from_object,
                                   o.center, o.radius);
    job.key.lighting = job.lighting.hash();
  }
  job.id = tile_id(job.key);
  return job;
}

/// The tile that the product draws of a scene's first object, its key, and the variants used.
struct Drawn {
  TileShot shot;
  TileId id;
  Bytes bytes;
  std::vector<std::string> variants;
};

class Needs : public ::testing::Test {
 protected:
  Needs() : egl_(gl::EglContext::create("auto")) { EXPECT_TRUE(egl_); }

  Drawn draw(const std::shared_ptr<const PreparedScene>& scene, bool floats = false,
             std::uint8_t channels = kLitTile) {
    egl_->make_current();  // proofs have contexts of their own
    const GpuScene gpu(scene);
    TileShooter shooter = TileShooter::create(gpu, 2, {0, floats, false}, true).take();
    const TileJob job = job_of(*scene, 0, channels);
    Drawn out{*shooter.shoot(job), job.id, {}, shooter.pages().variants()};
    if (floats) return out;
    auto page = std::make_shared<PagePixels>();
    page->width = page->height = static_cast<int>(out.shot.edge);
    page->rgba = out.shot.color;
    page->depth = out.shot.code;
    page->surface = out.shot.surface;
    out.bytes = encode_tile({job, page, 0, 0, 0, 0}, scene->objects[0], TileCodec::kZstd)->planes;
    return out;
  }

  Result<gl::EglContext> egl_;
};

using NeedsProof = Needs;

Proof prove(const std::shared_ptr<const PreparedScene>& scene) {
  ProofOptions options;
  options.cells = 3;
  return prove_needs(scene, options).take();
}

// All neutral features are in FULL as they were imported, and gone in LEAN. Of the two alpha modes
// the later change wins.
TEST_F(NeedsProof, NeutralFeaturesChangeNoComponent) {
  std::vector<Change> all;
  for (const NamedChange& one : neutral_changes()) all.push_back(one.change);
  std::vector<Change> blending = all;
  blending.push_back(all[0]);
  for (const std::vector<Change>& changes : {all, blending}) {
    const Proof proof = prove(prepared(changes));
    ASSERT_EQ(proof.objects.size(), 1u);
    EXPECT_EQ(proof.total.tiles, 3u * 3 * 2);
    EXPECT_EQ(proof.total.differing_components, 0u);
    std::set<NeedRule> told;
    for (const ProofRow& row : proof.rows) {
      EXPECT_EQ(row.differing_components, 0u) << need_rule(row.rule).name;
      told.insert(row.rule);
    }
    for (const NamedChange& one : neutral_changes()) {
      EXPECT_EQ(told.count(one.rule), 1u) << "no row of rule " << need_rule(one.rule).name;
    }
  }
}

TEST_F(NeedsProof, UnlitScenesAndThoseThatNeedAllAreDrawnAlike) {
  const Change unlit = [](Scene& s) { s.materials[0].unlit = true; };
  EXPECT_EQ(prove(prepared({unlit})).total.differing_components, 0u);
  std::vector<Change> all;
  for (const NeededChange& one : needed_changes()) {
    // Blended objects are not shaded by the client, but FULL shades everything there.
    const bool blended = one.rule == NeedRule::kBlending || one.name == std::string("transmission");
    if (!blended && one.rule != NeedRule::kLighting) {
      all.push_back(one.change);
    }
  }
  EXPECT_EQ(prove(prepared(all)).total.differing_components, 0u);
  // A grain without a map: FULL reads a map that has no effect.
  const Change brushed = [](Scene& s) {
    s.materials[0].lobes.anisotropy = 0.7f;
    s.materials[0].lobes.anisotropy_rotation = 0.4f;
  };
  EXPECT_EQ(prove(prepared({brushed})).total.differing_components, 0u);
}

// Negative control: where a feature is needed, even by one texel, leaving it out shows.
TEST_F(Needs, WhatIsNeededShowsWhenItIsLeftOut) {
  for (const NeededChange& one : needed_changes()) {
    SCOPED_TRACE(one.name);
    const Drawn with = draw(prepared({one.change}));
    const Drawn without = draw(prepared({one.change, one.left_out}));
    EXPECT_GT(differing_components(with.shot, without.shot), 0u);
    EXPECT_FALSE(with.id == without.id);
  }
}

// Metamorphic: a neutral element changes no pixel in floats, no byte, no key, no variant.
TEST_F(Needs, NeutralElementsChangeNoByteAndNoKey) {
  const auto plain = prepared({});
  const Drawn bytes = draw(plain), floats = draw(plain, true),
              relit = draw(plain, false, kRelitTile);
  for (const NamedChange& one : neutral_changes()) {
    SCOPED_TRACE(one.name);
    const auto scene = prepared({one.change});
    EXPECT_EQ(scene->revision, plain->revision);
    EXPECT_EQ(scene->objects[0].needs, plain->objects[0].needs);
    const Drawn drawn = draw(scene);
    EXPECT_TRUE(drawn.id == bytes.id);
    EXPECT_EQ(drawn.bytes, bytes.bytes);
    EXPECT_EQ(drawn.variants, bytes.variants);
    EXPECT_EQ(differing_components(draw(scene, true).shot, floats.shot), 0u);
    const Drawn surface = draw(scene, false, kRelitTile);
    EXPECT_EQ(differing_components(surface.shot, relit.shot), 0u);
    EXPECT_EQ(surface.shot.surface, relit.shot.surface);
    ASSERT_EQ(scene->geometry[0].encoded.size(), plain->geometry[0].encoded.size());
    EXPECT_EQ(scene->geometry[0].encoded[0].payload, plain->geometry[0].encoded[0].payload);
  }
}

TEST_F(Needs, LightsThatAddNothingAreInNoKey) {
  Light black;
  black.kind = LightKind::kPoint;
  black.color = glm::vec3(0);
  Light at_surface = black;  // where shading it would divide by zero
  at_surface.position = {0, 0.7, 0};
  Light far_off = black;
  far_off.color = glm::vec3(1);
  far_off.position = {0, 5, 0};
  far_off.range = 4;
  Light aside = far_off;
  aside.kind = LightKind::kSpot;
  aside.range = 0;
  aside.direction = {1, 0, 0};
  aside.cos_outer = 0.8f;
  aside.cos_inner = 0.9f;
  const Drawn bytes = draw(prepared({}));
  for (const Light& light : {black, at_surface, far_off, aside}) {
    const Change add = [&](Scene& s) { s.lighting.lights.push_back(light); };
    const auto scene = prepared({add});
    const Drawn drawn = draw(scene);
    EXPECT_TRUE(drawn.id == bytes.id);
    EXPECT_EQ(drawn.bytes, bytes.bytes);
  }
  // These lights change nothing if they are drawn nevertheless.
  const Change add_all = [&](Scene& s) {
    s.lighting.lights.insert(s.lighting.lights.end(), {black, at_surface, far_off, aside});
  };
  EXPECT_EQ(prove(prepared({add_all})).total.differing_components, 0u);
  const Change unlit = [](Scene& s) { s.materials[0].unlit = true; };
  const Change dark = [](Scene& s) { s.lighting = {}; };
  EXPECT_TRUE(draw(prepared({unlit})).id == draw(prepared({unlit, dark})).id);
  EXPECT_FALSE(draw(prepared({})).id == draw(prepared({dark})).id);
}

// Returns the variants that a scene may compile; one more means a feature where it is not needed.
std::set<std::string> variants_of(const std::shared_ptr<const PreparedScene>& scene) {
  const GpuScene gpu(scene);
  TilePageRenderer pages = TilePageRenderer::create(gpu, 2).take();
  EXPECT_TRUE(pages.warm_up(512));
  const std::vector<std::string> names = pages.variants();
  return {names.begin(), names.end()};
}

std::set<std::string> variants_of(const std::string& spec) {
  return variants_of(load_scene(spec).take());
}

using Names = std::set<std::string>;

TEST_F(Needs, ScenesCompileTheseVariantsOnly) {
  EXPECT_EQ(variants_of("builtin:knot?tubular=16&radial=8"),
            (Names{"NEED_LIGHTING", "relit: NEED_LIGHTING"}));
  EXPECT_EQ(variants_of("builtin:forest?trees=4&clutter=10"),
            (Names{"NEED_BASE_COLOR_MAP NEED_ALPHA_MASK NEED_VERTEX_COLOR DEPTH_ONLY",
                   "NEED_LIGHTING NEED_BASE_COLOR_MAP NEED_VERTEX_COLOR",
                   "NEED_LIGHTING NEED_VERTEX_COLOR",
                   "relit: NEED_BASE_COLOR_MAP NEED_ALPHA_MASK NEED_VERTEX_COLOR DEPTH_ONLY",
                   "relit: NEED_LIGHTING NEED_BASE_COLOR_MAP NEED_VERTEX_COLOR",
                   "relit: NEED_LIGHTING NEED_VERTEX_COLOR"}));
  const Change unlit = [](Scene& s) {
    s.materials[0].unlit = true;
    with_map(&Material::normal_map, solid_image({200, 90, 220, 255}, false))(s);
  };
  EXPECT_EQ(variants_of(prepared({unlit})), (Names{""}));
  std::vector<Change> all;
  for (const NamedChange& one : neutral_changes()) all.push_back(one.change);
  EXPECT_EQ(variants_of(prepared(all)), (Names{"NEED_LIGHTING", "relit: NEED_LIGHTING"}));
  for (const NeededChange& one : needed_changes()) {
    if (std::string(one.name) != "normal map") continue;
    EXPECT_EQ(variants_of(prepared({one.change})),
              (Names{"NEED_LIGHTING NEED_NORMAL_MAP", "relit: NEED_LIGHTING NEED_NORMAL_MAP"}));
  }
}

}  // namespace
}  // namespace mirage::test
