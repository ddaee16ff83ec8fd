// A1 to A7: premultiplied colour from the tile to the frame.

#include <algorithm>
#include <cmath>

#include "client/draw/frame_target.h"
#include "client/scene/scene_view.h"
#include "protocol/codec/image_codec.h"
#include "protocol/codec/tile_codec.h"
#include "server/render/gpu_scene.h"
#include "tests/extreme/registry.h"
#include "tests/extreme/shapes.h"
#include "tests/extreme/studio.h"

namespace mirage::extreme {
namespace {

constexpr int kSize = 96;

double linear(int srgb) {
  const double s = srgb / 255.0;
  return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

/// An upright square facing +z, or two triangles of one material with the given texture.
struct Card {
  double z = 0;
  double half = 1;
  glm::vec4 color{1};
  AlphaMode mode = AlphaMode::kBlend;
  int image = -1;
};

/// Unlit cards under a black sky, each an object of its own.
Scene cards(const std::vector<Card>& list, std::vector<Image> images = {}) {
  Scene scene;
  scene.images = std::move(images);
  scene.environment.zenith = scene.environment.horizon = scene.environment.nadir = glm::vec3(0);
  for (const Card& card : list) {
    Material material;
    material.unlit = true;
    material.base_color = card.color;
    material.alpha_mode = card.mode;
    material.base_color_map.image = card.image;
    material.base_color_map.nearest = true;
    SceneObject object;
    const auto h = static_cast<float>(card.half);
    for (const auto& [x, y] : {std::pair{0.f, 0.f}, {1.f, 0.f}, {1.f, 1.f}, {0.f, 1.f}}) {
      Vertex v;
      v.position = {h * (2 * x - 1), h * (2 * y - 1), 0};
      v.uv0 = {x, 1 - y};
      object.mesh.vertices.push_back(v);
    }
    object.mesh.indices = {0, 1, 2, 0, 2, 3};
    object.mesh.primitives.push_back(
        {PrimitiveKind::kTriangles, 0, 6, static_cast<std::uint32_t>(scene.materials.size())});
    Instance instance;
    instance.object = static_cast<std::uint32_t>(scene.objects.size());
    instance.world_from_object.position = {0, 0, card.z};
    scene.materials.push_back(material);
    scene.objects.push_back(object);
    scene.instances.push_back(instance);
  }
  return scene;
}

Camera facing(const Studio& studio, double distance, int size = kSize) {
  Camera camera;
  camera.width = camera.height = static_cast<std::uint32_t>(size);
  camera.fov_y = 2 * std::atan(1.2 / distance);
  camera.pose = look_at({0, 0, distance}, {0, 0, 0});
  camera.fit_depth_range(studio.scene().bounds_center, studio.scene().bounds_radius);
  return camera;
}

/// Makes tiles of every kind of content: opaque, alpha-tested, blended; lit and relit.
Result<std::vector<MadeTile>> all_kinds(const Conditions& conditions, TileCodec codec) {
  std::vector<MadeTile> out;
  Random random(conditions.seed);
  for (const char* mode : {"OPAQUE", "MASK", "BLEND"}) {
    test::Builder builder = document(dented_ball());
    set_material(builder, {{"alphaMode", mode},
                           {"pbrMetallicRoughness", {{"baseColorFactor", {0.9, 0.4, 0.2, 0.6}}}}});
    Result<std::unique_ptr<Studio>> studio =
        Studio::create(write(builder, conditions.folder, mode));
    if (!studio) return studio.error();
    for (int i = 0; i < (conditions.quick ? 2 : 8); ++i) {
      const Camera camera = (*studio)->camera(0, random.direction(), random.uniform(2, 10), kSize);
      for (const std::uint8_t channels : {kLitTile, kRelitTile}) {
        if (channels == kRelitTile && mode[0] == 'B') continue;
        out.push_back((*studio)->make_tile((*studio)->key_for(camera, 0, channels), 0, codec));
      }
    }
  }
  return out;
}

// A1
Outcome nothing_is_black(const Conditions& conditions) {
  Result<std::vector<MadeTile>> tiles = all_kinds(conditions, TileCodec::kZstd);
  if (!tiles) return no_studio(tiles.error());
  int empty = 0, colored = 0;
  for (const MadeTile& made : *tiles) {
    for (std::size_t i = 0; i < made.tile.rgba.size(); i += 4) {
      const std::uint8_t* p = &made.tile.rgba[i];
      if (p[3] != 0) continue;
      ++empty;
      colored += p[0] | p[1] | p[2] ? 1 : 0;
    }
  }
  // A card that is nothing but transparent.
  Result<std::unique_ptr<Studio>> studio = Studio::create(cards({{0, 1, {1, 0.5f, 0.2f, 0}}}));
  if (!studio) return no_studio(studio.error());
  const Camera camera = facing(**studio, 5);
  const Pixels clear = (*studio)->impostors(camera, DrawMethod::kQuad);
  Checks checks;
  checks.at_least("empty texels", empty, 1000);
  checks.equal("of them with colour", colored, 0);
  checks.equal("brightest of a transparent card",
               clear.empty() ? 256 : *std::max_element(clear.begin(), clear.end()), 0);
  return checks.outcome();
}

/// Returns the pixels whose neighbourhood of `reach` is solid in `truth`.
std::vector<bool> interior(const Pixels& truth, int reach) {
  std::vector<bool> out(truth.size() / 4, false);
  for (int y = reach; y + reach < kSize; ++y) {
    for (int x = reach; x + reach < kSize; ++x) {
      bool solid = true;
      for (int v = y - reach; v <= y + reach && solid; ++v) {
        for (int u = x - reach; u <= x + reach && solid; ++u) {
          solid = truth[static_cast<std::size_t>((v * kSize + u) * 4 + 3)] == 255;
        }
      }
      out[static_cast<std::size_t>(y * kSize + x)] = solid;
    }
  }
  return out;
}

int not_solid(const Pixels& drawn, const std::vector<bool>& inside) {
  int n = 0;
  for (std::size_t i = 0; i < inside.size(); ++i) n += inside[i] && drawn[i * 4 + 3] != 255 ? 1 : 0;
  return n;
}

// A2: the inside of an opaque object is solid: in the truth, as geometry, in its tile, drawn by
// every method.
Outcome solid_is_solid(const Conditions& conditions) {
  Result<std::unique_ptr<Studio>> studio =
      Studio::create(write(document(dented_ball()), conditions.folder, "ball"));
  if (!studio) return no_studio(studio.error());
  Random random(conditions.seed);
  Checks checks;
  int px = 0, bad_mesh = 0, bad_tile = 0, bad_drawn = 0;
  for (int i = 0; i < (conditions.quick ? 2 : 8); ++i) {
    const Camera camera = (*studio)->camera(0, random.direction(), random.uniform(2, 20), kSize);
    const std::vector<bool> inside = interior((*studio)->truth(camera).rgba, 3);
    px += static_cast<int>(std::count(inside.begin(), inside.end(), true));
    bad_mesh += not_solid((*studio)->meshes(camera), inside);
    for (const std::uint8_t channels : {kLitTile, kRelitTile}) {
      const MadeTile made = (*studio)->make_tile((*studio)->key_for(camera, 0, channels), 0);
      const Tile& t = made.tile;
      // An opaque ball is solid in each row, between its first and last solid texel.
      for (std::uint32_t y = 0; y < t.crop.h; ++y) {
        int first = -1, last = -1;
        const auto alpha = [&](int x) {
          return t.rgba[(std::size_t{y} * t.crop.w + static_cast<std::size_t>(x)) * 4 + 3];
        };
        for (int x = 0; x < static_cast<int>(t.crop.w); ++x) {
          if (alpha(x) != 255) continue;
          first = first < 0 ? x : first;
          last = x;
        }
        for (int x = first; x >= 0 && x <= last; ++x) bad_tile += alpha(x) == 255 ? 0 : 1;
      }
      for (const DrawMethod method : {DrawMethod::kQuad, DrawMethod::kCuboid, DrawMethod::kHull,
                                      DrawMethod::kWarp, DrawMethod::kDepth}) {
        bad_drawn += not_solid((*studio)->impostors(camera, method, channels), inside);
      }
    }
  }
  checks.at_least("px inside", px, 2000);
  checks.equal("geometry below 255", bad_mesh, 0);
  checks.equal("texels below 255 between solid ones", bad_tile, 0);
  checks.equal("impostors below 255", bad_drawn, 0);
  return checks.outcome();
}

// A3: premultiplied colours of any alpha, put into a tile as if decoded, come out of the client's
// drawing unchanged. Dividing by alpha and multiplying again would move dark ones by many steps.
Outcome straight_through(const Conditions& conditions) {
  Scene scene = cards({{0, 1, {1, 1, 1, 1}, AlphaMode::kOpaque}});
  scene.materials[0].unlit = false;
  scene.lighting.ambient = glm::vec3(1);
  scene.lighting.lights.clear();
  Result<std::unique_ptr<Studio>> studio = Studio::create(std::move(scene), {0, 2});
  if (!studio) return no_studio(studio.error());
  const Camera camera = facing(**studio, 5, 32);
  Random random(conditions.seed);
  int worst = 0, worst_alpha = 0, tried = 0;
  for (const std::uint8_t channels : {kLitTile, kRelitTile}) {
    MadeTile made = (*studio)->make_tile((*studio)->key_for(camera, 0, channels), 0);
    for (int i = 0; i < (conditions.quick ? 60 : 400); ++i) {
      const int alpha = i < 20 ? i + 1 : static_cast<int>(random.uniform(1, 256));
      std::array<int, 4> texel{0, 0, 0, alpha};
      for (std::size_t c = 0; c < 3; ++c) {
        // Largest encoded value that premultiplying by this alpha can give.
        const int most = encoded(alpha / 255.0);
        texel[c] = std::min(most, static_cast<int>(random.uniform(0, most + 1)));
      }
      for (std::size_t t = 0; t < made.tile.rgba.size(); ++t) {
        made.tile.rgba[t] = static_cast<std::uint8_t>(texel[t % 4]);
      }
      const TileRecordPtr record = (*studio)->hold(made, 0);
      if (!record) return no_studio(make_error(ErrorId::kInternal, "tile not held"));
      DrawList list;
      list.impostors.push_back({0, record, DrawMethod::kQuad, 0, 5, 1});
      const Pixels drawn = (*studio)->draw(camera, list);
      const std::uint8_t* p = &drawn[(16 * 32 + 16) * 4];
      for (std::size_t c = 0; c < 3; ++c) worst = std::max(worst, std::abs(p[c] - texel[c]));
      worst_alpha = std::max(worst_alpha, std::abs(p[3] - texel[3]));
      ++tried;
    }
  }
  Checks checks;
  checks.at_least("texels", tried, 100);
  checks.at_most("colour changed by", worst, 1);
  checks.at_most("alpha changed by", worst_alpha, 0);
  return checks.outcome();
}

// A4: a long chain of layers against the same chain in double.
Outcome long_chain(const Conditions& conditions) {
  Random random(conditions.seed);
  Checks checks;
  constexpr int kDeep = 64;
  for (const double alpha : {0.02, 0.1, 0.5, -1.0}) {
    std::vector<Card> list;
    glm::dvec4 expected(0);
    for (int i = 0; i < kDeep; ++i) {
      const double a = alpha > 0 ? alpha : random.uniform(0, 1);
      const glm::dvec3 color(random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1));
      list.push_back({-2.0 + 0.03 * i, 1.2, glm::vec4(glm::vec3(color), static_cast<float>(a))});
      expected = glm::dvec4(color, 1) * a + expected * (1 - a);
    }
    Result<std::unique_ptr<Studio>> studio = Studio::create(cards(list), {0, 2});
    if (!studio) return no_studio(studio.error());
    const Camera camera = facing(**studio, 8, 32);
    const auto off = [](const Pixels& p, const glm::dvec4& exact) {
      const std::uint8_t* at = &p[(16 * 32 + 16) * 4];
      int worst = std::abs(at[3] - static_cast<int>(std::lround(exact.a * 255)));
      for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs(at[c] - encoded(exact[c])));
      return worst;
    };
    // Tiles hold 8 bits, so their chain starts from the stored values.
    glm::dvec4 of_tiles(0);
    for (std::uint32_t i = 0; i < kDeep; ++i) {
      const Tile tile = (*studio)->make_tile((*studio)->key_for(camera, i, kLitTile), i).tile;
      const std::uint8_t* t =
          &tile.rgba[(std::size_t{tile.crop.h / 2} * tile.crop.w + tile.crop.w / 2) * 4];
      const glm::dvec4 layer(linear(t[0]), linear(t[1]), linear(t[2]), t[3] / 255.0);
      of_tiles = layer + of_tiles * (1 - layer.a);
    }
    const std::string name = alpha > 0 ? "alpha " + number_text(alpha) : "any alpha";
    checks.at_most(name + ", truth", off((*studio)->truth(camera).rgba, expected), 2);
    checks.at_most(name + ", geometry", off((*studio)->meshes(camera), expected), 2);
    checks.at_most(name + ", impostors",
                   off((*studio)->impostors(camera, DrawMethod::kQuad), of_tiles), 2);
  }
  return checks.outcome();
}

// A5: a texel sends out no more than it covers, before and after both codecs.
Outcome color_within_alpha(const Conditions& conditions) {
  Checks checks;
  std::vector<std::uint64_t> hashes;
  for (const TileCodec codec : {TileCodec::kRaw, TileCodec::kZstd}) {
    Result<std::vector<MadeTile>> tiles = all_kinds(conditions, codec);
    if (!tiles) return no_studio(tiles.error());
    int above = 0, partial = 0, changed = 0;
    for (const MadeTile& made : *tiles) {
      changed += tile_content_hash(made.tile) == made.header.content_hash ? 0 : 1;
      hashes.push_back(made.header.content_hash);
      above += above_alpha(made.tile.rgba);
      for (std::size_t i = 3; i < made.tile.rgba.size(); i += 4) {
        partial += made.tile.rgba[i] > 0 && made.tile.rgba[i] < 255 ? 1 : 0;
      }
    }
    const std::string name = codec == TileCodec::kRaw ? "raw: " : "zstd: ";
    checks.at_least(name + "texels partly covered", partial, 500);
    checks.equal(name + "components above alpha", above, 0);
    checks.equal(name + "tiles changed on the way", changed, 0);
  }
  const std::size_t half = hashes.size() / 2;
  checks.holds("same tiles",
               std::equal(hashes.begin(), hashes.begin() + static_cast<std::ptrdiff_t>(half),
                          hashes.begin() + static_cast<std::ptrdiff_t>(half)));
  return checks.outcome();
}

// A6: one card whose texture has only 0 and 255, tested and blended. It is so large that no mip
// level between them is read.
Outcome mask_is_blend(const Conditions& conditions) {
  Image image;
  image.width = image.height = 8;
  Random random(conditions.seed);
  for (int i = 0; i < 64; ++i) {
    for (int c = 0; c < 3; ++c)
      image.rgba.push_back(static_cast<std::uint8_t>(random.uniform(0, 256)));
    image.rgba.push_back(random.uniform(0, 1) < 0.5 ? 0 : 255);
  }
  const auto make = [&](AlphaMode mode) {
    return Studio::create(cards({{0, 1, glm::vec4(1), mode, 0}}, {image}), {0, 3});
  };
  Result<std::unique_ptr<Studio>> mask = make(AlphaMode::kMask), blend = make(AlphaMode::kBlend);
  if (!mask || !blend) return no_studio((mask ? blend : mask).error());
  Checks checks;
  const Camera camera = facing(**mask, 5);
  const auto compare = [&](const std::string& name, const Pixels& a, const Pixels& b, int most) {
    int differing = 0, compared = 0;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); i += 4) {
      const bool whole = (a[i + 3] == 0 || a[i + 3] == 255) && (b[i + 3] == 0 || b[i + 3] == 255);
      if (!whole) continue;
      compared += a[i + 3] == 255 ? 1 : 0;
      for (std::size_t c = 0; c < 4; ++c) differing += std::abs(a[i + c] - b[i + c]) > most ? 1 : 0;
    }
    checks.at_least(name + ": solid px compared", compared, 500);
    checks.equal(name + ": components that differ", differing, 0);
  };
  compare("truth", (*mask)->truth(camera).rgba, (*blend)->truth(camera).rgba, 0);
  compare("geometry", (*mask)->meshes(camera), (*blend)->meshes(camera), 0);
  const auto tile = [&](Studio& s) { return s.make_tile(s.key_for(camera, 0, kLitTile), 0).tile; };
  const Tile a = tile(**mask), b = tile(**blend);
  checks.holds("tile: same crop", a.crop.w == b.crop.w && a.crop.h == b.crop.h);
  compare("tile", a.rgba, b.rgba, 0);
  return checks.outcome();
}

