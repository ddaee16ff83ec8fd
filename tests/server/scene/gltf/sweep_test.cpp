// Loads every file of ../shared/assets and ../shared/assets_broken, and compares with its manifest.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>

#include "server/scene/gltf/draco_decode.h"
#include "server/scene/gltf/gltf_import.h"
#include "tests/support/data_folder.h"

namespace mirage {
namespace {

namespace fs = std::filesystem;

using Row = std::map<std::string, std::string>;

// Generous for slow machines and sanitizers; the files themselves take milliseconds.
constexpr double kMaxSeconds = 5;
constexpr long kMaxResidentKib = 1L << 20;

std::vector<std::string> split_tabs(const std::string& line) {
  std::vector<std::string> fields;
  std::stringstream stream(line);
  for (std::string field; std::getline(stream, field, '\t');) fields.push_back(field);
  return fields;
}

std::vector<Row> read_manifest(const fs::path& folder) {
  std::ifstream in(folder / "MANIFEST.tsv");
  std::string line;
  std::getline(in, line);
  const std::vector<std::string> keys = split_tabs(line);
  std::vector<Row> rows;
  while (std::getline(in, line)) {
    const std::vector<std::string> fields = split_tabs(line);
    Row row;
    for (std::size_t i = 0; i < keys.size(); ++i) row[keys[i]] = i < fields.size() ? fields[i] : "";
    rows.push_back(row);
  }
  return rows;
}

bool is_unit(const glm::vec3& v) { return std::abs(glm::length(v) - 1.0f) < 1e-4f; }

/// Checks what every loaded scene promises to later stages.
void expect_sound(const Scene& scene) {
  for (const SceneObject& object : scene.objects) {
    const Mesh& mesh = object.mesh;
    ASSERT_FALSE(mesh.primitives.empty());
    for (const Vertex& vertex : mesh.vertices) {
      ASSERT_TRUE(std::isfinite(glm::dot(vertex.position, vertex.position)));
      ASSERT_TRUE(is_unit(vertex.normal));
      ASSERT_TRUE(is_unit(glm::vec3(vertex.tangent)));
      ASSERT_TRUE(std::isfinite(vertex.uv0.x + vertex.uv0.y + vertex.uv1.x + vertex.uv1.y));
    }
    for (const std::uint32_t index : mesh.indices) ASSERT_LT(index, mesh.vertices.size());
    for (const Primitive& primitive : mesh.primitives) {
      ASSERT_LE(primitive.first_index + primitive.index_count, mesh.indices.size());
      ASSERT_LT(primitive.material, scene.materials.size());
    }
  }
  for (const Instance& instance : scene.instances) {
    ASSERT_LT(instance.object, scene.objects.size());
    ASSERT_GT(instance.world_from_object.scale, 0);
    ASSERT_NEAR(glm::length(instance.world_from_object.rotation), 1, 1e-5);
  }
  for (const Image& image : scene.images) {
    ASSERT_EQ(image.rgba.size(), std::size_t{image.width} * image.height * 4);
  }
  ASSERT_FALSE(scene.lighting.lights.empty());
  ASSERT_TRUE(std::isfinite(glm::length(scene.home.eye - scene.home.target)));
}

struct Outcome {
  std::string id = "loaded";
  std::string text;
  std::uint64_t triangles = 0;
  bool empty = false;
};

Outcome load_timed(const fs::path& file) {
  SCOPED_TRACE(file.string());
  const auto start = std::chrono::steady_clock::now();
  const Result<Scene> scene = import_gltf(file.string());
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  EXPECT_LT(took.count(), kMaxSeconds);
  Outcome outcome;
  if (scene) {
    expect_sound(*scene);
    outcome.triangles = scene->triangles();
    outcome.empty = scene->instances.empty();
    for (const std::string& warning : scene->warnings) outcome.text += warning + "; ";
    EXPECT_EQ(outcome.text.find('\n'), std::string::npos);
  } else {
    outcome.id = error_name(scene.error().id);
    outcome.text = scene.error().line();
    EXPECT_EQ(exit_code(scene.error().id), ExitCode::kScene);
    EXPECT_EQ(outcome.text.find('\n'), std::string::npos);
  }
  if (std::getenv("MIRAGE_SWEEP_VERBOSE") != nullptr) {
    std::cout << file.filename().string() << " " << took.count() << " s: " << outcome.id << ", "
              << outcome.triangles << " triangles: " << outcome.text << "\n";
  }
  return outcome;
}

void print_counts(const std::map<std::string, int>& counts) {
  for (const auto& [id, count] : counts) std::cout << "  " << count << " " << id << "\n";
}

TEST(GltfSweep, AssetsLoad) {
  const fs::path folder = test::data_folder() / "assets";
  if (!fs::exists(folder / "MANIFEST.tsv")) GTEST_SKIP() << folder << " is absent";
  std::map<std::string, int> counts;
  for (const Row& row : read_manifest(folder)) {
    SCOPED_TRACE(row.at("file"));
    const Outcome outcome = load_timed(folder / row.at("file"));
    ++counts[outcome.id];
    const bool draco = row.at("extensions_required").find("draco") != std::string::npos;
    if (draco && !gltf::has_draco()) {
      EXPECT_EQ(outcome.id, "scene-extension") << outcome.text;
      continue;
    }
    ASSERT_EQ(outcome.id, "loaded") << outcome.text;
    EXPECT_EQ(outcome.text.find("unreadable images"), std::string::npos) << outcome.text;
    if (std::stoull("0" + row.at("triangles")) > 0) {
      EXPECT_GT(outcome.triangles, 0u) << outcome.text;
    }
  }
  print_counts(counts);
}

/// Models found in public; each one went wrong at first in its own way.
TEST(GltfSweep, FieldModelsLoad) {
  const fs::path folder = test::data_folder() / "assets" / "field";
  if (!fs::exists(folder)) GTEST_SKIP() << folder << " is absent";
  std::map<std::string, int> counts;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string kind = entry.path().extension().string();
    if (kind != ".glb" && kind != ".gltf") continue;
    SCOPED_TRACE(entry.path().filename().string());
    const Outcome outcome = load_timed(entry.path());
    ++counts[outcome.id];
    const bool draco = entry.path().filename().string().find("raco") != std::string::npos ||
                       entry.path().filename().string().starts_with("LittlestTokyo");
    if (draco && !gltf::has_draco()) continue;
    EXPECT_EQ(outcome.id, "loaded") << outcome.text;
    EXPECT_GT(outcome.triangles, 0u) << outcome.text;
  }
  print_counts(counts);
}

/// Returns "error", "loads" or "any", from the words of the manifest.
std::string expectation(const Row& row) {
  const std::string& words = row.at("expected");
  const bool bare_error = words == "error" || words.starts_with("error, ");
  if (bare_error) return "error";
  return words.starts_with("loads") && words.find(" or ") == std::string::npos ? "loads" : "any";
}

/// True for defects that other viewers accept; strict loading refuses them.
bool is_forgiven(const std::string& warnings) {
  for (const char* part : {"drawn once",
                           "image files left out",
                           "unreadable images",
                           "URIs with",
                           "duplicate names",
                           "reduced to fit",
                           "variants of one name",
                           "other counts than declared",
                           "that cannot be",
                           "unset properties",
                           "a few bytes off",
                           "than they say",
                           "glTF forbids",
                           "without a place",
                           "than beside the file",
                           "listed again",
                           "loops of nodes",
                           "left unskinned (first",
                           "not UTF-8",
                           "required extensions"}) {
    if (warnings.find(part) != std::string::npos) return true;
  }
  return false;
}

TEST(GltfSweep, StrictRefusesWhatIsForgivenAndNothingElse) {
  const fs::path folder = test::data_folder() / "assets_broken";
  if (!fs::exists(folder / "MANIFEST.tsv")) GTEST_SKIP() << folder << " is absent";
  int forgiven = 0;
  for (const Row& row : read_manifest(folder)) {
    SCOPED_TRACE(row.at("file"));
    if (!fs::exists(folder / row.at("file"))) continue;
    const Outcome outcome = load_timed(folder / row.at("file"));
    if (outcome.id != "loaded") continue;
    const bool refused =
        !import_gltf((folder / row.at("file")).string(), Workers(), {.strict = true}).ok();
    EXPECT_EQ(refused, is_forgiven(outcome.text)) << outcome.text;
    forgiven += refused ? 1 : 0;
  }
  std::cout << "  " << forgiven << " forgiven\n";
  EXPECT_GT(forgiven, 0);
}

TEST(GltfSweep, BrokenAssetsEndCleanly) {
  const fs::path folder = test::data_folder() / "assets_broken";
  if (!fs::exists(folder / "MANIFEST.tsv")) GTEST_SKIP() << folder << " is absent";
  std::map<std::string, int> counts;
  for (const Row& row : read_manifest(folder)) {
    SCOPED_TRACE(row.at("file"));
    if (!fs::exists(folder / row.at("file"))) continue;
    const Outcome outcome = load_timed(folder / row.at("file"));
    ++counts[outcome.id];
    const std::string expected = expectation(row);
    if (expected == "error") {
      EXPECT_NE(outcome.id, "loaded") << outcome.text;
    }
    if (expected == "loads") {
      EXPECT_EQ(outcome.id, "loaded") << outcome.text;
    }
    if (row.at("expected") == "loads, draws nothing") {
      EXPECT_TRUE(outcome.empty);
    }
  }
  print_counts(counts);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
#if !defined(__SANITIZE_ADDRESS__)
  EXPECT_LT(usage.ru_maxrss, kMaxResidentKib);
#endif
}

}  // namespace
}  // namespace mirage
