// Scene opener: a scene told group by group. What a viewer needs is known, and not much more.
#include <gtest/gtest.h>
#include <time.h>

#include <functional>
#include <random>

#include "client/plan/scene_opener.h"
#include "client/plan/selector_rules.h"
#include "protocol/base/limits.h"
#include "protocol/impostor/tile_key.h"
#include "protocol/wire/conversions.h"
#include "server/prepare/grouping.h"
#include "server/prepare/prepared_scene.h"
#include "server/session/session.h"
#include "tests/support/told_scene.h"

namespace mirage::test {
namespace {

constexpr std::uint32_t kNobody = InstanceView::kNoParent;

std::shared_ptr<const PreparedScene> field() {
  static const std::shared_ptr<const PreparedScene> scene =
      load_scene("builtin:field?instances=40000").take();
  return scene;
}

Message decoded(const PacketPtr& page) { return decode_message(page->data(), page->size()).take(); }

// Returns the request of one view, if there is one.
std::optional<wire::OpenRequestT> plan(SceneOpener& opener, const SelectorInput& in) {
  std::vector<wire::OpenRequestT> requests = opener.plan({in});
  if (requests.empty()) return std::nullopt;
  return std::move(requests.front());
}

// Asks until nothing more is wanted. Returns the number of requests.
int ask_on(SceneOpener& opener, SelectorWorld& world) {
  int requests = 0;
  for (;; ++requests) {
    world.now_us += 200'000;
    const std::optional<wire::OpenRequestT> request = plan(opener, world.input());
    if (!request || requests > 20) return requests;
    EXPECT_TRUE(take(world.scene, pages_of({*field(), *request})).ok());
    world.selector.grow(world.scene);
    world.cache.grow(world.scene);
    world.mesh_ready.resize(world.scene.objects.size(), false);
  }
}

void expect_known_as_needed(const SelectorWorld& world) {
  const SelectorInput in = world.input();
  for (std::uint32_t i = 0; i < world.scene.instances.size(); ++i) {
    const InstanceView& view = world.scene.instances[i];
    const ObjectDescription& object = world.scene.objects[view.object];
    if (!object.group || world.scene.opened(i)) continue;
    const ViewGeometry seen = view_geometry(in.camera, view, object);
    ASSERT_TRUE(group_wanted(in, view, seen, allowed_px(in, in.camera, view), 1))
        << "group of " << view.leaves << " at " << glm::length(seen.eye) / view.radius << " radii";
  }
}

TEST(CoreOpener, TheHomeViewIsToldUnasked) {
  SelectorWorld world(as_told(*field(), true));
  ASSERT_TRUE(world.scene.complete());
  ASSERT_TRUE(world.scene.described());
  EXPECT_EQ(world.scene.all_instances, field()->scene.instances.size());
  EXPECT_LT(world.scene.instances.size(), 8000u) << "and not the whole field";
  const HomeView& home = field()->scene.home;
  world.look(home.eye, home.target);
  SceneOpener opener;
  EXPECT_EQ(ask_on(opener, world), 0);
  expect_known_as_needed(world);
}

TEST(CoreOpener, WhereverTheEyeGoesOneRequestTellsWhatIsNeeded) {
  SelectorWorld world(as_told(*field()));
  SceneOpener opener;
  for (const glm::dvec3 eye : {glm::dvec3(0, 1.7, -120), glm::dvec3(100, 1.7, -230)}) {
    world.look(eye, eye + glm::dvec3(1, 0, -1));
    EXPECT_EQ(ask_on(opener, world), 1);
    expect_known_as_needed(world);
    EXPECT_EQ(ask_on(opener, world), 0) << "nothing is asked for twice";
  }
  EXPECT_LT(world.scene.instances.size(), 9'000u) << "and not much more";
}

// Returns groups with a radius of 5 m that are not opened yet, each with one leaf.
SelectorWorld closed_groups(const std::vector<wire::GroupRecord>& groups) {
  const std::size_t count = groups.size();
  wire::InstancePageT page;
  page.last = true;
  page.groups = groups;
  SceneView scene;
  EXPECT_TRUE(scene.accept(make_welcome(count, count, count, {})).ok());
  EXPECT_TRUE(scene.accept(make_objects({})).ok());
  EXPECT_TRUE(scene.accept(page).ok());
  return SelectorWorld(std::move(scene));
}

wire::GroupRecord closed_group(const glm::dvec3& center, std::uint32_t index, std::uint32_t count,
                               Importance importance = Importance::kNormal) {
  return {to_wire(center),
          wire::Vec3f(2.9f, 2.9f, 2.9f),
          0u,
          0u,
          count + index,
          kNobody,
          index,
          1u,
          static_cast<std::uint8_t>(importance)};
}

// Returns the distance from which a group is asked for, m; `change` alters the selector's input.
double asked_from(const std::function<void(SelectorInput&)>& change,
                  Importance importance = Importance::kNormal) {
  const SelectorWorld world = closed_groups({closed_group({}, 0, 1, importance)});
  double near = 6, far = 1e5;
  for (int i = 0; i < 40; ++i) {
    SelectorInput in = world.input();
    const double middle = 0.5 * (near + far);
    in.camera.pose = look_at({0, 0, 2e5}, {0, 0, 0});  // only the predicted eye counts
    in.predicted.pose = look_at({0, 0, middle}, {0, 0, 0});
    change(in);
    (!SceneOpener().plan({in}).empty() ? near : far) = middle;
  }
  return near;
}

TEST(CoreOpener, TauSpeedAndImportanceDecideFromHowFarAGroupIsAskedFor) {
  const double usual = asked_from([](SelectorInput&) {});
  EXPECT_GT(usual, 10);
  EXPECT_LT(usual, 1e4);
  EXPECT_GT(asked_from([](SelectorInput& in) { in.tau_px /= 4; }), 1.1 * usual);
  EXPECT_GT(asked_from([](SelectorInput& in) { in.target_px = in.tau_px / 4; }), 1.1 * usual)
      << "a steered tau comes back down";
  EXPECT_GT(asked_from([](SelectorInput& in) { in.velocity = {20, 0, 0}; }), 1.1 * usual);
  EXPECT_EQ(asked_from([](SelectorInput& in) {
              in.velocity = {0, 0, 0};
            }),
            usual)
      << "who stands may walk";
  EXPECT_GT(asked_from([](SelectorInput&) {}, Importance::kImportant), 1.1 * usual);
  EXPECT_LT(asked_from([](SelectorInput&) {}, Importance::kScenery), 0.95 * usual);
}

TEST(CoreOpener, NearOnesComeFirstAndARequestHasALimit) {
  const auto count = static_cast<std::uint32_t>(limits::kMaxOpensPerRequest + 100);
  std::vector<wire::GroupRecord> groups;
  for (std::uint32_t i = 0; i < count; ++i) {
    groups.push_back(closed_group({10 + 1e-4 * double(i * 7919ull % count), 0, 0}, i, count));
  }
  SelectorWorld world = closed_groups(groups);
  SceneOpener opener;
  const auto first = plan(opener, world.input());
  ASSERT_TRUE(first);
  ASSERT_EQ(first->groups.size(), limits::kMaxOpensPerRequest);
  double before = 0;
  for (const std::uint32_t id : first->groups) {
    const double x = groups[id - count].center().x();
    ASSERT_GE(x, before);
    before = x;
  }
  world.now_us += 50'000;
  EXPECT_FALSE(plan(opener, world.input())) << "ten times a second at most";
  world.now_us += 50'000;
  const auto second = plan(opener, world.input());
  ASSERT_TRUE(second);
  EXPECT_EQ(second->groups.size(), 100u);
}

TEST(CoreOpener, ALostConnectionAsksAgain) {
  SelectorWorld world(as_told(*field()));
  SceneOpener opener;
  world.look({0, 1.7, -120}, {1, 1.7, -121});
  world.now_us = 200'000;
  const auto first = plan(opener, world.input());
  ASSERT_TRUE(first);
  world.now_us += 200'000;
  EXPECT_FALSE(plan(opener, world.input()));
  opener.reset();
  const auto again = plan(opener, world.input());
  ASSERT_TRUE(again);
  EXPECT_EQ(again->groups, first->groups);
}

TEST(CoreOpener, IndicesStayAndRequestsNameTheServersNumbers) {
  SelectorWorld world(as_told(*field()));
  const std::vector<InstanceView> before = world.scene.instances;
  SceneOpener opener;
  world.look({0, 1.7, -120}, {1, 1.7, -121});
  ask_on(opener, world);
  ASSERT_GT(world.scene.instances.size(), before.size());
  for (std::uint32_t i = 0; i < world.scene.instances.size(); ++i) {
    const InstanceView& view = world.scene.instances[i];
    if (i < before.size()) {
      ASSERT_EQ(view.id, before[i].id);
    }
    ASSERT_EQ(world.scene.index_of(view.id), i);
    const Instance at_server = field()->instance(view.id);
    ASSERT_EQ(world.scene.object_id(i), at_server.object);
    ASSERT_EQ(view.world_from_object.position, at_server.world_from_object.position);
    const std::uint32_t parent = field()->parent(view.id);
    ASSERT_EQ(view.parent == kNobody, parent == kNoGroup);
    if (parent != kNoGroup) {
      ASSERT_EQ(world.scene.instances[view.parent].id, parent);
    }
  }
}

TEST(CoreOpener, WhatIsToldTwiceChangesNothing) {
  SceneView scene = as_told(*field());
  const std::size_t instances = scene.instances.size(), objects = scene.objects.size();
  std::vector<PacketPtr> pages = make_scene_pages(*field());
  const auto of_instances = [](const PacketPtr& page) {
    return decoded(page).body.AsInstancePage() != nullptr;
  };
  pages.erase(std::remove_if(pages.begin(), pages.end(),
                             [&](const PacketPtr& page) { return !of_instances(page); }),
              pages.end());
  ASSERT_TRUE(take(scene, pages).ok());
  EXPECT_EQ(scene.instances.size(), instances);
  EXPECT_EQ(scene.objects.size(), objects);
  for (const std::uint32_t root : scene.roots()) EXPECT_LT(root, instances);
}

// Members are told at no shorter distance than that at which they are drawn.
TEST(CoreOpener, TheRuleReachesAsFarAsTheSelector) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto log_range = [&](double low, double high) {
    return low * std::pow(high / low, unit(random));
  };
  for (int round = 0; round < 3000; ++round) {
    const double radius = log_range(0.05, 500);
    SelectorWorld world(make_scene(std::vector<Placed>(1, Placed{{0, 0, 0}, 1, 0, 1}), {},
                                   {{{0, 0, 0}, static_cast<float>(radius), kNobody, 0, 1}}));
    SelectorInput in = world.input();
    in.tau_px = log_range(0.2, 8);
    in.target_px = in.tau_px;
    in.velocity = {log_range(0.1, 40), 0, 0};
    in.camera.height = static_cast<int>(log_range(100, 2000));
    in.camera.width = in.camera.height;
    const InstanceView& group = world.scene.instances[1];
    const OpenRule rule{in.camera.focal_px(), in.tau_px,
                        std::max(glm::length(in.velocity), kWalkingMps), 1};
    const double reach = open_distance(rule, group.radius);
    for (const double beyond : {1.0, 1.2, 2.0, 5.0}) {
      in.camera.pose = look_at({0, 0, 1.0001 * beyond * reach}, {0, 0, 0});
      const ObjectDescription& object = world.scene.objects[group.object];
      EXPECT_TRUE(group_wanted(in, group, view_geometry(in.camera, group, object), in.tau_px, 1))
          << radius << " m, tau " << in.tau_px << ", at " << beyond << " times " << reach;
    }
  }
}

TEST(CoreOpener, PagesThatContradictTheSceneAreRefusedWhole) {
  const SceneView good = make_scene({{{0, 0, 0}, 1, 0, 1}}, {}, {{{0, 0, 0}, 5, kNobody, 0, 1}});
  ASSERT_EQ(good.instances.size(), 2u);
  const auto refusal = [&](const std::function<void(wire::InstancePageT&)>& change) {
    SceneView scene = good;
    wire::InstancePageT page;
    change(page);
    const Result<void> taken = scene.accept(page);
    EXPECT_EQ(scene.instances.size(), 2u);
    return taken ? ErrorId::kInternal : taken.error().id;
  };
  const Placed inside{{0, 0, 0}, 1, 0, 1};
  EXPECT_EQ(refusal([&](auto& p) { p.instances = {instance_record(inside, 0)}; }),
            ErrorId::kWireValue)
      << "a member of a group that is not opened in this page";
  EXPECT_EQ(refusal([&](auto& p) {
              p.instances = {instance_record({{}, 1, 0, kNobody}, 9)};
            }),
            ErrorId::kWireValue)
      << "more instances than the scene has";
  EXPECT_EQ(refusal([&](auto& p) {
              p.groups = {group_record({{}, 1, kNobody, 0, 1}, 2, 0)};
            }),
            ErrorId::kWireValue)
      << "more groups than the scene has";
  EXPECT_EQ(refusal([&](auto& p) { p.opened = {77}; }), ErrorId::kWireState)
      << "of a group that is not known yet";
  EXPECT_EQ(refusal([&](auto& p) {
              p.groups = {group_record({{}, 1, kNobody, 1, 1}, 1, 0)};
            }),
            ErrorId::kWireValue)
      << "leaves beyond the scene's instances";
}

// Returns all opened groups of `groups`, in order.
std::vector<std::uint32_t> opened(const PreparedScene& scene,
                                  const std::vector<std::uint32_t>& groups,
                                  const Opening& opening) {
  std::vector<std::uint32_t> out;
  GroupOpening groups_left(scene, groups, opening);
  while (const std::optional<std::uint32_t> id = groups_left.next()) out.push_back(*id);
  return out;
}

TEST(ServerOpening, ALimitIsKeptAndGroupsComeBeforeTheirOwn) {
  Opening opening;
  opening.eye = field()->scene.home.eye;
  opening.rule.margin = 16;
  opening.most = 500;
  const auto ids = opened(*field(), field()->grouping.roots, opening);
  std::size_t told = 0;
  std::set<std::uint32_t> seen;
  for (const std::uint32_t id : ids) {
    told += field()->group_of_instance(id)->members;
    const std::uint32_t parent = field()->parent(id);
    EXPECT_TRUE(parent == kNoGroup || seen.count(parent) != 0);
    seen.insert(id);
  }
  EXPECT_GE(told, 500u);
  EXPECT_LT(told, 520u);
}

// Returns the number of instances and groups that are told.
std::size_t told_of(const PreparedScene& scene, const Opening& opening) {
  std::size_t told = 0;
  for (const std::uint32_t id : opened(scene, scene.grouping.roots, opening)) {
    told += scene.group_of_instance(id)->members;
  }
  return told;
}

TEST(ServerOpening, AtLeastAsManyAsWantedAreToldOf) {
  Opening far_away;
  far_away.eye = {0, 1e6, 0};
  EXPECT_EQ(told_of(*field(), far_away), 0u);
  far_away.least = 300;
  EXPECT_GE(told_of(*field(), far_away), 300u);
  EXPECT_LT(told_of(*field(), far_away), 320u);
}

TEST(ServerOpening, TheDescriptionComesInSmallPagesOfWhichTheFirstWillDo) {
  SceneView scene;
  ASSERT_TRUE(scene.accept(welcome_of(*field())).ok());
  int pages = 0;
  for (const PacketPtr& packet : make_scene_pages(*field())) {
    const Message page = decoded(packet);
    if (const wire::ImagePageT* images = page.body.AsImagePage()) {
      ASSERT_TRUE(scene.accept(*images).ok());
    }
    if (const wire::ObjectPageT* objects = page.body.AsObjectPage()) {
      ASSERT_TRUE(scene.accept(*objects).ok());
    }
    const wire::InstancePageT* tree = page.body.AsInstancePage();
    if (!tree) continue;
    ASSERT_TRUE(scene.accept(*tree).ok());
    EXPECT_LE(packet->size(), 32u << 10);
    if (scene.complete()) ++pages;
  }
  EXPECT_TRUE(scene.described());
  EXPECT_GE(pages, 4) << "there is a scene to draw long before the last";
}

TEST(ServerOpening, WhatIsImportantIsToldOfFromFartherAway) {
  Opening opening;
  opening.eye = field()->scene.home.eye;
  const auto told_with = [&](Importance importance) {
    PreparedScene scene = *field();
    for (InstanceGroup& group : scene.grouping.groups) group.importance = importance;
    return told_of(scene, opening);
  };
  EXPECT_GT(told_with(Importance::kImportant), told_with(Importance::kNormal));
  EXPECT_GT(told_with(Importance::kNormal), told_with(Importance::kScenery));
}

TEST(ServerOpening, WhatLiesBeforeTheEyeComesFirst) {
  Opening opening;
  opening.eye = field()->bounds_center;
  opening.most = 2000;
  int before = 0, behind = 0;
  for (const std::uint32_t id : opened(*field(), field()->grouping.roots, opening)) {
    const GroupBounds& bounds = field()->group_of_instance(id)->bounds;
    const double ahead = glm::dot(bounds.center - opening.eye, opening.forward);
    const double radius = glm::length(glm::dvec3(bounds.half));
    before += ahead > radius;
    behind += ahead < -radius;
  }
  EXPECT_GT(3 * before, 4 * behind) << before << " before, " << behind << " behind";
}

TEST(ServerOpening, NumbersThatAreNoGroupsArePassedOver) {
  wire::OpenRequestT request;
  request.groups = {0, 0xfffffffeu};
  request.eye = std::make_unique<wire::Vec3d>();
  request.forward = std::make_unique<wire::Vec3d>(0, 0, -1);
  request.focal_px = 500, request.tau_px = 1, request.margin = 1;
  const auto pages = pages_of({*field(), request});
  ASSERT_EQ(pages.size(), 1u);
  const Message m = decoded(pages[0]);
  EXPECT_TRUE(m.body.AsInstancePage()->last);
  EXPECT_TRUE(m.body.AsInstancePage()->instances.empty());
}

double thread_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// The largest request, 60 KB: no other client waits while it is answered.
TEST(ServerOpening, AnAnswerIsMadePageByPageAndTellsOfEachOnce) {
  const VirtualClock clock;
  StageQueues queues(clock, 1 << 20, {});
  SessionHub hub(field(), {}, queues);
  const SessionId id = hub.open();
  const auto say = [&](Bytes bytes) {
    ASSERT_TRUE(hub.receive(id, bytes.data(), bytes.size()).ok());
  };
  wire::HelloT hello;
  hello.version_min = hello.version_max = limits::kProtocolVersion;
  hello.codecs = {static_cast<std::uint8_t>(TileCodec::kZstd)};
  say(encode_message(std::move(hello)));
  while (hub.next_packet(id)) {
  }
  wire::OpenRequestT request;
  for (std::size_t i = 0; i < limits::kMaxOpensPerRequest; ++i) {
    request.groups.push_back(field()->grouping.roots[i % field()->grouping.roots.size()]);
  }
  request.eye = std::make_unique<wire::Vec3d>();
  request.forward = std::make_unique<wire::Vec3d>(0, 0, -1);
  request.focal_px = 500, request.tau_px = 1, request.margin = 1, request.speed_mps = 1e9;
  const double before = thread_seconds();
  say(encode_message(std::move(request)));
  const double received = thread_seconds();
  std::size_t records = 0, pages = 0;
  double longest = 0;
  for (double last = received;; last = thread_seconds()) {
    const PacketPtr packet = hub.next_packet(id);
    longest = std::max(longest, thread_seconds() - last);
    if (!packet) break;
    const Message m = decoded(packet);
    records += m.body.AsInstancePage()->instances.size() + m.body.AsInstancePage()->groups.size();
    ++pages;
  }
  EXPECT_GT(pages, 50u);
  EXPECT_LE(records, field()->instance_count());
  const double all = thread_seconds() - before;
  EXPECT_LT(received - before, all / 5) << "the request itself, of " << all << " s in all";
  EXPECT_LT(longest, all / 5);
}

}  // namespace
}  // namespace mirage::test