// A7: one tile fades in over another of the same object, and geometry replaces a tile.
Outcome cross_fade(const Conditions& conditions) {
  Result<std::unique_ptr<Studio>> studio =
      Studio::create(write(document(dented_ball()), conditions.folder, "ball"));
  if (!studio) return no_studio(studio.error());
  const Camera camera = (*studio)->camera(0, {0.5, 0.4, 1}, 4, kSize);
  const Camera beside = (*studio)->camera(0, {0.52, 0.4, 1}, 4.2, kSize);
  const std::vector<bool> inside = interior((*studio)->truth(camera).rgba, 5);
  (void)(*studio)->meshes(camera);  // so that the geometry is there
  int bad_tiles = 0, bad_mesh = 0;
  const int steps = conditions.quick ? 8 : 64;
  for (const std::uint8_t channels : {kLitTile, kRelitTile}) {
    const auto make = [&](const Camera& c) {
      return (*studio)->hold((*studio)->make_tile((*studio)->key_for(c, 0, channels), 0), 0);
    };
    const TileRecordPtr former = make(beside), now = make(camera);
    for (const DrawMethod method : {DrawMethod::kQuad, DrawMethod::kHull, DrawMethod::kDepth}) {
      for (int i = 0; i <= steps; ++i) {
        const float fade = static_cast<float>(i) / static_cast<float>(steps);
        DrawList list;
        list.impostors.push_back({0, former, method, 0, 4, 1});
        list.impostors.push_back({0, now, method, 0, 4, fade});
        bad_tiles += not_solid((*studio)->draw(camera, list), inside);
        list.impostors.pop_back();
        list.meshes.push_back({0, 0, fade});
        bad_mesh += not_solid((*studio)->draw(camera, list), inside);
      }
    }
  }
  Checks checks;
  checks.at_least("px inside", static_cast<double>(std::count(inside.begin(), inside.end(), true)),
                  1000);
  checks.equal("tile over tile: px below 255", bad_tiles, 0);
  checks.equal("geometry over tile: px below 255", bad_mesh, 0);
  return checks.outcome();
}

}  // namespace

std::vector<Case> alpha_cases() {
  return {
      {"A1", "texels without any cover, of opaque, tested and blended objects", "alpha 0 -> rgb 0",
       nothing_is_black},
      {"A2", "the inside of an opaque object", "alpha exactly 255", solid_is_solid},
      {"A3", "premultiplied colours of every alpha through cache and drawing",
       "never un-premultiplied on the path", straight_through},
      {"A4", "64 blended surfaces one over another", "<= 2 LSB", long_chain},
      {"A5", "tiles through every codec", "rgb <= a", color_within_alpha},
      {"A6", "MASK and BLEND with alpha 0 and 255 only", "equal", mask_is_blend},
      {"A7", "cross-fade of an opaque object", "alpha 255 throughout", cross_fade},
  };
}

}  // namespace mirage::extreme
