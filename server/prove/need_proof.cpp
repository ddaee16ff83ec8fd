#include "server/prove/need_proof.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <map>

#include "protocol/impostor/tile_key.h"
#include "server/prepare/prepared_scene.h"
#include "server/prove/left_out.h"
#include "server/prove/proof_cases.h"
#include "server/render/gpu_scene.h"
#include "server/render/tile_shot.h"
#include "shaders/gl/egl_context.h"

namespace mirage {
namespace {

constexpr int kSizeClasses[] = {4, 6};  // 64 and 128 texels
constexpr int kRuleSizeClass = 6;
constexpr std::size_t kRuleCells = 6;  // for the rows of single rules
constexpr double kCaptureRadii = 4;
constexpr int kViewLevel = 8, kDistanceLevel = 2;
constexpr NeedMask kEveryMap =
    kNeedBaseColorMap | kNeedMetalRoughMap | kNeedNormalMap | kNeedOcclusionMap | kNeedEmissiveMap;
constexpr NeedMask kEverything = kEveryMap | kLobeNeeds | kLobeMapNeeds | kNeedLighting |
                                 kNeedUnlit | kNeedAlphaMask | kNeedBlend | kNeedVertexColor;

constexpr FullCoding kFullCoding{true, true, true};

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

class Prover {
 public:
  Prover(std::shared_ptr<const PreparedScene> scene, const ProofOptions& options, bool software)
      : scene_(std::move(scene)),
        options_(options),
        cells_(proof_directions(options.cells)),
        cases_(proof_lighting(*scene_)),
        instances_(first_instances(*scene_)),
        lean_(scene_),
        full_(as_imported(*scene_)),
        software_(software) {}

  Result<Proof> run();

 private:
  struct Pair {
    TileShooter full, lean;
  };
  Result<void> make_shooters();
  Result<void> prove_object(std::size_t object, const ObjectClass& of);
  Result<ProofRow> prove_whole(std::size_t object);
  Result<ProofRow> prove_rule(std::size_t object, NeedRule rule);
  TileJob job(std::size_t object, const glm::dvec3& direction, int size_class, std::size_t light,
              bool whole_light) const;
  Result<TileShooter*> forced(NeedMask needs, bool fine_depth);
  void add_row(ProofRow row);

