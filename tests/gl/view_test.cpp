// View tiles in drawing: at their own pose they are the picture, and objects with an image of their
// own are left out.
#include <gtest/gtest.h>

#include "client/draw/frame_renderer.h"
#include "client/draw/frame_target.h"
#include "client/frame/draw_list.h"
#include "client/frame/planned_frame.h"
#include "client/scene/scene_view.h"
#include "server/prepare/prepared_scene.h"
#include "server/render/gpu_scene.h"
#include "server/render/reference_renderer.h"
#include "server/tile/view_cut.h"
#include "shaders/gl/egl_context.h"

namespace mirage::test {
namespace {

class GlView : public ::testing::Test {
 protected:
  GlView() : egl_(gl::EglContext::create("auto").take()) {
    prepared_ = *load_scene("builtin:clutter?objects=30");
    gpu_ = std::make_unique<GpuScene>(prepared_);
    const HomeView& home = prepared_->scene.home;
    camera_.pose = look_at(home.eye, home.target);
    camera_.width = 320;
    camera_.height = 180;
    camera_.fit_depth_range(prepared_->bounds_center, prepared_->bounds_radius);
    scene_.environment = prepared_->scene.environment;
  }
  SceneFrame full(const Camera& camera, double level_px) {
    ReferenceRenderer renderer = ReferenceRenderer::create(*gpu_).take();
    return renderer.draw({camera, 2, prepared_->scene.lighting, 0, level_px}).take();
  }
  std::vector<std::uint8_t> drawn(const Camera& camera, const ViewTile& view,
                                  const std::vector<bool>& owners) {
    FrameRenderer renderer = FrameRenderer::create(256, 1).take();
    renderer.upload_view(view);
    FrameTarget target =
        FrameTarget::create(static_cast<int>(camera.width), static_cast<int>(camera.height), 0)
            .take();
    DrawList list;
    list.view = DrawnView{std::make_shared<const ViewTile>(view), owners};
    renderer.draw(target, {camera, &scene_, list, prepared_->scene.lighting});
    return target.read();
  }
  static double mean_difference(const std::vector<std::uint8_t>& a,
                                const std::vector<std::uint8_t>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (i % 4 != 3) sum += std::abs(int{a[i]} - int{b[i]});
    }
    return sum / (static_cast<double>(a.size()) * 0.75);
  }

  gl::EglContext egl_;
  std::shared_ptr<const PreparedScene> prepared_;
  std::unique_ptr<GpuScene> gpu_;
  Camera camera_;
  SceneView scene_;
};

TEST_F(GlView, IsThePictureAtItsOwnPoseAndFollowsTheEye) {
  const SceneFrame truth = full(camera_, 0);
  const ViewTile view = cut_view(camera_, full(camera_, 1));
  const std::vector<bool> all(view.instances.size(), true);
  ASSERT_GT(view.instances.size(), 10u);
  // The outermost half cell has no neighbours to be drawn with.
  EXPECT_LT(mean_difference(drawn(camera_, view, all), truth.rgba), 3.5);
  Camera aside = camera_;
  aside.pose.eye += camera_.right() * 0.15;
  const SceneFrame moved = full(aside, 0);
  const double warped = mean_difference(drawn(aside, view, all), moved.rgba);
  EXPECT_LT(warped, 0.6 * mean_difference(truth.rgba, moved.rgba)) << "it moves with its depth";
}

TEST_F(GlView, WhatHasAnImageIsLeftOut) {
  const ViewTile view = cut_view(camera_, full(camera_, 1));
  const std::vector<bool> all(view.instances.size(), true), none(view.instances.size(), false);
  const std::vector<std::uint8_t> full_view = drawn(camera_, view, all),
                                  empty = drawn(camera_, view, none);
  const auto covered = [](const std::vector<std::uint8_t>& rgba) {
    std::size_t n = 0;
    for (std::size_t i = 3; i < rgba.size(); i += 4) n += rgba[i] > 0;
    return n;
  };
  EXPECT_EQ(covered(empty), 0u);
  EXPECT_GT(covered(full_view), 300u * 170u) << "a room has no sky";
  // One owner alone: its cells and the ones beside them.
  std::vector<std::size_t> cells(view.instances.size());
  for (const std::uint16_t owner : view.owners) {
    if (owner > 0 && owner != ViewTile::kNobody) ++cells[owner - 1u];
  }
  const auto one =
      static_cast<std::size_t>(std::max_element(cells.begin(), cells.end()) - cells.begin());
  std::vector<bool> alone = none;
  alone[one] = true;
  const std::size_t shown = covered(drawn(camera_, view, alone));
  EXPECT_GT(shown, cells[one] * 3);
  EXPECT_LT(shown, covered(full_view));
}

}  // namespace
}  // namespace mirage::test
