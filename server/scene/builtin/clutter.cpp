// A furnished room: shelves along the walls, desks in the middle, things standing on them.

#include <algorithm>
#include <array>
#include <cmath>

#include "server/scene/builtin/room_props.h"
#include "server/scene/builtin/texture_paint.h"

namespace mirage::builtin {
namespace {

constexpr float kClutterLoopRadius = 1.2f;
constexpr float kFreeRadius = 1.75f;  // metres about the loop's centre that no object reaches into
constexpr float kRoomHeight = 3;

struct Spot {
  glm::vec3 position;
  float yaw;
  float room;  ///< largest radius that fits here, metres
};

struct Room {
  glm::vec2 half;
  std::vector<glm::vec4> footprints;  ///< x, z, half x, half z: darkens the floor below
  std::vector<Spot> spots;            ///< for small things
};

/// Objects by size; filled in build order, so that indices are stable.
struct Props {
  std::vector<std::uint32_t> small;  ///< up to 0.12 m radius
  std::vector<std::uint32_t> wide;   ///< up to 0.25 m radius
  std::uint32_t monitor = 0;
  std::uint32_t keyboard = 0;
  std::uint32_t desk = 0;
  std::uint32_t shelf = 0;
  std::uint32_t sofa = 0;
  std::uint32_t floor_lamp = 0;
  std::uint32_t picture = 0;
  std::uint32_t pendant = 0;
  std::array<std::uint32_t, 2> chairs{};
  std::array<std::uint32_t, 4> book_rows{};
};

Props add_props(SceneParts& parts, const RoomMaterials& m, std::uint32_t seed) {
  Props p;
  p.desk = parts.add("desk", make_desk(m));
  p.chairs = {parts.add("blue chair", make_chair(m, {0.05f, 0.12f, 0.3f})),
              parts.add("grey chair", make_chair(m, {0.16f, 0.16f, 0.17f}))};
  p.shelf = parts.add("shelf", make_shelf(m));
  p.sofa = parts.add("sofa", make_sofa(m));
  p.floor_lamp = parts.add("floor lamp", make_floor_lamp(m));
  p.pendant = parts.add("pendant lamp", make_pendant(m));
  p.picture = parts.add("picture", make_picture_frame(m));
  p.monitor = parts.add("monitor", make_monitor(m));
  p.keyboard = parts.add("keyboard", make_keyboard(m));
  for (std::uint32_t i = 0; i < 4; ++i) {
    p.book_rows[i] = parts.add("book row", make_book_row(m, seed + i));
  }
  p.small = {parts.add("white mug", make_mug(m, {0.75f, 0.73f, 0.68f})),
             parts.add("red mug", make_mug(m, {0.55f, 0.06f, 0.04f})),
             parts.add("blue vase", make_vase(m, {0.07f, 0.2f, 0.42f})),
             parts.add("white vase", make_vase(m, {0.7f, 0.66f, 0.58f})),
             parts.add("green bottle", make_bottle(m, {0.03f, 0.16f, 0.06f})),
             parts.add("brown bottle", make_bottle(m, {0.16f, 0.06f, 0.015f})),
             parts.add("ball", make_ball(m, {0.7f, 0.08f, 0.05f}, {0.8f, 0.75f, 0.6f}))};
  p.wide = {parts.add("book", make_book(m, seed)),       parts.add("book", make_book(m, seed + 7)),
            parts.add("plant", make_pot_plant(m, seed)), parts.add("globe", make_globe(m, seed)),
            parts.add("bowl", make_bowl(m, seed)),       parts.add("carton", make_carton(m)),
            parts.add("desk lamp", make_desk_lamp(m))};
  return p;
}

/// Converts a point from a piece of furniture's space into the room's.
glm::vec3 in_room(const Spot& at, glm::vec3 p) {
  const float c = std::cos(at.yaw);
  const float s = std::sin(at.yaw);
  return at.position + glm::vec3(p.x * c + p.z * s, p.y, -p.x * s + p.z * c);
}

void footprint(Room& room, const Spot& at, float half_x, float half_z) {
  const bool turned = std::abs(std::sin(at.yaw)) > 0.7f;
  room.footprints.emplace_back(at.position.x, at.position.z, turned ? half_z : half_x,
                               turned ? half_x : half_z);
}

class Furnisher {
 public:
  Furnisher(SceneParts& parts, const Props& props, Room& room, std::size_t limit, Random& random)
      : parts_(parts), props_(props), room_(room), limit_(limit), random_(random) {}

