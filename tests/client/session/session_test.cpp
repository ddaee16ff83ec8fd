// The client's session against the server's, without sockets: reconnects, and replies that nobody
// asked for.
#include "server/session/session.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "client/frame/planned_frame.h"
#include "client/link/link.h"
#include "client/scene/scene_view.h"
#include "client/session/client_session.h"
#include "client/session/session_options.h"
#include "client/session/tile_sink.h"
#include "server/prepare/prepared_scene.h"

namespace mirage::test {
namespace {

/// The server's sessions as the other end of a link.
class HubLink final : public Link {
 public:
  HubLink() : scene_(*load_scene("builtin:knot?tubular=16&radial=8")) { restart({}); }
  /// Restarts the server with another scene, without geometry; the connection is a new one.
  void serve(const std::string& scene) {
    scene_ = *load_scene(scene);
    SessionOptions options;
    options.geometry = false;
    restart(std::move(options));
  }
  /// Restarts the server; the connection is a new one.
  void restart(SessionOptions options) {
    hub_ = std::make_unique<SessionHub>(scene_, std::move(options), queues_);
    id_ = hub_->open();
    ++generation_;
  }
  void send(Bytes bytes) override {
    EXPECT_TRUE(hub_->receive(id_, bytes.data(), bytes.size()).ok());
  }
  std::vector<Message> receive() override {
    std::vector<Message> out = std::exchange(unasked, {});
    PacketAssembler assembler(limits::kMaxTransferBytes);
    while (const PacketPtr packet = hub_->next_packet(id_)) {
      auto whole = assembler.accept(packet->data(), packet->size());
      if (!whole || !whole->has_value()) continue;
      out.push_back(decode_message((*whole)->data(), (*whole)->size()).take());
    }
    if (pages_reversed && out.size() > 1) std::reverse(out.begin() + 1, out.end());
    return out;
  }
  bool connected() const override { return true; }
  std::uint32_t generation() const override { return generation_; }
  LinkTraffic traffic() const override { return {}; }

  std::vector<Message> unasked;  ///< received next
  bool pages_reversed = false;   ///< pages after a welcome arrive in reverse order

 private:
  std::shared_ptr<const PreparedScene> scene_;
  VirtualClock clock_;
  StageQueues queues_{clock_, 1 << 24, {}};
  std::unique_ptr<SessionHub> hub_;
  SessionId id_ = 0;
  std::uint32_t generation_ = 0;
};

struct CoreSession : ::testing::Test {
  CoreSession() : session(link, {}, counting()) { EXPECT_TRUE(session.receive(0).ok()); }
  TileSink counting() {
    TileSink sink;
    sink.scene = [this](const SceneView&) { ++scenes; };
    return sink;
  }
  int scenes = 0;
  HubLink link;
  ClientSession session;
};

TEST_F(CoreSession, TheSameSceneIsKeptOverAReconnect) {
  ASSERT_EQ(scenes, 1);
  ASSERT_TRUE(session.scene().complete());
  link.restart({});
  ASSERT_TRUE(session.receive(1).ok());
  EXPECT_EQ(scenes, 1);
  EXPECT_TRUE(session.scene().complete());
}

TEST(CoreSessionPages, WhatComesBeforeItsTurnWaits) {
  HubLink link;
  link.pages_reversed = true;
  ClientSession session(link, {}, {});
  EXPECT_TRUE(session.receive(0).ok());
  EXPECT_TRUE(session.scene().complete());
  EXPECT_EQ(session.scene().instances.size(), 1u);
}

// If the client did not start afresh, it would ask for ever for what the server no longer has, and
// never for what it has now.
TEST_F(CoreSession, AServerWithOtherOptionsIsAnotherScene) {
  SessionOptions options;
  options.shadows = true;
  link.restart(options);
  ASSERT_TRUE(session.receive(1).ok());
  EXPECT_EQ(scenes, 2);
  EXPECT_TRUE(session.scene().shadows);
  options.geometry = false;
  link.restart(options);
  ASSERT_TRUE(session.receive(2).ok());
  EXPECT_EQ(scenes, 3);
  EXPECT_FALSE(session.scene().geometry);
}

// The last picture of the former scene is shown until there is something of the new one. This
// server draws nothing, so it is shown for 3 s.
TEST_F(CoreSession, ThePictureOfTheLastSceneStaysUntilThereIsOneOfTheNext) {
  constexpr std::int64_t kSecond = 1'000'000;
  Camera camera;
  camera.pose = look_at({0, 0, 5}, {0, 0, 0});
  camera.fit_depth_range({0, 0, 0}, 2);
  const auto frame_at = [&](std::int64_t now_us) {
    EXPECT_TRUE(session.receive(now_us).ok());
    return session.frame(camera, now_us).list;
  };
  frame_at(0);
  EXPECT_FALSE(session.awaits_new_scene());
  link.restart({});
  frame_at(kSecond);
  EXPECT_FALSE(session.awaits_new_scene()) << "the same scene";
  link.serve("builtin:knot?tubular=20&radial=8");
  EXPECT_FALSE(frame_at(2 * kSecond).placeholders.empty());
  EXPECT_TRUE(session.awaits_new_scene());
  frame_at(4 * kSecond);
  EXPECT_TRUE(session.awaits_new_scene());
  frame_at(5 * kSecond + 1);
  EXPECT_FALSE(session.awaits_new_scene()) << "blobs are better than nothing";
  link.serve("builtin:knot?tubular=24&radial=8");
  frame_at(6 * kSecond);
  EXPECT_TRUE(session.awaits_new_scene());
  camera.pose = look_at({0, 0, 5}, {0, 0, 10});
  frame_at(6 * kSecond + 1);
  EXPECT_FALSE(session.awaits_new_scene()) << "there is nothing in view to wait for";
}

TEST_F(CoreSession, GeometryAndImagesNobodyAskedForAreErrors) {
  wire::MeshReplyT mesh;
  mesh.request_id = 7;
  Message message;
  message.body.Set(std::move(mesh));
  link.unasked.push_back(std::move(message));
  Result<void> received = session.receive(1);
  ASSERT_FALSE(received.ok());
  EXPECT_EQ(received.error().id, ErrorId::kWireValue);
  wire::ImageReplyT image;
  image.request_id = 8;
  message.body.Set(std::move(image));
  message.unpacked = true;
  link.unasked.push_back(std::move(message));
  received = session.receive(2);
  ASSERT_FALSE(received.ok());
  EXPECT_EQ(received.error().id, ErrorId::kWireValue);
}

}  // namespace
}  // namespace mirage::test
