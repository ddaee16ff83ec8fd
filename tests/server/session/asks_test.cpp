// Asks to a session without sockets: tiles, geometry, images; credit, refusals.
#include <gtest/gtest.h>

#include "protocol/codec/tile_codec.h"
#include "protocol/wire/conversions.h"
#include "server/stage/image_stage.h"
#include "tests/support/session_hub_test.h"

namespace mirage::test {
namespace {

class ServerAsks : public SessionHubTest {};

TEST_F(ServerAsks, AsksAreQueuedAndAnswered) {
  const SessionId a = greeted(), b = greeted();
  ASSERT_TRUE(send_ask(a, ask(11)).ok());
  ASSERT_TRUE(send_ask(b, ask(22)).ok());
  EXPECT_EQ(queue.length(), 1u) << "one key, one job";
  EXPECT_EQ(render_all(), 1u);
  for (const auto& [id, request] : {std::pair{a, 11u}, std::pair{b, 22u}}) {
    const std::vector<Message> messages = drain(id);
    ASSERT_EQ(messages.size(), 1u);
    EXPECT_EQ(messages[0].body.AsTileReply()->request_id, request);
  }
  ASSERT_TRUE(send_ask(a, ask(12)).ok());
  EXPECT_EQ(queue.length(), 0u) << "from the store";
  ASSERT_EQ(drain(a).size(), 1u);
}

TEST_F(ServerAsks, AWelcomeTellsWhatATileTakes) {
  const auto told = [&] {
    const SessionId id = hub->open();
    EXPECT_TRUE(send(id, hello()).ok());
    return drain(id).front().body.AsWelcome()->tile_us;
  };
  EXPECT_EQ(told(), 0u) << "none was rendered";
  ASSERT_TRUE(send_ask(greeted(), ask(1)).ok());
  render_all();
  const wire::TileReplyT tile = sample_tile_reply();
  EXPECT_EQ(told(), tile.render_us + tile.encode_us);
  ASSERT_GT(told(), 0u);
}

TEST_F(ServerAsks, BadKeysAreRefusedNotFatal) {
  using R = wire::RefusalReason;
  const SessionId id = greeted();
  const auto refused = [&](wire::Ask one) {
    EXPECT_TRUE(send_ask(id, one).ok());
    return refusal(id);
  };
  const auto changed = [](std::uint32_t instance, std::uint32_t object, std::int32_t distance,
                          std::uint16_t x, std::uint8_t level, std::uint8_t distance_level,
                          std::uint8_t size, std::uint8_t channels) {
    return wire::Ask(1, instance, object, 1.0f, 0, distance, x, 0, level, distance_level, size,
                     channels, 0);
  };
  EXPECT_EQ(refused(changed(0, 1, 8, 0, 9, 2, 2, 3)), R::UnknownObject);
  EXPECT_EQ(refused(changed(1, 0, 8, 0, 9, 2, 2, 3)), R::UnknownObject);
  EXPECT_EQ(refused(changed(UINT32_MAX, UINT32_MAX, 8, 0, 9, 2, 2, 3)), R::UnknownObject);
  EXPECT_EQ(refused(changed(0, 0, INT32_MAX, 0, 9, 2, 2, 3)), R::BadKey);
  EXPECT_EQ(refused(changed(0, 0, INT32_MIN, 0, 9, 2, 2, 3)), R::BadKey);
  EXPECT_EQ(refused(changed(0, 0, -8, 0, 9, 2, 2, 3)), R::BadKey) << "inside the ball";
  EXPECT_EQ(refused(changed(0, 0, 8, 512, 9, 2, 2, 3)), R::BadKey);
  EXPECT_EQ(refused(changed(0, 0, 8, 0, 17, 2, 2, 3)), R::BadKey);
  EXPECT_EQ(refused(changed(0, 0, 8, 0, 9, 255, 2, 3)), R::BadKey);
  EXPECT_EQ(refused(changed(0, 0, 8, 0, 9, 2, 15, 3)), R::BadKey);
  EXPECT_EQ(refused(changed(0, 0, 8, 0, 9, 2, 2, 7)), R::BadKey);
  EXPECT_EQ(refused(changed(0, 0, 8, 0, 9, 2, 2, kLayeredTile)), R::BadKey) << "it is opaque";
  EXPECT_EQ(queue.length(), 0u);
  wire::RequestBatchT batch;
  batch.lighting_id = 5;  // never set
  batch.asks = {ask(1)};
  ASSERT_TRUE(send(id, std::move(batch)).ok());
  EXPECT_EQ(refusal(id), R::BadKey);
}

TEST_F(ServerAsks, PhasesBelongToMovingObjectsOnly) {
  using R = wire::RefusalReason;
  const auto with_phase = [](std::uint32_t request, std::uint16_t phase) {
    return wire::Ask(request, 0, 0, 1.0f, 0, 8, 0, 0, 9, 2, 2, kLitTile, phase);
  };
  const SessionId still = greeted();
  ASSERT_TRUE(send_ask(still, with_phase(1, 1)).ok());
  EXPECT_EQ(refusal(still), R::BadKey);

  auto moving = std::make_shared<PreparedScene>(*scene_);
  moving->objects[0].motion.clip_s = 2;
  moving->objects[0].motion.speed.assign(limits::kMotionSegments, 1.0f);
  restart({}, moving);
  const SessionId id = greeted();
  for (const Phase phase : std::initializer_list<Phase>{0, 257, 65535}) {
    ASSERT_TRUE(send_ask(id, with_phase(2, phase)).ok());
    EXPECT_EQ(refusal(id), R::BadKey) << phase;
  }
  for (const Phase phase : std::initializer_list<Phase>{1, 2, 256}) {
    ASSERT_TRUE(send_ask(id, with_phase(phase, phase)).ok());
  }
  EXPECT_EQ(queue.length(), 3u) << "each phase is a tile of its own";
}

TEST_F(ServerAsks, CreditHoldsTilesBack) {
  const SessionId id = greeted();
  const auto request = [&](std::vector<wire::Ask> asks, std::uint64_t credit) {
    wire::RequestBatchT batch;
    batch.asks = std::move(asks);
    batch.credit_bytes = credit;
    ASSERT_TRUE(send(id, std::move(batch)).ok());
  };
  request({ask(1, 1), ask(2, 2), ask(3, 3), ask(4, 4)}, 0);
  EXPECT_EQ(render_all(10'000), 4u);
  EXPECT_TRUE(drain(id).empty());
  request({}, 1);
  EXPECT_EQ(drain(id).size(), 1u) << "begun is finished";
  request({}, 25'000);
  EXPECT_EQ(drain(id).size(), 2u);
  request({}, 1);  // credit never falls
  EXPECT_TRUE(drain(id).empty());
  send(id, sample_stats_request()).ok();
  EXPECT_EQ(drain(id).size(), 1u) << "control needs none";
  request({}, 1'000'000);
  EXPECT_EQ(drain(id).size(), 1u);
}

TEST_F(ServerAsks, ATileCostsNoMoreCreditThanTheClientCounts) {
  // The client counts this many bytes a tile. If it counted less than the server, a session would
  // dry up one day.
  const SessionId id = greeted();
  std::uint16_t n = 0;
  for (const std::size_t payload : {0, 1000, 131'072, 400'000, 3'000'000}) {
    ASSERT_TRUE(send_ask(id, ask(n, n)).ok());
    ++n;
    render_all(payload);
    std::size_t sent = 0;
    while (const PacketPtr packet = hub->next_packet(id)) sent += packet->size();
    EXPECT_GT(sent, payload);
    EXPECT_LE(sent, tile_credit_bytes(payload));
    EXPECT_GE(sent + 300, tile_credit_bytes(payload) - payload / 2048) << "it is no wild guess";
  }
}

wire::ReferenceRequestT full_render(std::uint32_t request, std::uint32_t edge) {
  wire::ReferenceRequestT m;
  m.request_id = request;
  m.width = m.height = edge;
  m.fov_y = 1;
  m.supersample = 1;
  m.eye = std::make_unique<wire::Vec3d>(0, 0, 5);
  m.rotation = std::make_unique<wire::Quat>(1.0f, 0.0f, 0.0f, 0.0f);
  return m;
}

TEST_F(ServerAsks, FullRendersOfAllClientsHaveABudget) {
  constexpr std::uint32_t kEdge = 4096;  // 192 MiB
  const SessionId first = greeted(), second = greeted(), third = greeted();
  ASSERT_TRUE(send(first, full_render(1, kEdge)).ok());
  ASSERT_TRUE(send(second, full_render(1, kEdge)).ok());
  ASSERT_TRUE(send(third, full_render(1, kEdge)).ok());
  EXPECT_EQ(refusal(third), wire::RefusalReason::Busy);
  ASSERT_TRUE(send(third, full_render(2, 1024)).ok());
  EXPECT_EQ(refusal(third), wire::RefusalReason::None) << "there is room for a small one";
  hub->close(first);
  const SessionId fourth = greeted();
  ASSERT_TRUE(send(fourth, full_render(1, kEdge)).ok());
  EXPECT_EQ(refusal(fourth), wire::RefusalReason::None);
}

TEST_F(ServerAsks, AClientHasOneFullRenderUntilItHasReadIt) {
  const SessionId id = greeted();
  const auto wanted = [&](std::uint32_t request) {
    EXPECT_TRUE(send(id, full_render(request, 64)).ok());
  };
  const auto drawn = [&] {
    const auto work = queue.take({[](std::uint32_t) { return true; }}, false);
    return work && std::holds_alternative<ReferenceJob>(*work);
  };
  wanted(1);
  ASSERT_TRUE(drawn());
  wanted(2);
  EXPECT_FALSE(drawn()) << "one is being drawn";
  EXPECT_EQ(refusal(id), wire::RefusalReason::Busy);
  hub->complete(FinishedReference{id, Bytes(100'000)});
  wanted(3);
  EXPECT_FALSE(drawn()) << "one waits to be read";
  while (hub->next_packet(id)) {
  }
  wanted(4);
  EXPECT_TRUE(drawn());
}

TEST_F(ServerAsks, GeometryAndReferenceCanBeOff) {
  SessionOptions options;
  options.geometry = options.reference = false;
  restart(options);
  const SessionId id = greeted();
  wire::RequestBatchT batch;
  batch.mesh_asks = {wire::MeshAsk(7, 0, 0)};
  ASSERT_TRUE(send(id, std::move(batch)).ok());
  EXPECT_EQ(refusal(id), wire::RefusalReason::NoGeometry);
  ASSERT_TRUE(send(id, sample_reference_request()).ok());
  EXPECT_EQ(refusal(id), wire::RefusalReason::NoReference);
}

TEST_F(ServerAsks, GeometryComesByLevel) {
  const SessionId id = greeted();
  const auto levels = static_cast<std::uint8_t>(scene_->objects[0].lods.size());
  ASSERT_GE(levels, 1);
  const auto last = static_cast<std::uint8_t>(levels - 1);
  wire::RequestBatchT batch;
  batch.mesh_asks = {wire::MeshAsk(1, 0, last), wire::MeshAsk(2, 1, 0),
                     wire::MeshAsk(3, 0, levels)};
  ASSERT_TRUE(send(id, std::move(batch)).ok());
  const std::vector<Message> messages = drain(id);
  ASSERT_EQ(messages.size(), 3u);
  EXPECT_EQ(messages[0].body.AsRefused()->reason, wire::RefusalReason::UnknownObject);
  EXPECT_EQ(messages[0].body.AsRefused()->request_id, 2u);
  EXPECT_EQ(messages[1].body.AsRefused()->request_id, 3u);
  const wire::MeshReplyT* mesh = messages[2].body.AsMeshReply();
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->request_id, 1u);
  EXPECT_EQ(mesh->lod, last);
  const Bytes& payload = messages[2].payload;
  EXPECT_EQ(payload.size(), scene_->objects[0].lods[last].bytes);
  const auto raw = mesh->raw_bytes == payload.size()
                       ? Result<Bytes>(payload)
                       : decompress_block(payload.data(), payload.size(), mesh->raw_bytes);
  ASSERT_TRUE(raw);
  const auto model = decode_model(raw->data(), raw->size(), scene_->images.size());
  ASSERT_TRUE(model);
  EXPECT_EQ(model->mesh.indices.size() / 3, scene_->objects[0].lods[last].triangles);
}

TEST_F(ServerAsks, ImagesAreEncodedOnceForAll) {
  const std::shared_ptr<const PreparedScene> forest =
      *load_scene("builtin:forest?trees=4&clutter=1");
  restart({}, forest);
  const SessionId first = greeted(), second = greeted();
  wire::RequestBatchT batch;
  batch.image_asks = {wire::ImageAsk(5, 0, 1)};
  ASSERT_TRUE(send(first, wire::RequestBatchT(batch)).ok());
  batch.image_asks[0] = wire::ImageAsk(6, 0, 1);
  ASSERT_TRUE(send(second, wire::RequestBatchT(batch)).ok());
  EXPECT_TRUE(drain(first).empty());
  ASSERT_TRUE(send(second, wire::RequestBatchT(batch)).ok());
  EXPECT_EQ(refusal(second), wire::RefusalReason::Busy) << "it waits for this one already";
  std::optional<ImageLevel> job = image_jobs.try_pop();
  ASSERT_TRUE(job);
  EXPECT_FALSE(image_jobs.try_pop()) << "one job for both";
  const Bytes bytes = ImageStage::encode(*forest, *job);
  hub->complete(FinishedImage{*job, bytes});
  for (const auto& [id, request] : {std::pair(first, 5u), std::pair(second, 6u)}) {
    const std::vector<Message> messages = drain(id);
    ASSERT_EQ(messages.size(), 1u);
    ASSERT_TRUE(messages[0].body.AsImageReply());
    EXPECT_EQ(messages[0].body.AsImageReply()->request_id, request);
    EXPECT_EQ(messages[0].payload, bytes);
  }
  // A repeated ask is answered from the cache. An image that does not exist is refused.
  batch.image_asks = {wire::ImageAsk(7, 0, 1), wire::ImageAsk(8, 0, 9), wire::ImageAsk(9, 9999, 0)};
  ASSERT_TRUE(send(first, std::move(batch)).ok());
  EXPECT_FALSE(image_jobs.try_pop());
  EXPECT_EQ(drain(first).size(), 3u);
}

wire::GroundRequestT ground_request(std::uint32_t request, std::int32_t x) {
  wire::GroundRequestT out;
  out.request_id = request;
  out.x = x;
  out.z = -3;
  return out;
}

TEST_F(ServerAsks, GroundIsMadeOnceForAll) {
  auto walked = std::make_shared<PreparedScene>(*scene_);
  walked->scene.home.walk_eye_m = 1.7;
  restart({}, walked);
  const SessionId first = greeted(), second = greeted();
  ASSERT_TRUE(send(first, ground_request(5, 7)).ok());
  ASSERT_TRUE(send(second, ground_request(6, 7)).ok());
  const std::optional<GroundBlockId> job = queues.grounds.try_pop();
  ASSERT_TRUE(job);
  EXPECT_TRUE(job->x == 7 && job->z == -3);
  EXPECT_FALSE(queues.grounds.try_pop()) << "one job for both";
  hub->complete(FinishedGround{*job, {{1, 2, 3}, 99}});
  ASSERT_TRUE(send(second, ground_request(7, 7)).ok());
  EXPECT_FALSE(queues.grounds.try_pop()) << "it is kept";
  const auto answers = [&](SessionId id, const std::vector<std::uint32_t>& requests) {
    const std::vector<Message> messages = drain(id);
    ASSERT_EQ(messages.size(), requests.size());
    for (std::size_t i = 0; i < requests.size(); ++i) {
      const wire::GroundReplyT* reply = messages[i].body.AsGroundReply();
      ASSERT_TRUE(reply);
      EXPECT_EQ(reply->request_id, requests[i]);
      EXPECT_EQ(reply->raw_bytes, 99u);
      EXPECT_EQ(messages[i].payload, (Bytes{1, 2, 3}));
    }
  };
  answers(first, {5});
  answers(second, {6, 7});
}

TEST_F(ServerAsks, GroundIsRefusedWhereNobodyWalksAndWhereItFails) {
  const SessionId still = greeted();
  ASSERT_TRUE(send(still, ground_request(1, 0)).ok());
  EXPECT_EQ(refusal(still), wire::RefusalReason::UnknownObject) << "the knot is orbited";
  auto walked = std::make_shared<PreparedScene>(*scene_);
  walked->scene.home.walk_eye_m = 1.7;
  restart({}, walked);
  const SessionId id = greeted();
  for (int i = 0; i < 8; ++i) ASSERT_TRUE(send(id, ground_request(i, i)).ok());
  EXPECT_TRUE(drain(id).empty());
  ASSERT_TRUE(send(id, ground_request(9, 9)).ok());
  EXPECT_EQ(refusal(id), wire::RefusalReason::Busy) << "one client takes no more than its share";
  hub->complete(FinishedGround{*queues.grounds.try_pop(), {}});
  EXPECT_EQ(refusal(id), wire::RefusalReason::TooLarge);
}

TEST_F(ServerAsks, TheAskTooManyIsBusy) {
  const SessionId id = greeted();
  std::uint32_t request = 0;
  for (int i = 0; i < 4; ++i) {
    wire::RequestBatchT batch;
    for (int k = 0; k < 1024; ++k, ++request) {
      batch.asks.push_back(ask(request, static_cast<std::uint16_t>(request % 512),
                               static_cast<std::uint8_t>(request / 512)));
    }
    ASSERT_TRUE(send(id, std::move(batch)).ok());
  }
  EXPECT_TRUE(drain(id).empty());
  ASSERT_TRUE(send_ask(id, ask(request, 1, 12)).ok());
  EXPECT_EQ(refusal(id), wire::RefusalReason::Busy);
  const SessionId other = greeted();
  ASSERT_TRUE(send_ask(other, ask(1, 1, 12)).ok());
  EXPECT_TRUE(drain(other).empty());
}

TEST_F(ServerAsks, ShadowsBelongToAnInstanceAndALightAndCastersToNeither) {
  const auto of_kind = [](std::uint32_t request, std::uint8_t channels) {
    return ask(request, 0, 2, channels);
  };
  for (const std::uint8_t kind : {kShadowTile, kCasterTile}) {
    const SessionId id = greeted();
    ASSERT_TRUE(send_ask(id, of_kind(1, kind)).ok());
    EXPECT_EQ(refusal(id), wire::RefusalReason::BadKey) << "without --shadows";
  }
  SessionOptions options;
  options.shadows = true;
  restart(options);
  const SessionId id = greeted();
  ASSERT_TRUE(send_ask(id, of_kind(1, kShadowTile)).ok());
  ASSERT_TRUE(send_ask(id, of_kind(2, kCasterTile)).ok());
  const std::vector<TileJob> jobs = take_tiles();
  ASSERT_EQ(jobs.size(), 2u);
  const TileJob& shadow = jobs[jobs[0].key.channels == kShadowTile ? 0 : 1];
  const TileJob& caster = jobs[jobs[0].key.channels == kShadowTile ? 1 : 0];
  EXPECT_EQ(shadow.key.instance, 1u);
  EXPECT_EQ(shadow.key.lighting, lighting_hash(scene_->scene.lighting));
  EXPECT_TRUE(same_lighting(shadow.world, scene_->scene.lighting));
  EXPECT_EQ(caster.key.instance, 0u);
  EXPECT_EQ(caster.key.lighting, 0u);
  wire::SetLightingT dark;
  dark.id = 1;
  dark.lighting = to_wire(Lighting{});
  ASSERT_TRUE(send(id, std::move(dark)).ok());
  wire::RequestBatchT batch;
  batch.lighting_id = 1;
  batch.asks = {of_kind(3, kShadowTile)};
  ASSERT_TRUE(send(id, std::move(batch)).ok());
  EXPECT_EQ(refusal(id), wire::RefusalReason::BadKey) << "no sun, no shadow";
}

TEST_F(ServerAsks, LateAsksAreRefused) {
  const SessionId id = greeted();
  ASSERT_TRUE(send_ask(id, wire::Ask(1, 0, 0, 1.0f, 50, 8, 0, 0, 9, 2, 2, 3, 0)).ok());
  clock.advance_to_us(60'000);
  EXPECT_EQ(render_all(), 0u);
  hub->refuse_late();
  EXPECT_EQ(refusal(id), wire::RefusalReason::Late);
}

}  // namespace
}  // namespace mirage::test