  bool full() const { return placed_ >= limit_; }

  bool put(std::uint32_t object, glm::vec3 p, float yaw, float scale = 1) {
    if (full()) return false;
    parts_.put(object, p, yaw, scale);
    ++placed_;
    return true;
  }

  void desk(const Spot& at) {
    if (!put(props_.desk, at.position, at.yaw)) return;
    footprint(room_, at, 0.75f, 0.4f);
    const float turn = random_.range(-0.5f, 0.5f);
    const Spot chair{in_room(at, {-0.2f, 0, 0.62f}), at.yaw + 3.14159f + turn, 0};
    put(props_.chairs[random_.index(2)], chair.position, chair.yaw);
    footprint(room_, chair, 0.25f, 0.25f);
    const float tilt = random_.range(-0.2f, 0.2f);
    put(props_.monitor, in_room(at, {-0.1f, kDeskHeight, -0.2f}), at.yaw + tilt);
    put(props_.keyboard, in_room(at, {-0.12f, kDeskHeight, 0.12f}), at.yaw + 0.4f * tilt);
    for (const glm::vec2 p : {glm::vec2(0.5f, -0.15f), glm::vec2(-0.58f, -0.12f)}) {
      room_.spots.push_back({in_room(at, {p.x, kDeskHeight, p.y}), at.yaw, 0.2f});
    }
    for (const glm::vec2 p :
         {glm::vec2(0.3f, 0.22f), glm::vec2(0.56f, 0.2f), glm::vec2(-0.5f, 0.22f)}) {
      room_.spots.push_back({in_room(at, {p.x, kDeskHeight, p.y}), at.yaw, 0.1f});
    }
  }

  void shelf(const Spot& at) {
    if (!put(props_.shelf, at.position, at.yaw)) return;
    footprint(room_, at, 0.6f, 0.18f);
    for (int board = 0; board <= kShelfBoards; ++board) {
      for (const float x : {-0.4f, -0.06f, 0.26f, 0.46f}) {
        const bool books = board < kShelfBoards && x < 0.4f && random_.chance(0.5f);
        const glm::vec3 p = in_room(at, {x, shelf_board_height(board), 0});
        room_.spots.push_back({p, at.yaw, books ? 0.0f : x > 0.4f ? 0.08f : 0.13f});
      }
    }
  }

  /// Places a thing that fits the spot; radius 0 means a row of books.
  void fill(const Spot& spot) {
    const float turn = random_.range(-0.4f, 0.4f);
    if (spot.room == 0) {
      put(props_.book_rows[random_.index(4)], spot.position, spot.yaw);
      return;
    }
    const bool wide = spot.room > 0.12f && random_.chance(spot.room > 0.15f ? 0.8f : 0.35f);
    const auto& list = wide ? props_.wide : props_.small;
    const auto pick = random_.index(static_cast<std::uint32_t>(list.size()));
    const float scale = wide ? std::min(1.0f, spot.room / 0.17f) : std::min(1.0f, spot.room / 0.1f);
    put(list[pick], spot.position, spot.yaw + turn, scale * random_.range(0.88f, 1.0f));
  }