  std::shared_ptr<const PreparedScene> scene_;
  const ProofOptions& options_;
  const std::vector<glm::dvec3> cells_;
  const std::vector<ProofLighting> cases_;
  const std::vector<std::size_t> instances_;
  GpuScene lean_, full_;
  const bool software_;
  std::unique_ptr<Pair> bytes_, floats_;
  std::map<std::pair<NeedMask, bool>, std::unique_ptr<TileShooter>> forced_;
  TileCensus census_;
  std::map<NeedRule, std::pair<std::string, std::string>> texts_;  ///< of the present object
  Proof proof_;
};

Result<void> Prover::make_shooters() {
  for (const bool floats : {false, true}) {
    TileExtras extras{kEverything, floats, true}, none{0, floats, false};
    Result<TileShooter> full = TileShooter::create(full_, options_.supersample, extras, software_);
    if (!full) return full.error();
    Result<TileShooter> lean = TileShooter::create(lean_, options_.supersample, none, software_);
    if (!lean) return lean.error();
    (floats ? floats_ : bytes_) = std::make_unique<Pair>(Pair{full.take(), lean.take()});
  }
  return {};
}

Result<TileShooter*> Prover::forced(NeedMask needs, bool fine_depth) {
  std::unique_ptr<TileShooter>& at = forced_[{needs, fine_depth}];
  if (!at) {
    Result<TileShooter> made =
        TileShooter::create(lean_, options_.supersample, {needs, false, fine_depth}, software_);
    if (!made) return made.error();
    at = std::make_unique<TileShooter>(made.take());
  }
  return at.get();
}

TileJob Prover::job(std::size_t object, const glm::dvec3& direction, int size_class,
                    std::size_t light, bool whole_light) const {
  const ObjectDescription& o = scene_->objects[object];
  TileJob out;
  out.key.object = static_cast<std::uint32_t>(object);
  out.key.cell = *view_cell_from_direction(direction, kViewLevel);
  out.key.distance = *distance_bucket_from_radii(kCaptureRadii, kDistanceLevel);
  out.key.size_class = static_cast<std::uint8_t>(size_class);
  out.key.phase = o.motion.moving() ? 1 : kStaticPhase;
  const Lighting& lighting = cases_[light].lighting;
  const Similarity placed = scene_->instance(instances_[object]).world_from_object;
  if (whole_light) {
    out.lighting = whole_object_lighting(lighting, placed, o.radius);
  } else if (o.needs & kNeedLighting) {
    out.lighting = object_lighting(lighting, placed, o.center, o.radius);
  }
  return out;
}

struct Samples {
  std::vector<double> full_ms, lean_ms;
  double full_bytes = 0, lean_bytes = 0;
  std::size_t tiles = 0;
  void put(ProofRow& row) const {
    row.full_ms = median(full_ms);
    row.lean_ms = median(lean_ms);
    const double n = std::max<double>(1, static_cast<double>(tiles));
    row.full_bytes = full_bytes / n;
    row.lean_bytes = lean_bytes / n;
  }
};

Error no_target() { return make_error(ErrorId::kGraphicsGl, "no target for a tile can be made"); }

// Proves all rules at once: bytes and floats, all cells, lights and sizes.
Result<ProofRow> Prover::prove_whole(std::size_t object) {
  ProofRow row;
  row.object = object_name(*scene_, object);
  const ObjectDescription& o = scene_->objects[object];
  Samples samples;
  double same_channels = 0;
  std::vector<double> float_ms, byte_ms;
  std::size_t out_of_range = 0;
  bool turn = false;
  for (const glm::dvec3& direction : cells_) {
    for (std::size_t light = 0; light < cases_.size(); ++light) {
      for (const int size : kSizeClasses) {
        TileJob full = job(object, direction, size, light, true);
        full.key.channels = kRelitTile;
        const TileJob lean = job(object, direction, size, light, false);
        for (Pair* pair : {bytes_.get(), floats_.get()}) {
          std::optional<TileShot> a, b;
          turn = !turn;
          if (turn) a = pair->full.shoot(full);
          b = pair->lean.shoot(lean);
          if (!turn) a = pair->full.shoot(full);
          if (!a || !b) return no_target();
          row.differing_components += differing_components(*a, *b);
          if (pair != bytes_.get()) {
            float_ms.push_back(b->ms);
            out_of_range += components_out_of_range(*b);
            continue;
          }
          byte_ms.push_back(b->ms);
          const TileCost whole = full_cost(*a, full, o, kFullCoding), cut = lean_cost(*b, lean, o);
          samples.full_ms.push_back(a->ms + whole.ms);
          samples.lean_ms.push_back(b->ms + cut.ms);
          samples.full_bytes += static_cast<double>(whole.bytes);
          samples.lean_bytes += static_cast<double>(cut.bytes);
          census_.add(*b, lean, o, cut);
          same_channels += static_cast<double>(full_cost(*a, lean, o, kFullCoding).bytes);
          ++samples.tiles;
        }
      }
    }
  }
  row.tiles = samples.tiles;
  samples.put(row);
  ProofRow range = row;
  range.rule = NeedRule::kHdr;
  range.differing_components = out_of_range;
  range.full_ms = median(float_ms);
  range.lean_ms = median(byte_ms);
  range.full_bytes = range.lean_bytes = 0;
  add_row(std::move(range));
  row.full_bytes_lit = same_channels / std::max<double>(1, static_cast<double>(row.tiles));
  return row;
}

// The changes that undo one rule in the product.
struct Undone {
  NeedMask forced = 0;
  bool whole_light = false, surface = false;
  FullCoding coding;
};

std::optional<Undone> undo(NeedRule rule, NeedMask needs) {
  const auto force = [&](NeedMask bits) {
    Undone out;
    out.forced = bits & ~needs;
    return out;
  };
  switch (rule) {
    case NeedRule::kBlending:
      return force(kNeedBlend | kNeedAlphaMask);
    case NeedRule::kSolidColor:
      return force(kNeedBaseColorMap);
    case NeedRule::kAttributes:
      return force(kNeedVertexColor);
    case NeedRule::kMaps:
      return force(kNeedMetalRoughMap | kNeedNormalMap | kNeedOcclusionMap);
    case NeedRule::kEmission:
      return force(kNeedEmissiveMap);
    case NeedRule::kExtensions:
      return force(kLobeNeeds | kLobeMapNeeds);
    case NeedRule::kLighting:
      return Undone{kNeedLighting | kNeedUnlit, true, true, {}};
    case NeedRule::kLights:
      return Undone{0, true, false, {}};
    case NeedRule::kDepthBits:
      return Undone{0, false, false, {false, true, false}};
    case NeedRule::kCrop:
      return Undone{0, false, false, {true, false, false}};
    case NeedRule::kGray:
      return Undone{0, false, false, {false, false, true}};
    default:
      return std::nullopt;  // the rule does not affect the tile
  }
}

Result<ProofRow> Prover::prove_rule(std::size_t object, NeedRule rule) {
  ProofRow row;
  row.object = object_name(*scene_, object);
  row.rule = rule;
  const ObjectDescription& o = scene_->objects[object];
  const Undone undone = *undo(rule, o.needs);
  Result<TileShooter*> made = forced(undone.forced, undone.coding.fine_depth);
  if (!made) return made.error();
  Samples samples;
  const std::size_t cells = std::min(cells_.size(), kRuleCells);
  const std::size_t light = rule == NeedRule::kLights ? 1 : 0;
  // The first draw of each kind compiles shaders and is not counted.
  for (std::size_t i = 0; i <= 2 * cells; ++i) {
    const glm::dvec3& direction = cells_[i % cells];
    TileJob full = job(object, direction, kRuleSizeClass, light, undone.whole_light);
    if (undone.surface) full.key.channels = kRelitTile;
    const TileJob lean = job(object, direction, kRuleSizeClass, light, false);
    std::optional<TileShot> a, b;
    if (i % 2) a = (*made)->shoot(full);
    b = bytes_->lean.shoot(lean);
    if (!(i % 2)) a = (*made)->shoot(full);
    if (!a || !b) return no_target();
    const TileCost whole = full_cost(*a, full, o, undone.coding);
    const TileCost cut = full_cost(*b, lean, o, {});
    if (i == 0) continue;
    row.differing_components += differing_components(*a, *b);
    samples.full_ms.push_back(a->ms + whole.ms);
    samples.lean_ms.push_back(b->ms + cut.ms);
    samples.full_bytes += static_cast<double>(whole.bytes);
    samples.lean_bytes += static_cast<double>(cut.bytes);
    ++samples.tiles;
  }
  row.tiles = samples.tiles;
  samples.put(row);
  return row;
}

// Returns one row for each rule, with its findings joined.
std::map<NeedRule, std::pair<std::string, std::string>> by_rule(const std::vector<LeftOut>& found) {
  std::map<NeedRule, std::pair<std::string, std::string>> out;
  for (const LeftOut& one : found) {
    auto& [what, why] = out[one.rule];
    what += (what.empty() ? "" : ", ") + one.what;
    if (why.find(one.why) == std::string::npos) why += (why.empty() ? "" : "; ") + one.why;
  }
  return out;
}

void Prover::add_row(ProofRow row) {
  std::tie(row.left_out, row.why) = texts_[row.rule];
  proof_.rows.push_back(std::move(row));
}

Result<void> Prover::prove_object(std::size_t object, const ObjectClass& of) {
  std::vector<LeftOut> found = of.left_out;
  const std::vector<LeftOut> everywhere = left_out_of_scene(*scene_, false);
  found.insert(found.end(), everywhere.begin(), everywhere.end());
  found.push_back({NeedRule::kLights, "3 of 3 added lamps", "they are black"});
  texts_ = by_rule(found);
  Result<ProofRow> whole = prove_whole(object);
  if (!whole) return whole.error();
  if (options_.progress) {
    options_.progress(fmt::format(
        "{}: {} tiles both ways, {} components differ; {:.2f} -> {:.2f} ms, {:.0f} -> {:.0f} bytes",
        whole->object, whole->tiles, whole->differing_components, whole->full_ms, whole->lean_ms,
        whole->full_bytes, whole->lean_bytes));
  }
  proof_.objects.push_back(whole.take());
  for (const auto& [rule, text] : texts_) {
    const bool lit = (scene_->objects[object].needs & kNeedLighting) != 0;
    if (!undo(rule, 0) || (rule == NeedRule::kLights && !lit)) continue;
    Result<ProofRow> row = prove_rule(object, rule);
    if (!row) return row.error();
    add_row(row.take());
  }
  return {};
}

Result<Proof> Prover::run() {
  if (Result<void> made = make_shooters(); !made) return made.error();
  for (const int size : kSizeClasses) proof_.edges.push_back(tile_edge(size));
  for (const ProofLighting& one : cases_) proof_.lighting.emplace_back(one.name);
  for (const ObjectClass& one : object_classes(*scene_, scene_->scene.lighting)) {
    int left = options_.objects_per_class;
    for (const std::size_t object : one.objects) {
      const bool drawn =
          scene_->objects[object].radius > 0 && instances_[object] < scene_->instance_count();
      if (!drawn || left-- <= 0) continue;
      if (Result<void> done = prove_object(object, one); !done) return done.error();
    }
  }
  for (const SceneObject& object : scene_->scene.objects) {
    census_.add_object(object, scene_->scene.materials);
  }
  proof_.dropped = census_.figures();
  ProofRow& total = proof_.total;
  for (const ProofRow& row : proof_.objects) {
    total.tiles += row.tiles;
    total.differing_components += row.differing_components;
    const double n = static_cast<double>(proof_.objects.size());
    total.full_ms += row.full_ms / n;
    total.lean_ms += row.lean_ms / n;
    total.full_bytes += row.full_bytes / n;
    total.lean_bytes += row.lean_bytes / n;
    total.full_bytes_lit += row.full_bytes_lit / n;
  }
  return std::move(proof_);
}

}  // namespace

Result<Proof> prove_needs(std::shared_ptr<const PreparedScene> scene, const ProofOptions& options) {
  Result<gl::EglContext> context = gl::EglContext::create(options.device);
  if (!context) return context.error();
  Prover prover(std::move(scene), options, context->software());
  Result<Proof> proof = prover.run();
  if (proof) proof->renderer = context->description();
  return proof;
}

}  // namespace mirage
