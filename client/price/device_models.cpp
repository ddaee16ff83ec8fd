#include "client/price/cost_model.h"

namespace mirage {
namespace {

// Mesa llvmpipe on two shared cores of 2.x GHz, CPU time of all threads: `mirage-bench --only
// price`, 2026-11.
CostModel software() {
  CostModel m;
  m[Work::kFrame] = 1;
  m[Work::kPixel] = 8.5e-5;
  m[Work::kSample] = 5e-5;
  m[Work::kMesh] = 0.3;
  m[Work::kTriangle] = 5e-5;
  m[Work::kTestedTriangle] = 5.2e-4;
  m[Work::kTestedTriangleSample] = 9.6e-4;
  m[Work::kMeshPixel] = 2.5e-5;
  m[Work::kTestedPixel] = 8e-6;
  m[Work::kTestedSample] = 6e-6;
  m[Work::kFlatPixel] = 2.5e-5;
  m[Work::kReliefPixel] = 6e-5;
  m[Work::kImpostorSample] = 2e-6;
  m[Work::kViewPixel] = 2e-5;
  return m;
}

// Estimates, because no such device was at hand: an integrated graphics part of 2020 with 20 Gpx/s
// and 0.5 Gtri/s, at a tenth of these peaks for shaded and alpha-tested surfaces. A draw call costs
// about 10 us.
CostModel laptop() {
  CostModel m;
  m[Work::kFrame] = 0.5;
  m[Work::kPixel] = 5e-7;
  m[Work::kSample] = 2e-7;
  m[Work::kMesh] = 0.03;
  m[Work::kTriangle] = 4e-6;
  m[Work::kTestedTriangle] = 8e-6;
  m[Work::kTestedTriangleSample] = 1e-6;
  m[Work::kMeshPixel] = 1e-6;
  m[Work::kTestedPixel] = 2e-6;
  m[Work::kTestedSample] = 1e-6;
  m[Work::kFlatPixel] = 8e-7;
  m[Work::kReliefPixel] = 5e-6;
  m[Work::kImpostorSample] = 2e-7;
  m[Work::kViewPixel] = 5e-7;
  return m;
}

// An estimate: a mid-range phone, at six times the laptop's prices.
CostModel phone() {
  CostModel m = laptop();
  for (double& ms : m.ms) ms *= 6;
  return m;
}

}  // namespace

std::vector<std::string> device_model_names() { return {"software", "laptop", "phone"}; }

std::optional<CostModel> device_model(const std::string& name) {
  if (name == "software") return software();
  if (name == "laptop") return laptop();
  if (name == "phone") return phone();
  return std::nullopt;
}

}  // namespace mirage