 private:
  SceneParts& parts_;
  const Props& props_;
  Room& room_;
  std::size_t limit_;
  Random& random_;
  std::size_t placed_ = 0;
};

constexpr float kQuarter = 1.5707963f;

void furnish(Furnisher& f, const Props& props, Room& room, Random& random) {
  // Shelves start along the far wall, which the home view looks at.
  const auto along = static_cast<int>((room.half.x - 0.8f) / 1.25f);
  for (int i = -along; i <= along; ++i) {
    const float x = 1.25f * static_cast<float>(i);
    if (std::abs(i) % 4 == 2) {
      f.put(props.picture, {x, 1.35f, -room.half.y + 0.001f}, 0);
      f.put(i > 0 ? props.sofa : props.floor_lamp, {x, 0, -room.half.y + 0.5f}, 0);
      footprint(room, {{x, 0, -room.half.y + 0.5f}, 0, 0}, i > 0 ? 0.95f : 0.15f, 0.4f);
    } else {
      f.shelf({{x, 0, -room.half.y + 0.19f}, 0, 0});
    }
  }
  // Desks in a grid about the free middle, two rows back to back.
  const auto columns = static_cast<int>((room.half.x - 1.2f) / 2.3f);
  const auto rows = static_cast<int>((room.half.y - 1.2f) / 2.5f);
  for (int j = -rows; j <= rows; ++j) {
    for (int i = -columns; i <= columns; ++i) {
      const glm::vec3 p(2.3f * static_cast<float>(i), 0, 2.5f * static_cast<float>(j) - 0.1f);
      if (glm::length(p) < kFreeRadius + 0.75f) continue;
      f.desk({p, (i + j) % 2 == 0 ? 0.0f : 2 * kQuarter, 0});
    }
  }
  const auto down = static_cast<int>((room.half.y - 1.4f) / 1.25f);
  for (int i = -down; i <= down; ++i) {
    f.shelf({{-room.half.x + 0.19f, 0, 1.25f * static_cast<float>(i)}, kQuarter, 0});
  }
  for (int i = -along; i <= along; i += 2) {
    f.shelf({{1.25f * static_cast<float>(i), 0, room.half.y - 0.19f}, 2 * kQuarter, 0});
  }
  // Fisher-Yates: a small budget still spreads over the whole room.
  for (std::size_t i = room.spots.size(); i > 1; --i) {
    std::swap(room.spots[i - 1], room.spots[random.index(static_cast<std::uint32_t>(i))]);
  }
  for (const Spot& spot : room.spots) f.fill(spot);
  // Remaining objects lie on the floor.
  while (!f.full()) {
    const float x = random.range(0.5f - room.half.x, room.half.x - 0.5f);
    const float z = random.range(0.5f - room.half.y, room.half.y - 0.5f);
    if (glm::length(glm::vec2(x, z)) < kFreeRadius + 0.3f) continue;
    f.fill({{x, 0, z}, random.angle(), 0.2f});
  }
}

float floor_light(const Room& room, glm::vec2 p) {
  float light = 1;
  for (const glm::vec4& r : room.footprints) {
    const glm::vec2 d = glm::max(glm::abs(p - glm::vec2(r.x, r.y)) - glm::vec2(r.z, r.w), 0.0f);
    const float gap = glm::length(d);
    if (gap < 0.5f) light = std::min(light, 0.42f + 0.58f * glm::smoothstep(-0.1f, 0.45f, gap));
  }
  const glm::vec2 wall = room.half - glm::abs(p);
  return light * (0.6f + 0.4f * glm::smoothstep(0.0f, 0.7f, std::min(wall.x, wall.y)));
}

void add_windows(MeshBuilder& b, const Room& room, std::uint32_t frame, std::uint32_t sky) {
  const auto count = std::max(2, static_cast<int>(room.half.y / 1.5f));
  for (int i = 0; i < count; ++i) {
    const float step = 2 * room.half.y / static_cast<float>(count);
    const float z = -room.half.y + step * (static_cast<float>(i) + 0.5f);
    const float x = room.half.x;
    b.use(sky);
    b.face({x - 0.02f, 1.0f, z - 0.8f}, {x - 0.02f, 1.0f, z + 0.8f}, {x - 0.02f, 2.4f, z + 0.8f},
           {x - 0.02f, 2.4f, z - 0.8f});
    b.use(frame).paint(glm::vec3(0.7f));
    for (const float dz : {-0.85f, -0.03f, 0.79f}) {
      b.box({x - 0.08f, 0.95f, z + dz}, {x - 0.001f, 2.45f, z + dz + 0.06f});
    }
    for (const float y : {0.94f, 1.9f, 2.4f}) {
      b.box({x - (y < 1 ? 0.2f : 0.07f), y, z - 0.86f}, {x - 0.001f, y + 0.06f, z + 0.86f});
    }
  }
}

void add_shell(SceneParts& parts, const Room& room, std::uint32_t matte, std::uint32_t seed) {
  MeshBuilder b;
  const float x = room.half.x;
  const float z = room.half.y;
  const float h = kRoomHeight;
  const auto cells = [](float length) { return glm::clamp(static_cast<int>(length * 4), 8, 256); };
  const std::int32_t boards = parts.add(paint_planks(seed, 8));
  b.use(parts.add(textured_material(boards, 0.45f))).paint(glm::vec3(1));
  b.grid_face({-x, 0, z}, {x, 0, z}, {-x, 0, -z}, cells(2 * x), cells(2 * z), {x, z});
  b.shade([&](glm::vec3 p, glm::vec3) { return floor_light(room, {p.x, p.z}); });
  const std::uint32_t first = b.vertex_count();
  b.use(matte).paint({0.66f, 0.61f, 0.52f});
  b.grid_face({-x, 0, -z}, {x, 0, -z}, {-x, h, -z}, cells(2 * x), 12);
  b.grid_face({x, 0, z}, {-x, 0, z}, {x, h, z}, cells(2 * x), 12);
  b.grid_face({-x, 0, z}, {-x, 0, -z}, {-x, h, z}, cells(2 * z), 12);
  b.paint({0.42f, 0.5f, 0.5f});
  b.grid_face({x, 0, -z}, {x, 0, z}, {x, h, -z}, cells(2 * z), 12);
  b.paint(glm::vec3(0.42f));  // bright enough with the lamps close below
  b.grid_face({-x, h, -z}, {x, h, -z}, {-x, h, z}, cells(2 * x), cells(2 * z));
  b.shade(
      [&](glm::vec3 p, glm::vec3 n) {
        const glm::vec3 gap(x - std::abs(p.x), std::min(p.y, h - p.y), z - std::abs(p.z));
        float nearest = 1;
        for (int k = 0; k < 3; ++k) {
          if (std::abs(n[k]) < 0.5f) nearest = std::min(nearest, gap[k]);
        }
        return 0.62f + 0.38f * glm::smoothstep(0.0f, 0.7f, nearest);
      },
      first);
  b.paint({0.75f, 0.73f, 0.7f});
  b.box({-x, 0, -z}, {x, 0.09f, -z + 0.015f});
  b.box({-x, 0, z - 0.015f}, {x, 0.09f, z});
  b.box({-x, 0, -z}, {-x + 0.015f, 0.09f, z});
  b.box({x - 0.015f, 0, -z}, {x, 0.09f, z});
  add_windows(b, room, matte, parts.add(glowing_material({1.0f, 1.15f, 1.35f})));
  parts.put(parts.add("room", b.take()), {0, 0, 0});
}

}  // namespace

Scene build_clutter(const OptionValues& options) {
  const auto objects = static_cast<std::size_t>(options[0]);
  const auto seed = static_cast<std::uint32_t>(mix_bits(static_cast<std::uint64_t>(options[1])));
  SceneParts parts;
  const RoomMaterials m = add_room_materials(parts, seed);
  const Props props = add_props(parts, m, seed);
  Room room;
  const float grow = std::max(1.0f, std::sqrt(static_cast<float>(objects) / 300.0f));
  room.half = glm::vec2(6, 4.5f) * grow;
  Random random(seed, 65);
  Furnisher furnisher(parts, props, room, objects, random);
  furnish(furnisher, props, room, random);
  add_shell(parts, room, m.matte, seed);
  parts.scene.lighting.ambient = glm::vec3(0.35f);
  for (const glm::vec3 p :
       {glm::vec3(-3, 0, -2), glm::vec3(2.6f, 0, -2.2f), glm::vec3(0.3f, 0, 2.6f)}) {
    parts.put(props.pendant, p + glm::vec3(0, kRoomHeight, 0), 0, 1.5f);
    Light light;
    light.kind = LightKind::kPoint;
    light.color = {2.7f, 2.3f, 1.75f};
    light.position = p + glm::vec3(0, kRoomHeight - 1.1f, 0);
    parts.scene.lighting.lights.push_back(light);
  }
  parts.scene.environment = {glm::vec3(0.5f), glm::vec3(0.6f), glm::vec3(0.2f)};
  parts.scene.home = home_on_loop({0, 0, 0}, kClutterLoopRadius, 1.65, 0, 0.8);
  parts.scene.home.target.y -= 0.2;
  return std::move(parts.scene);
}

}  // namespace mirage::builtin
