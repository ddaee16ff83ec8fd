// Geometric error: of a moving object, only what its tile can have seen is held against the bound.
#include "client/draw/geometric_error.h"

#include <gtest/gtest.h>

#include "client/frame/planned_frame.h"
#include "client/frame/reference_frame.h"
#include "protocol/base/limits.h"
#include "tests/support/core_scene.h"

namespace mirage::test {
namespace {

constexpr std::uint8_t kCode = 120;

// A moving ball of radius 1 m that stands still just now, 5 m before the eye. Its tile of 16 texels
// saw a flat wall, and is drawn as a quad.
struct MovingBall {
  MovingBall() {
    scene = make_scene({{{0, 0, 0}}});
    MotionProfile& motion = scene.objects[0].motion;
    motion.clip_s = 1;
    motion.speed.assign(limits::kMotionSegments, 0.0f);
    record = std::make_shared<TileRecord>();
    record->capture = Capture({4, 8, 8}, *distance_bucket_from_radii(5, 2), 1, 16);
    record->crop = {1, 1, 14, 14};
    record->depth.assign(record->crop.area(), kCode);
    record->depth_code = DepthCode(1, record->capture.distance);
    record->phase = 1;
    wall_m = record->depth_code.decode(kCode);
    const double step = record->depth_code.quantum();
    record->measure.depth_min = static_cast<float>(wall_m - step);
    record->measure.depth_max = static_cast<float>(wall_m + step);
    record->measure.plane_depth = static_cast<float>(wall_m);
    // The eye stands where the tile was captured, a little aside.
    camera.width = camera.height = 64;
    camera.pose = look_at(record->capture.eye() + glm::dvec3(0.5, 0, 0), {0, 0, 0});
  }

  // Compares the middle pixel: it shows the ball at this depth of the capture.
  GeometricError at(double capture_depth, double bound_px) const {
    const glm::dvec3 axis = record->capture.basis.forward;
    const glm::dvec3 ray = camera.forward(), eye = camera.pose.eye - record->capture.eye();
    ReferenceFrame truth;
    truth.width = truth.height = 64;
    truth.depth.assign(64 * 64, 0);
    truth.ids.assign(64 * 64, 0);
    const std::size_t middle = 32 * 64 + 32;
    truth.depth[middle] =
        static_cast<float>((capture_depth - glm::dot(eye, axis)) / glm::dot(ray, axis));
    truth.ids[middle] = 1;
    DrawnImpostor impostor;
    impostor.tile = record;
    impostor.method = DrawMethod::kQuad;
    impostor.bound_px = bound_px;
    DrawList list;
    list.impostors.push_back(impostor);
    GeometricError out;
    add_geometric_error(truth, 0.5, {camera, &scene, list, {}}, out);
    return out;
  }

  SceneView scene;
  std::shared_ptr<TileRecord> record;
  Camera camera;
  double wall_m = 0;
};

TEST(ClientGeometricError, APointOfAMovingObjectThatTheTileSawIsHeldAgainstItsBound) {
  const MovingBall ball;
  const GeometricError kept = ball.at(ball.wall_m, 5);
  EXPECT_EQ(kept.compared, 1u);
  EXPECT_EQ(kept.violations, 0u);
  MovingBall moved;
  moved.record->measure.plane_depth *= 1.5f;  // a tile that is drawn where nothing was
  const GeometricError broken = moved.at(moved.wall_m, 0.1);
  EXPECT_EQ(broken.compared, 1u);
  EXPECT_EQ(broken.violations, 1u);
}

TEST(ClientGeometricError, APointOfAMovingObjectBeyondTheTilesDepthsWasNotSeen) {
  const MovingBall ball;
  // one and a half texels behind the wall: within the tolerance for slopes
  const double behind = ball.wall_m + 1.5 * ball.record->capture.texel_width(ball.wall_m);
  const GeometricError error = ball.at(behind, 0);
  EXPECT_EQ(error.compared, 0u);
  EXPECT_EQ(error.violations, 0u);
  EXPECT_EQ(error.disoccluded, 1u);
}

TEST(ClientGeometricError, HowFarAPointMayHaveMovedWidensTheTilesDepths) {
  MovingBall ball;
  const double behind = ball.wall_m + 1.5 * ball.record->capture.texel_width(ball.wall_m);
  ball.scene.objects[0].motion.wrap_jump = 0;
  ball.scene.objects[0].motion.speed.assign(limits::kMotionSegments, 1.0f);
  ball.record->phase = 129;  // half a clip away: half a metre
  EXPECT_EQ(ball.at(behind, 100).compared, 1u);
}

}  // namespace
}  // namespace mirage::test
