// Views on the server: who gets which one, when, and how they are cut.
#include <gtest/gtest.h>

#include "protocol/wire/view_codec.h"
#include "server/tile/view_cut.h"
#include "tests/support/session_hub_test.h"

namespace mirage::test {
namespace {

class ServerView : public SessionHubTest {
 protected:
  /// Returns the views that the GL thread would draw next.
  std::vector<ViewJob> take_views() {
    std::vector<ViewJob> out;
    while (auto work = queue.take({[](std::uint32_t) { return true; }}, false)) {
      if (auto* view = std::get_if<ViewJob>(&*work)) out.push_back(std::move(*view));
    }
    return out;
  }
  void finish(const ViewJob& job, bool made = true) {
    FinishedView done{job.id, nullptr};
    if (made) {
      ViewTile view;
      view.camera = job.shot.camera;
      view.rgba.resize(std::size_t{view.camera.width} * view.camera.height * 4);
      view.depth.resize(std::size_t{view.columns()} * view.rows());
      view.owners.resize(view.depth.size());
      done.view = std::make_shared<const EncodedView>(encode_view(view));
    }
    hub->complete(std::move(done));
  }
  static wire::ViewRequestT request(std::uint32_t id, double x = 0) {
    wire::ViewRequestT m = view_request(Camera{}, 0);
    m.request_id = id;
    *m.eye = wire::Vec3d(x, 0, 0);
    return m;
  }
  static wire::HelloT hello_with_view() {
    wire::HelloT m = hello();
    m.view = std::make_unique<wire::ViewRequestT>(request(5));
    m.view->home = true;
    return m;
  }
};

TEST_F(ServerView, TheHomeViewComesBeforeTheDescription) {
  hub->make_home_view();
  const std::vector<ViewJob> jobs = take_views();
  ASSERT_EQ(jobs.size(), 1u);
  const Camera& camera = jobs[0].shot.camera;
  EXPECT_EQ(camera.pose.eye, home_pose(scene_->scene.home, screen_of(camera)).eye);
  // A viewer's own home differs by what the request's size is rounded by.
  const glm::dvec3 off = camera.pose.eye - home_pose(scene_->scene.home, Camera()).eye;
  EXPECT_LT(glm::length(off), 0.02 * glm::length(camera.pose.eye));
  finish(jobs[0]);
  const SessionId id = hub->open();
  ASSERT_TRUE(send(id, hello_with_view()).ok());
  const std::vector<Message> messages = drain(id);
  ASSERT_EQ(messages.size(), 4u);
  const wire::ViewReplyT* view = messages[1].body.AsViewReply();
  ASSERT_TRUE(view) << "right after the welcome";
  EXPECT_EQ(view->request_id, 5u);
  EXPECT_TRUE(view->kept);
  EXPECT_TRUE(take_views().empty());
}

// Before its levels of detail are made, a scene's welcome and home view are sent, and no more.
TEST_F(ServerView, BeforeLevelsTheHomeViewIsSentAlone) {
  queue.wait_for_levels();
  restart({});
  hub->make_home_view();
  const SessionId id = hub->open();
  ASSERT_TRUE(send(id, hello_with_view()).ok());
  const std::vector<ViewJob> home = take_views();
  ASSERT_EQ(home.size(), 1u);
  EXPECT_TRUE(home[0].shot.whole) << "there are no levels to draw it from";
  finish(home[0]);
  std::vector<Message> messages = drain(id);
  ASSERT_EQ(messages.size(), 2u);
  EXPECT_TRUE(messages[0].body.AsWelcome());
  EXPECT_TRUE(messages[1].body.AsViewReply());

  ASSERT_TRUE(send_ask(id, ask(1)).ok());
  ASSERT_TRUE(send(id, request(7, 3)).ok());
  wire::RequestBatchT batch;
  batch.mesh_asks = {wire::MeshAsk(2, 0, 0)};
  ASSERT_TRUE(send(id, std::move(batch)).ok());
  EXPECT_EQ(refusal(id), wire::RefusalReason::Busy) << "geometry of an object not yet described";
  EXPECT_TRUE(take_views().empty()) << "views from elsewhere may use levels";
  EXPECT_TRUE(take_tiles().empty());

  hub->take_writable();
  queue.levels_made();
  hub->complete(LevelsMade{});
  EXPECT_EQ(hub->take_writable(), std::set<SessionId>{id});
  messages = drain(id);
  ASSERT_EQ(messages.size(), 2u);
  EXPECT_TRUE(messages[0].body.AsObjectPage());
  EXPECT_TRUE(messages[1].body.AsInstancePage());
  const auto first = queue.take({[](std::uint32_t) { return true; }}, false);
  ASSERT_TRUE(first);
  EXPECT_TRUE(std::holds_alternative<TileQueue::UploadLevels>(*first)) << "before any tile";
  const auto next = queue.take({[](std::uint32_t) { return true; }}, false);
  ASSERT_TRUE(next);
  EXPECT_TRUE(std::holds_alternative<ViewJob>(*next));
  EXPECT_EQ(take_tiles().size(), 1u);
}

TEST_F(ServerView, OneIsDrawnForAllWhoWait) {
  const SessionId a = greeted(), b = greeted();
  ASSERT_TRUE(send(a, request(1, 3)).ok());
  ASSERT_TRUE(send(b, request(2, 3)).ok());
  const std::vector<ViewJob> jobs = take_views();
  ASSERT_EQ(jobs.size(), 1u);
  finish(jobs[0]);
  const std::vector<Message> for_a = drain(a), for_b = drain(b);
  ASSERT_EQ(for_a.size(), 1u);
  ASSERT_EQ(for_b.size(), 1u);
  EXPECT_EQ(for_a[0].body.AsViewReply()->request_id, 1u);
  EXPECT_FALSE(for_a[0].body.AsViewReply()->kept);
  EXPECT_TRUE(for_b[0].body.AsViewReply()->kept) << "it was on its way";
}

TEST_F(ServerView, AClientWaitsForOneAtATime) {
  const SessionId id = greeted(), other = greeted();
  ASSERT_TRUE(send(id, request(1, 1)).ok());
  for (std::uint32_t i = 2; i < 1000; ++i) {
    ASSERT_TRUE(send(id, request(i, i)).ok());
    ASSERT_EQ(refusal(id), wire::RefusalReason::Busy);
  }
  ASSERT_TRUE(send(other, request(1, 7)).ok());
  const std::vector<ViewJob> jobs = take_views();
  EXPECT_EQ(jobs.size(), 2u) << "one of each";
  for (const ViewJob& job : jobs) finish(job);
  EXPECT_EQ(drain(id).size(), 1u);
  ASSERT_TRUE(send(id, request(1001, 9)).ok());
  EXPECT_EQ(take_views().size(), 1u);
}

TEST_F(ServerView, TilesComeBetweenViews) {
  const SessionId a = greeted(), b = greeted();
  ASSERT_TRUE(send(a, request(1, 1)).ok());
  ASSERT_TRUE(send(b, request(1, 2)).ok());
  ASSERT_TRUE(send_ask(a, ask(7)).ok());
  std::vector<bool> view;
  while (const auto work = queue.take({[](std::uint32_t) { return true; }}, false)) {
    view.push_back(std::holds_alternative<ViewJob>(*work));
  }
  EXPECT_EQ(view, (std::vector<bool>{true, false, true}));
}

TEST_F(ServerView, TheHomeViewWaitsForTilesUntilSomebodyWantsIt) {
  const SessionId a = greeted();
  hub->make_home_view();
  ASSERT_TRUE(send_ask(a, ask(7)).ok());
  const auto first = queue.take({[](std::uint32_t) { return true; }}, false);
  EXPECT_TRUE(first && std::holds_alternative<std::vector<TileJob>>(*first));
  ASSERT_TRUE(send_ask(a, ask(8, 1)).ok());
  ASSERT_TRUE(send(hub->open(), hello_with_view()).ok());
  const auto second = queue.take({[](std::uint32_t) { return true; }}, false);
  ASSERT_TRUE(second && std::holds_alternative<ViewJob>(*second));
  EXPECT_TRUE(std::get<ViewJob>(*second).home);
}

TEST_F(ServerView, WhatCannotBeMadeIsRefusedByName) {
  const SessionId id = greeted();
  ASSERT_TRUE(send(id, request(1)).ok());
  finish(take_views().at(0), false);
  EXPECT_EQ(refusal(id), wire::RefusalReason::TooLarge);
  wire::ViewRequestT unknown = request(2);
  unknown.lighting_id = 99;
  ASSERT_TRUE(send(id, std::move(unknown)).ok());
  EXPECT_EQ(refusal(id), wire::RefusalReason::BadKey);
  SessionOptions options;
  options.view = false;
  restart(options);
  hub->make_home_view();
  const SessionId now = greeted();
  ASSERT_TRUE(send(now, request(3)).ok());
  EXPECT_EQ(refusal(now), wire::RefusalReason::NoView);
  EXPECT_TRUE(take_views().empty());
}

TEST_F(ServerView, WhoLeavesIsForgotten) {
  const SessionId id = greeted();
  ASSERT_TRUE(send(id, request(1)).ok());
  const std::vector<ViewJob> jobs = take_views();
  hub->close(id);
  finish(jobs.at(0));
  EXPECT_TRUE(hub->take_writable().empty());
}

TEST_F(ServerView, WhoComesAsksAndGoesLeavesNoWork) {
  hub->make_home_view();
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const SessionId id = greeted();
    ASSERT_TRUE(send(id, request(1, i)).ok());
    hub->close(id);
  }
  const SessionId id = hub->open();
  ASSERT_TRUE(send(id, hello_with_view()).ok());
  hub->close(id);
  const std::vector<ViewJob> jobs = take_views();
  ASSERT_EQ(jobs.size(), 1u) << "the home view is kept for the next";
  EXPECT_TRUE(jobs[0].home);
}

TEST(ServerViewCut, ACellShowsItsNearestSurface) {
  Camera camera;
  camera.width = 16;
  camera.height = 16;
  SceneFrame frame;
  frame.rgba.assign(16 * 16 * 4, 100);
  frame.depth.assign(16 * 16, 0);
  frame.ids.assign(16 * 16, 0);
  frame.depth[0] = 8;
  frame.ids[0] = 5 + 1;
  frame.depth[17] = 2;  // the same cell
  frame.ids[17] = 3 + 1;
  frame.depth[2] = 8;
  frame.ids[2] = 5 + 1;
  const ViewTile view = cut_view(camera, frame);
  EXPECT_EQ(view.instances, (std::vector<std::uint32_t>{3, 5}));
  EXPECT_EQ(view.owners[0], 1);
  EXPECT_EQ(view.owners[1], 2);
  EXPECT_EQ(view.owners[2], 0);
  EXPECT_EQ(view.depth[2], 0);
  EXPECT_NEAR(view.decode_depth(view.depth[0]), 2, 0.05);
  EXPECT_NEAR(view.decode_depth(view.depth[1]), 8, 0.1);
  EXPECT_EQ(view.near_m, 2);
  EXPECT_EQ(view.far_m, 8);
}

TEST(ServerViewCut, NoMoreOwnersThanAreToldApart) {
  Camera camera;
  camera.width = 320;
  camera.height = 240;
  SceneFrame frame;
  const std::size_t pixels = 320u * 240u;
  frame.rgba.assign(pixels * 4, 100);
  frame.depth.assign(pixels, 4);
  for (std::uint32_t i = 0; i < pixels; ++i) frame.ids.push_back(i / 2 % 160 + i / 640 * 160 + 1);
  const ViewTile view = cut_view(camera, frame);
  EXPECT_EQ(view.instances.size(), limits::kMaxViewInstances);
  std::size_t nobody = 0;
  for (const std::uint16_t owner : view.owners) nobody += owner == ViewTile::kNobody;
  EXPECT_EQ(nobody, view.owners.size() - limits::kMaxViewInstances);
}

}  // namespace
}  // namespace mirage::test
