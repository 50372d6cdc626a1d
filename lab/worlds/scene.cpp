// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "lab/worlds/scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>

#include "lab/worlds/families_parts.hpp"
#include "lab/worlds/models.hpp"
#include "lab/worlds/shapes.hpp"
#include "lab/worlds/tours.hpp"

namespace cairn::worlds {
namespace {

constexpr int kTries = 24;         // places tried for a thing
constexpr float kLevel = 0.015F;   // m, by which the ground below a thing may differ
constexpr float kSmall = 0.09F;    // half of a side, of the image's width; smaller things are rare
constexpr float kLargest = 0.45F;  // of the image, for a thing's bounding box
constexpr double kModels = 0.35;   // share of models among the things indoors
constexpr double kSupports = 0.6;  // how often something to stand on is placed where nothing can be stood on

// ---- what stands where ----

/// A rectangle on the ground, turned.
struct Footprint {
  Vec2 centre;
  Vec2 half;
  float yaw = 0;

  [[nodiscard]] std::array<Vec2, 4> corners(float grown = 0) const {
    const float c = std::cos(yaw), s = std::sin(yaw), x = half.x + grown, y = half.y + grown;
    const auto at = [&](float u, float v) {
      return Vec2{centre.x + c * u - s * v, centre.y + s * u + c * v};
    };
    return {at(-x, -y), at(x, -y), at(x, y), at(-x, y)};
  }
  /// A point of it: u and v from 0 to 1 along its sides.
  [[nodiscard]] Vec2 point(float u, float v) const {
    const auto c = corners();
    return {c[0].x + u * (c[1].x - c[0].x) + v * (c[3].x - c[0].x),
            c[0].y + u * (c[1].y - c[0].y) + v * (c[3].y - c[0].y)};
  }
};

/// Whether two rectangles are apart: along one of their four directions, they do not overlap.
bool are_apart(const Footprint& a, const Footprint& b, float gap) {
  const auto ca = a.corners(), cb = b.corners();
  for (const float yaw : {a.yaw, a.yaw + kPi / 2, b.yaw, b.yaw + kPi / 2}) {
    const Vec2 axis{std::cos(yaw), std::sin(yaw)};
    const auto range = [&](const std::array<Vec2, 4>& corners) {
      std::array<float, 2> span{std::numeric_limits<float>::max(), std::numeric_limits<float>::lowest()};
      for (const Vec2 c : corners) {
        const float t = c.x * axis.x + c.y * axis.y;
        span = {std::min(span[0], t), std::max(span[1], t)};
      }
      return span;
    };
    const auto [al, ah] = range(ca);
    const auto [bl, bh] = range(cb);
    if (al > bh + gap || bl > ah + gap) return true;
  }
  return false;
}

/// The height of a mesh above (x, y); nothing if it is not there.
std::optional<float> height_at(const Mesh& mesh, float x, float y) {
  std::optional<float> top;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.points[t[0]], b = mesh.points[t[1]], c = mesh.points[t[2]];
    const float area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if (std::abs(area) < 1e-9F) continue;
    const float v = ((x - a.x) * (c.y - a.y) - (y - a.y) * (c.x - a.x)) / area;
    const float w = ((b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x)) / area;
    if (v < 0 || w < 0 || v + w > 1) continue;
    const float z = a.z + v * (b.z - a.z) + w * (c.z - a.z);
    if (!top || z > *top) top = z;
  }
  return top;
}

/// A thing that is placed.
struct Standing {
  Footprint footprint;
  float bottom = 0;
  float top = 0;
  std::size_t body = 0;
  int id = 0;
};

class Builder {
 public:
  Builder(World& world, const WorldOptions& options, Dice dice)
      : world_(world), options_(options), dice_(dice), models_(models_for(options.use)) {}

  void build() {
    may_show_photographs_ = options_.use == Use::fit;
    const bool is_outdoor = dice_.chance(options_.outdoor_share);
    world_.place = is_outdoor
                       ? Place::outdoor
                       : dice_.pick({Place::room, Place::room, Place::room, Place::room, Place::room,
                                     Place::table, Place::table, Place::table, Place::table, Place::clutter,
                                     Place::clutter, Place::shelf, Place::clutter, Place::corridor});
    switch (world_.place) {
      case Place::outdoor:
        outdoors();
        break;
      case Place::table:
        table();
        break;
      default:
        room();
    }
    sensor();
  }

 private:
  // ---- bodies ----

  Body& add(Mesh mesh, const Look& look, int id = 0) {
    Body body;
    body.looks.fill(look);
    body.mesh = std::move(mesh);
    body.id = id;
    world_.scene.bodies.push_back(std::move(body));
    return world_.scene.bodies.back();
  }
  /// A rectangle with its corner at `at`.
  Body& quad(Vec3 at, Vec3 along, Vec3 up, const Look& look) {
    const float w = length(along), h = length(up);
    Mesh mesh{{at, at + along, at + along + up, at + up},
              {{0, 0}, {w, 0}, {w, h}, {0, h}},
              {{0, 1, 2}, {0, 2, 3}},
              {0, 0}};
    return add(std::move(mesh), look);
  }
  Body& block(Vec3 low, Vec3 high, const Look& look) {
    const Vec3 size = high - low;
    return add(moved(box(size), {low.x + size.x / 2, low.y + size.y / 2, low.z}), look);
  }

  // ---- rigs ----

  /// At `eye`, looking along `yaw` and `pitch` degrees down.
  void camera(Vec3 eye, float yaw, float pitch_deg, float focal_of_width, float baseline) {
    Rig& rig = world_.scene.rig;
    rig.size = options_.size;
    rig.focal_px = focal_of_width * static_cast<float>(options_.size.width);
    rig.cx_px = static_cast<float>(options_.size.width - 1) / 2;
    rig.cy_px = static_cast<float>(options_.size.height - 1) / 2;
    rig.baseline_m = baseline;
    rig.eye = eye;
    const float pitch = pitch_deg * kPi / 180,
                roll = draw(dice_, -1, 1) * (dice_.chance(0.4) ? 3.0F : 0.3F) * kPi / 180;
    rig.forward = {std::cos(yaw) * std::cos(pitch), std::sin(yaw) * std::cos(pitch), -std::sin(pitch)};
    const Vec3 right = unit(cross(rig.forward, kZ)), down = cross(rig.forward, right);
    rig.right = std::cos(roll) * right + std::sin(roll) * down;
    rig.down = std::cos(roll) * down - std::sin(roll) * right;
    rig.right_row_offset_px = dice_.chance(0.5) ? draw(dice_, -0.4, 0.4) : 0;
  }
  struct Pixel {
    float x = 0;
    float y = 0;
    float depth = 0;
  };
  [[nodiscard]] Pixel pixel_of(Vec3 point) const {
    const Rig& rig = world_.scene.rig;
    const Vec3 to = point - rig.eye;
    const float z = dot(to, rig.forward);
    return {rig.cx_px + rig.focal_px * dot(to, rig.right) / z,
            rig.cy_px + rig.focal_px * dot(to, rig.down) / z, z};
  }
  /// Where the ray of a pixel meets the plane z = height; nothing above the horizon or beyond `far`.
  [[nodiscard]] std::optional<Vec2> on_plane(float x, float y, float height, float far) const {
    const Rig& rig = world_.scene.rig;
    const Vec3 direction =
        rig.forward + (x - rig.cx_px) / rig.focal_px * rig.right + (y - rig.cy_px) / rig.focal_px * rig.down;
    if (direction.z > -1e-3F) return std::nullopt;
    const float t = (height - rig.eye.z) / direction.z;
    if (t <= 0 || t > far) return std::nullopt;
    return Vec2{rig.eye.x + t * direction.x, rig.eye.y + t * direction.y};
  }

  // ---- things ----

  struct Made {
    Mesh mesh;
    std::array<Look, 4> looks;
    std::string kind;
  };

  /// `size`: of its longest side; 0: as drawn.
  Made thing(float size, bool is_small) {
    Made made;
    if (world_.place != Place::outdoor && !models_.empty() && dice_.chance(kModels)) {
      for (int k = 0; k < kTries; ++k) {
        const Model& model = dice_.pick(models_);
        if (is_small != (model.longest_m() < 0.5F)) continue;
        ModelMesh loaded = mesh_of(model);
        if (loaded.mesh.triangles.empty()) continue;
        made = {std::move(loaded.mesh), loaded.looks, model.name};
        // Painted anew now and then: texture and shape are independent.
        if (dice_.chance(0.3)) {
          for (std::size_t i = 0; i < made.mesh.uv.size(); ++i) {
            const Vec3 p = made.mesh.points[i];
            made.mesh.uv[i] = {p.x + p.y, p.z};
          }
          paint(made);
        }
        break;
      }
    }
    if (made.kind.empty()) {
      const Family& family = a_family(is_small);
      Dice own = dice_.fork(0x5EED + static_cast<std::uint64_t>(world_.things.size()));
      made.mesh = family.make(own);
      made.kind = family.name;
      paint(made);
      const float drawn = longest(made.mesh);
      if (size <= 0 && world_.place != Place::outdoor) size = drawn * draw(dice_, 0.7, 1.25);
      if (world_.place != Place::outdoor && size <= 0) size = drawn;
      if (size > 0) resize(made.mesh, size);
    } else if (size > 0 && longest(made.mesh) > 1.4F * size) {
      resize(made.mesh, size);
    }
    return made;
  }

  /// The yardstick is older than marks and stays as it is.
  Look marked(Look look) {
    if (options_.use == Use::fit && dice_.chance(0.5)) scatter_marks(look, dice_);
    return look;
  }

  /// In worlds of the fit, six tenths of what overlapping leaves would cover shows a photograph. The yardstick, tours and
  /// the laboratory stay as they were before there were any.
  Look look_of_thing() {
    Look look = random_look(dice_);
    if (look.image == nullptr || !may_show_photographs_) return look;
    Dice own = dice_.fork(0xF070);
    if (const TextureImage image = own.chance(0.6) ? photograph(own) : nullptr) look.image = image;
    return look;
  }

  void paint(Made& made) {
    const Look one = look_of_thing();
    for (Look& look : made.looks) look = dice_.chance(0.5) ? one : look_of_thing();
    made.looks[0] = one;
    if (dice_.chance(0.08)) made.looks.fill(floor_like_);  // of the floor's own colour
  }

  const Family& a_family(bool is_small) {
    static const std::set<std::string_view> outside{
        "tree", "bush",    "car",        "bicycle",     "bollard",         "sign",     "waste bin", "hydrant",
        "cone", "planter", "park bench", "street lamp", "standing person", "quadruped"};
    for (int k = 0;; ++k) {
      const Family& family = dice_.pick(families());
      if (family.use != options_.use) continue;
      if (k >= 200) return family;
      const bool fits_outside = outside.contains(family.name);
      if (world_.place == Place::outdoor && !fits_outside && options_.use == Use::fit && !dice_.chance(0.12))
        continue;
      if (world_.place != Place::outdoor && fits_outside && family.most_m > 2.2) continue;
      if (is_small && family.most_m > 2.2) continue;
      return family;
    }
  }

  static float longest(const Mesh& mesh) {
    const auto [low, high] = bounds(mesh);
    return std::max({high.x - low.x, high.y - low.y, high.z - low.z});
  }

  [[nodiscard]] bool is_free(const Footprint& footprint, float bottom, float top, float gap,
                             std::size_t support) const {
    return std::ranges::all_of(standing_, [&](const Standing& other) {
      return other.body == support || other.top <= bottom + 1e-3F || other.bottom >= top ||
             are_apart(other.footprint, footprint, gap);
    });
  }

  /// Most things are in view and neither tiny nor larger than the image.
  bool is_of_good_size(const Mesh& mesh, Vec2 at, float bottom, const std::string& how) {
    const auto [low, high] = bounds(mesh);
    const Pixel middle = pixel_of({at.x, at.y, bottom + high.z / 2});
    const Size size = world_.scene.rig.size;
    const float w = static_cast<float>(size.width), h = static_cast<float>(size.height);
    if (middle.depth < nearest_) return false;
    std::array sides{high.x - low.x, high.y - low.y, high.z - low.z};
    std::ranges::sort(sides);
    const float of_metre = world_.scene.rig.focal_px / middle.depth / 2;
    const float half = of_metre * sides[2];
    if (half > 0.5F * w) return false;
    const float least = how == "on" || how == "shelf" ? 0.75F * kSmall : kSmall;
    if (of_metre * std::sqrt(sides[1] * sides[2]) < least * w && !dice_.chance(small_share_)) return false;
    const float margin = how == "edge" ? -0.8F * half : 0.1F * half;
    return middle.x > margin && middle.x < w - margin && middle.y > margin && middle.y < h - margin;
  }

  /// Share of the image that the bounding box covers.
  [[nodiscard]] float share_of_image(const Footprint& footprint, float bottom, float top) const {
    const Size size = world_.scene.rig.size;
    const float w = static_cast<float>(size.width), h = static_cast<float>(size.height);
    Vec2 low{w, h}, high{0, 0};
    for (const Vec2 c : footprint.corners()) {
      for (const float z : {bottom, top}) {
        const Pixel pixel = pixel_of({c.x, c.y, z});
        if (pixel.depth < 0.05F) return 1;
        low = {std::min(low.x, pixel.x), std::min(low.y, pixel.y)};
        high = {std::max(high.x, pixel.x), std::max(high.y, pixel.y)};
      }
    }
    return std::max(std::min(high.x, w) - std::max(low.x, 0.0F), 0.0F) *
           std::max(std::min(high.y, h) - std::max(low.y, 0.0F), 0.0F) / (w * h);
  }

  static bool is_inside(const Footprint& a, const Footprint& b) {
    return std::ranges::all_of(a.corners(), [&](Vec2 c) {
      return std::abs(c.x - b.centre.x) < b.half.x && std::abs(c.y - b.centre.y) < b.half.y;
    });
  }

  /// Puts it there; false if it would be in another's place.
  bool put(Made& made, Vec2 at, float yaw, float bottom, float gap, const std::string& how,
           std::size_t support = std::numeric_limits<std::size_t>::max()) {
    const auto [low, high] = bounds(made.mesh);
    const Footprint footprint{at, {(high.x - low.x) / 2, (high.y - low.y) / 2}, yaw};
    if (bottom == 0) bottom = height_of_ground(at);
    const float top = bottom + high.z;
    if (!is_free(footprint, bottom, top, gap, support)) return false;
    // Nothing in the camera's face.
    const Vec3 eye = world_.scene.rig.eye;
    const Vec2 apart{eye.x - at.x, eye.y - at.y};
    const float radius = std::hypot(footprint.half.x, footprint.half.y);
    if (std::hypot(apart.x, apart.y) < radius + nearest_ && eye.z < top + nearest_) return false;
    if (how != "row" && !is_of_good_size(made.mesh, at, bottom, how)) return false;
    if (share_of_image(footprint, bottom, top) > kLargest) return false;
    if (table_ && bottom == 0 && !is_inside(footprint, *table_)) return false;
    if (world_.things.size() >= 250) return false;
    stand(made, at, yaw, bottom, how);
    standing_.push_back(
        {footprint, bottom, top, world_.scene.bodies.size() - 1, static_cast<int>(world_.things.size())});
    return true;
  }
  void stand(const Made& made, Vec2 at, float yaw, float bottom, const std::string& how) {
    const int id = static_cast<int>(world_.things.size()) + 1;
    const auto [low, high] = bounds(made.mesh);
    Body body;
    body.looks = made.looks;
    body.own = made.mesh.points;
    body.mesh = moved(turned(made.mesh, kZ, yaw), {at.x, at.y, bottom});
    body.id = id;
    world_.scene.bodies.push_back(std::move(body));
    world_.things.push_back({id, made.kind, how, high - low, {at.x, at.y, bottom + high.z / 2}});
  }

  /// The height of a thing about a point, if it is level there.
  std::optional<float> level_at(const Standing& below, Vec2 at, float reach) const {
    const Mesh& support = world_.scene.bodies[below.body].mesh;
    float least = std::numeric_limits<float>::max(), most = -least;
    const Footprint foot{at, {reach, reach}, 0};
    const auto corners = foot.corners();
    for (const Vec2 p : {at, corners[0], corners[1], corners[2], corners[3]}) {
      const auto z = height_at(support, p.x, p.y);
      if (!z) return std::nullopt;
      least = std::min(least, *z), most = std::max(most, *z);
    }
    if (most - least > kLevel || most < below.bottom + 0.02F) return std::nullopt;
    return most;
  }

  /// On top of something that is level somewhere, as large as that allows.
  bool add_on_top() {
    for (int k = 0; k < 2 * kTries; ++k) {
      const Standing below = dice_.pick(standing_);
      const float u = draw(dice_, 0.1, 0.9), v = draw(dice_, 0.1, 0.9);
      const Vec2 at = below.footprint.point(u, v);
      const float room = std::min(below.footprint.half.x, below.footprint.half.y) * draw(dice_, 0.2, 0.9);
      const auto height = level_at(below, at, 0.6F * room);
      if (!height) continue;
      Made made = thing(2.2F * room, true);
      if (put(made, at, draw(dice_, 0, 2 * kPi), *height, 0.005F, "on", below.body)) return true;
    }
    return false;
  }

  struct Amount {
    int count = 0;
    float least_m = 0;  // longest side; 0: as drawn
    float most_m = 0;
    float far = 6;
    double at_wall = 0.12;
    double on = 0.25;
    double touching = 0.15;
    double at_edge = 0.12;
  };

  /// Something with a level top, for others to stand on: a block, a drum, a slab on legs.
  bool add_support(float bottom, const Amount& amount) {
    const bool is_small = amount.most_m > 0;
    const float scale = is_small ? 0.35F : 1;
    const Vec3 size{scale * draw(dice_, 0.3, 0.9), scale * draw(dice_, 0.3, 0.9),
                    scale * draw(dice_, 0.15, 0.8)};
    Made made;
    switch (dice_.below(3)) {
      case 0:
        made.mesh = box(size, draw(dice_, 0, 0.04) * size.z);
        break;
      case 1:
        made.mesh = cylinder(size.x / 2, size.z, dice_.between(6, 40));
        break;
      default: {
        const float thick = draw(dice_, 0.02, 0.1) * size.z;
        made.mesh = moved(box({size.x, size.y, thick}), {0, 0, size.z - thick});
        Dice own = dice_.fork(0x1E65 + world_.things.size());
        add_legs(made.mesh, own, corners(0.45F * size.x, 0.45F * size.y, size.z - thick), 1);
        settle(made.mesh);
      }
    }
    made.kind = "support";
    paint(made);
    for (int t = 0; t < 2 * kTries; ++t) {
      if (t < kTries && dice_.chance(amount.at_wall) && put_at_wall(made, bottom, amount.far)) return true;
      const auto at = spot(bottom, amount.far, false);
      if (at && put(made, *at, draw(dice_, 0, 2 * kPi), bottom, 0.02F, "free")) return true;
    }
    return false;
  }

  /// A point of the image where a thing may stand, on the plane z = height.
  std::optional<Vec2> spot(float height, float far, bool at_edge) {
    const Size size = world_.scene.rig.size;
    const float w = static_cast<float>(size.width), h = static_cast<float>(size.height);
    float x = draw(dice_, 0.08, 0.92) * w;
    const float share = draw(dice_, 0, 1);
    const float y = (1.05F - 0.9F * share) * h;
    if (at_edge) x = dice_.chance(0.5) ? draw(dice_, -0.08, 0.06) * w : draw(dice_, 0.94, 1.08) * w;
    return on_plane(x, y, height, far);
  }

  /// Against the nearest upright background: `walls_`.
  bool put_at_wall(Made& made, float bottom, float far) {
    if (walls_.empty()) return false;
    const auto [low, high] = bounds(made.mesh);
    const float deep = (high.y - low.y) / 2 + (dice_.chance(0.7) ? 0.004F : draw(dice_, 0.01, 0.1));
    const float off = dice_.chance(0.8) ? 0 : draw(dice_, -0.06, 0.06);
    const Size size = world_.scene.rig.size;
    for (int k = 0; k < kTries; ++k) {  // most of the walls are out of view
      const auto& [from, to, inward] = dice_.pick(walls_);
      const float t = draw(dice_, 0.03, 0.97);
      const Vec2 at{from.x + t * (to.x - from.x) + deep * inward.x,
                    from.y + t * (to.y - from.y) + deep * inward.y};
      const Pixel pixel = pixel_of({at.x, at.y, bottom + high.z / 2});
      if (pixel.depth < nearest_ || pixel.depth > far || pixel.x < 0 ||
          pixel.x > static_cast<float>(size.width) || pixel.y < 0 ||
          pixel.y > static_cast<float>(size.height)) {
        continue;
      }
      return put(made, at, std::atan2(to.y - from.y, to.x - from.x) + off, bottom, 0.005F, "wall");
    }
    return false;
  }

  /// Next to another thing, moved towards it until it touches.
  bool put_touching(Made& made, float bottom) {
    const Standing near = dice_.pick(standing_);
    if (near.bottom != bottom) return false;
    const auto [low, high] = bounds(made.mesh);
    const float yaw = dice_.chance(0.5) ? near.footprint.yaw : draw(dice_, 0, 2 * kPi);
    const Vec3 side = polar(1, draw(dice_, 0, 2 * kPi));
    Footprint foot{{}, {(high.x - low.x) / 2, (high.y - low.y) / 2}, yaw};
    const auto move_to = [&](float distance) {
      foot.centre = {near.footprint.centre.x + distance * side.x,
                     near.footprint.centre.y + distance * side.y};
    };
    constexpr float kStep = 0.01F;
    float distance =
        std::hypot(near.footprint.half.x, near.footprint.half.y) + std::hypot(foot.half.x, foot.half.y);
    for (; distance > 0; distance -= kStep) {
      move_to(distance);
      if (!are_apart(foot, near.footprint, 0.004F)) break;
    }
    move_to(distance + kStep);
    return put(made, foot.centre, yaw, bottom, 0, "touch");
  }

  void fill(float bottom, const Amount& amount) {
    for (int k = 0; k < amount.count; ++k) {
      const float size =
          amount.most_m > 0 ? static_cast<float>(dice_.log_uniform(amount.least_m, amount.most_m)) : 0;
      const double way = dice_.unit();
      if (way < amount.on) {
        if (!standing_.empty() && add_on_top()) continue;
        if (dice_.chance(kSupports) && add_support(bottom, amount)) continue;
      }
      const bool at_wall = way < amount.on + amount.at_wall;
      const bool touches =
          !at_wall && !standing_.empty() && way < amount.on + amount.at_wall + amount.touching;
      const bool at_edge = dice_.chance(amount.at_edge);
      Made made = thing(size, amount.most_m > 0);
      for (int t = 0; t < 2 * kTries; ++t) {
        // What fits nowhere is made smaller.
        if (t % 12 == 11) made.mesh = scaled(std::move(made.mesh), {0.7F, 0.7F, 0.7F});
        if (at_wall && t < kTries) {
          if (put_at_wall(made, bottom, amount.far)) break;
          continue;
        }
        if (touches && t < kTries) {
          if (put_touching(made, bottom)) break;
          continue;
        }
        const auto at = spot(bottom, amount.far, at_edge);
        const float yaw = draw(dice_, 0, 2 * kPi);
        if (at && put(made, *at, yaw, bottom, 0.02F, at_edge ? "edge" : "free")) break;
      }
    }
  }

  // ---- places ----

  void light_room(float width, float depth, float height) {
    Scene& scene = world_.scene;
    const float level = static_cast<float>(dice_.log_uniform(0.25, 1.2));
    const Vec3 tint{draw(dice_, 0.85, 1.1), draw(dice_, 0.9, 1.05), draw(dice_, 0.75, 1.15)};
    const int lamps = dice_.between(1, 3);
    for (int k = 0; k < lamps; ++k) {
      const float x = draw(dice_, 0.1, 0.9) * width, y = draw(dice_, -0.4, 0.4) * depth;
      scene.lamps.push_back({{x, y, height - 0.02F},
                             static_cast<float>(dice_.log_uniform(0.06, 0.6)),
                             (draw(dice_, 1, 4) / static_cast<float>(lamps)) * level * tint});
    }
    if (dice_.chance(0.25)) {  // sun through a window
      const float side = draw(dice_, -1, 1);
      scene.lamps.push_back({unit({draw(dice_, -1, 0.2), side, draw(dice_, 0.4, 1.2)}), 0,
                             draw(dice_, 0.5, 2) * level * Vec3{1, 0.95F, 0.85F}});
    }
    scene.ambient = draw(dice_, 0.25, 0.8) * level * tint;
    scene.reach_m = draw(dice_, 0.6, 2.5);
    scene.sky_low = scene.sky_high = 0.8F * level * tint;
  }

  void wall(Vec3 from, Vec3 along, float height, const Look& look, Vec2 inward) {
    quad(from, along, {0, 0, height}, look);
    walls_.push_back({{from.x, from.y}, {from.x + along.x, from.y + along.y}, inward});
    const float l = length(along);
    const Vec3 u = unit(along), in{inward.x, inward.y, 0};
    if (dice_.chance(0.5)) {  // skirting
      const Vec3 a = from + 0.012F * in;
      quad(a, along, {0, 0, draw(dice_, 0.05, 0.12)}, look_of_thing());
    }
    const int items = dice_.below(4);
    for (int k = 0; k < items; ++k) {
      const float w = draw(dice_, 0.3, 1.4), h = draw(dice_, 0.25, 1.3),
                  t = draw(dice_, 0, 1) * std::max(0.0F, l - w);
      const float z = draw(dice_, 0.7, 1.6);
      const int kind = dice_.below(4);
      if (kind == 0) {  // a picture or a board
        quad(from + t * u + Vec3{0, 0, z} + 0.015F * in, w * u, {0, 0, h}, look_of_thing());
      } else if (kind == 1) {  // a window
        quad(from + t * u + Vec3{0, 0, z} + 0.01F * in, w * u, {0, 0, h}, look_of_thing()).is_bright =
            dice_.chance(0.6);
      } else if (kind == 2) {  // a radiator
        const Look paint = look_of_thing();
        const float deep = draw(dice_, 0.06, 0.12), step = draw(dice_, 0.05, 0.1);
        for (float s = 0; s + 0.6F * step < std::min(w, l - t); s += step) {
          const Vec3 at = from + (t + s) * u + Vec3{0, 0, 0.12F};
          add(beam(at + deep / 2 * in, at + deep / 2 * in + Vec3{0, 0, 0.55F}, deep, 0.6F * step), paint);
        }
      } else {  // a door
        quad(from + t * u + 0.01F * in, std::min(0.9F, l) * u, {0, 0, 2}, look_of_thing());
      }
    }
  }

  /// The ground and three walls, from behind the camera on along x.
  void enclose(float depth, float width, float height, const Look& floor, const Look& front,
               const Look& walls) {
    quad({-3, -width / 2, 0}, {depth + 3, 0, 0}, {0, width, 0}, floor).is_ground = true;
    wall({depth, -width / 2, 0}, {0, width, 0}, height, front, {-1, 0});
    wall({-3, -width / 2, 0}, {depth + 3, 0, 0}, height, walls, {0, 1});
    wall({-3, width / 2, 0}, {depth + 3, 0, 0}, height, walls, {0, -1});
  }

  void ceiling(float depth, float width, float height) {
    Look look;
    look.colours.fill({0.8F, 0.8F, 0.78F});
    quad({-3, -width / 2, height}, {depth + 3, 0, 0}, {0, width, 0}, look);
  }

  void room() {
    const bool is_corridor = world_.place == Place::corridor, is_clutter = world_.place == Place::clutter;
    const float height = draw(dice_, 2.3, 3.6);
    const float depth =
        is_corridor ? draw(dice_, 4, 12) : draw(dice_, 2.2, 7);  // from the camera's wall on, along x
    const float width = is_corridor ? draw(dice_, 1.4, 2.6) : draw(dice_, 2.5, 7);
    light_room(depth, width, height);
    const Look floor = marked(floor_look(dice_)), walls = marked(wall_look(dice_));
    floor_like_ = floor;
    const Look front = dice_.chance(0.7) ? walls : wall_look(dice_);
    enclose(depth, width, height, floor, front, walls);
    ceiling(depth, width, height);

    const float eye = is_clutter ? draw(dice_, 0.35, 1.4) : static_cast<float>(dice_.log_uniform(0.15, 1.6));
    const float down = is_clutter ? draw(dice_, 10, 50) : draw(dice_, -3, 12) + eye * draw(dice_, 8, 28);
    const float side = draw(dice_, -0.3, 0.3) * width, yaw = draw(dice_, -0.5, 0.5);
    camera({draw(dice_, -0.6, 0.4), side, eye}, yaw, down, draw(dice_, 0.5, 1.1),
           static_cast<float>(dice_.log_uniform(0.05, 0.22)));
    nearest_ = 0.35F;
    if (world_.place == Place::shelf) shelves(depth, width);
    Amount amount;
    amount.count = dice_.chance(0.04) ? 0 : dice_.between(2, 8);
    amount.far = depth + 1;
    if (is_clutter) amount = {dice_.between(8, 14), 0.1F, 0.6F, 3, 0.05, 0.3, 0.5, 0.15};
    if (world_.place == Place::shelf) amount.count = dice_.between(0, 3);
    fill(0, amount);
  }

  /// Boards fixed to the wall in front, with things on them.
  void shelves(float depth, float width) {
    const Look look = look_of_thing();
    const int boards = dice_.between(2, 4);
    const float w = std::min(width * 0.9F, draw(dice_, 0.8, 2.2)), deep = draw(dice_, 0.22, 0.45);
    const float gap = draw(dice_, 0.28, 0.5), low = draw(dice_, 0.1, 0.5), thick = draw(dice_, 0.015, 0.04);
    Rig& rig = world_.scene.rig;
    const float away = draw(dice_, 0.7, 1.3), middle = draw(dice_, -0.2, 0.2) * width;
    const float eye = low + draw(dice_, 0.3, 0.9) * static_cast<float>(boards) * gap;
    camera({depth - deep - away, middle + draw(dice_, -0.2, 0.2), eye}, draw(dice_, -0.2, 0.2),
           draw(dice_, -5, 18), rig.focal_px / static_cast<float>(rig.size.width), rig.baseline_m);
    for (int k = 0; k < boards; ++k) {
      const float z = low + gap * static_cast<float>(k);
      block({depth - deep, middle - w / 2, z}, {depth, middle + w / 2, z + thick}, look);
    }
    if (dice_.chance(0.5)) {
      for (const float y : {middle - w / 2, middle + w / 2 - thick})
        block({depth - deep, y, 0}, {depth, y + thick, low + gap * static_cast<float>(boards)}, look);
    }
    for (int k = 0; k < boards; ++k) {
      const float z = low + gap * static_cast<float>(k) + thick;
      float y = middle - w / 2 + 0.05F;
      while (y < middle + w / 2 - 0.08F) {
        if (dice_.chance(0.35)) {
          y += draw(dice_, 0.05, 0.3);
          continue;
        }
        Made made = thing(draw(dice_, 0.08, 0.85 * gap), true);
        const auto [from, to] = bounds(made.mesh);
        const float half = (to.y - from.y) / 2;
        if (y + 2 * half < middle + w / 2 && to.x - from.x < deep * 1.1F && to.z < gap - thick)
          put(made, {depth - deep / 2 + draw(dice_, -0.04, 0.02), y + half}, dice_.chance(0.7) ? 0 : kPi, z,
              0.002F, "shelf");
        y += 2 * half + (dice_.chance(0.4) ? 0.004F : draw(dice_, 0.01, 0.15));
      }
    }
  }

  void table() {
    const float below = draw(dice_, 0.5, 0.85);  // the room's floor
    const float w = draw(dice_, 0.8, 2.4), d = draw(dice_, 0.6, 1.4);
    light_room(2, 3, 2.2F);
    const Look top = marked(dice_.chance(0.4) ? look_of_thing() : floor_look(dice_)),
               floor = floor_look(dice_), walls = wall_look(dice_);
    floor_like_ = top;
    quad({-4, -4, -below}, {9, 0, 0}, {0, 8, 0}, floor);
    const float back = d + (dice_.chance(0.4) ? 0.01F : draw(dice_, 0.2, 3));
    wall({back, -4, -below}, {0, 8, 0}, 3, walls, {-1, 0});
    if (back > d + 0.05F) walls_.clear();
    wall({-4, 4, -below}, {9, 0, 0}, 3, walls, {0, -1});
    walls_.resize(back > d + 0.05F ? 0 : 1);
    add(moved(box({d, w, 0.03F}, 0.004F), {d / 2, 0, -0.03F}), top).is_ground = true;
    for (const float y : {-w / 2 + 0.05F, w / 2 - 0.05F})
      for (const float x : {0.06F, d - 0.06F})
        add(beam({x, y, -below}, {x, y, -0.03F}, 0.05F, 0.05F), look_of_thing());
    const float away = draw(dice_, 0.25, 0.8), eye = draw(dice_, 0.25, 0.9);
    const float aim = std::atan2(eye, away + draw(dice_, 0.15, 0.6) * d) * 180 / kPi;
    camera({-away, draw(dice_, -0.2, 0.2) * w, eye}, draw(dice_, -0.25, 0.25), aim + draw(dice_, -6, 6),
           draw(dice_, 0.6, 1.6), static_cast<float>(dice_.log_uniform(0.04, 0.14)));
    nearest_ = 0.2F;
    table_ = Footprint{{d / 2, 0}, {d / 2, w / 2}, 0};
    Amount amount{dice_.chance(0.04) ? 0 : dice_.between(1, 10),
                  0.04F,
                  0.4F,
                  3,
                  back > d + 0.05F ? 0.0 : 0.15,
                  0.2,
                  0.35,
                  0.1};
    fill(0, amount);
  }

  // ---- the paper's laboratory ----

 public:
  void laboratory(int sequence, float time) {
    constexpr float kDepth = 6, kWidth = 5, kHeight = 3;
    world_.place = Place::room;
    light_room(kDepth, kWidth, kHeight);
    Look floor = floor_look(dice_);
    floor.gloss = 0.12F, floor.roughness = 0.05F;
    const Look walls = wall_look(dice_);
    enclose(kDepth, kWidth, kHeight, floor, walls, walls);
    constexpr std::array<std::array<Vec2, 3>, kLaboratorySequences> kPlaces{{
        {{{2.6F, 0.55F}, {2.2F, -0.1F}, {3, -0.8F}}},
        {{{3.1F, -0.5F}, {2.5F, 0.7F}, {2, 0}}},
        {{{2.75F, 0.18F}, {2.3F, 0}, {2.6F, -0.9F}}},
        {{{2.4F, 0.4F}, {2.8F, -0.5F}, {}}},
    }};
    constexpr std::array kNames{"blue", "yellow", "red"};
    constexpr std::array<Vec3, 3> kColours{
        {{0.06F, 0.14F, 0.55F}, {0.75F, 0.55F, 0.04F}, {0.6F, 0.05F, 0.04F}}};
    std::array<Mesh, 3> meshes{box({0.3F, 0.36F, 0.42F}, 0.02F), cylinder(0.17F, 0.4F, 40),
                               blob({0.16F, 0.2F, 0.25F}, 0.1F, 3, dice_, 40)};
    const auto& places = kPlaces.at(static_cast<std::size_t>(sequence));
    for (std::size_t i = 0; i < (sequence == 3 ? 2U : 3U); ++i) {
      Look look = look_of_thing();
      look.pattern = i == 0 ? Pattern::label : i == 1 ? Pattern::stripes : Pattern::weave;
      const Vec3 colour = kColours.at(i);
      look.colours = {colour, 0.45F * colour, mix(colour, {0.8F, 0.8F, 0.8F}, 0.35F), 0.7F * colour};
      look.period = i == 2 ? Vec2{0.015F, 0.015F} : Vec2{0.2F, 0.18F};
      settle(meshes.at(i));
      Made made{std::move(meshes.at(i)), {}, kNames.at(i)};
      made.looks.fill(look);
      stand(made, places.at(i), draw(dice_, 0, 2 * kPi), 0, "free");
    }
    const float turn = 2 * kPi * time + static_cast<float>(sequence);
    camera({time, 0.2F * std::sin(turn), 0.45F}, 0.1F * std::cos(turn), 8, 0.9F, 0.12F);
    sensor();
    world_.sensor.is_grey = false;
  }

  // ---- tours ----

  void tour(Tour& tour) {
    world_.place = Place::room;
    const float radius = draw(dice_, 2.2, 2.9), side = 2 * (radius + 1.4F), depth = side - 3;
    const Vec2 middle{(depth - 3) / 2, 0};
    tour_path(tour, middle, radius);
    const float height = draw(dice_, 2.4, 3.4);
    light_room(depth, side, height);
    const Look floor = marked(floor_look(dice_)), walls = marked(wall_look(dice_));
    floor_like_ = floor;
    enclose(depth, side, height, floor, dice_.chance(0.5) ? walls : wall_look(dice_), walls);
    wall({-3, -side / 2, 0}, {0, side, 0}, height, walls, {1, 0});
    ceiling(depth, side, height);

    const PathPoint look = tour.path.at(static_cast<std::size_t>(tour.first_look - 1));
    const float eye = draw(dice_, 0.35, 1.1);
    camera({look.at.x, look.at.y, eye}, look.heading,
           std::atan2(eye, radius) * 180 / kPi + draw(dice_, -7, 1), draw(dice_, 0.6, 0.85),
           draw(dice_, 0.08, 0.16));
    nearest_ = 0.6F;
    const Footprint ground{middle, {kGroup, kGroup}, look.heading};
    const int count = dice_.between(5, 9);
    for (int k = 0; k < count; ++k) {
      const float size = draw(dice_, 0.25, 0.8);
      Made made = thing(size, size < 0.5F);
      for (int t = 0; t < 2 * kTries; ++t) {
        const float u = draw(dice_, 0, 1), v = draw(dice_, 0, 1);
        if (put(made, ground.point(u, v), draw(dice_, 0, 2 * kPi), 0, kTourGap, "free")) break;
      }
    }
    sensor();
    if (dice_.chance(0.5)) move_in_view(tour, ground);
    if (dice_.chance(0.75)) carry_away(tour, ground);
  }

 private:
  static constexpr int kSecondLook = 22;    // frames
  static constexpr float kGroup = 1.2F;     // m, half a side of the square that the group stands in
  static constexpr float kTourGap = 0.12F;  // m, between its things
  static constexpr int kSeen = 307;         // of so many pixels of the image, one: 250 of 320×240

  void tour_path(Tour& tour, Vec2 middle, float radius) {
    constexpr int kFirst = 22;
    constexpr float kCloser = 0.03F, kDrive = 0.1F, kTurn = 0.16F;  // m and rad per frame
    const float from = draw(dice_, 0, 2 * kPi), arc = draw(dice_, 0.35, 2.1);
    const float side = dice_.chance(0.5) ? 1.0F : -1.0F;  // 1: to the left around the middle
    const auto add = [&](float angle, float distance, float heading) {
      tour.path.push_back(
          {{middle.x + distance * std::cos(angle), middle.y + distance * std::sin(angle)}, heading});
    };
    for (int k = 1; k <= kFirst; ++k)
      add(from, radius + kCloser * static_cast<float>(kFirst - k), from + kPi);
    tour.first_look = kFirst;
    const int turns = static_cast<int>(std::ceil(kPi / 2 / kTurn));
    for (int k = 1; k <= turns; ++k) add(from, radius, from + kPi - side * kPi / 2 * fraction(k, turns));
    const int steps = static_cast<int>(std::ceil(arc * radius / kDrive));
    for (int k = 1; k <= steps; ++k) {
      const float angle = from + side * arc * fraction(k, steps);
      add(angle, radius, angle + kPi - side * kPi / 2);
    }
    const float to = from + side * arc;
    for (int k = 1; k <= turns; ++k) add(to, radius, to + kPi - side * kPi / 2 * (1 - fraction(k, turns)));
    for (int k = 1; k <= kSecondLook; ++k) add(to, radius - kCloser * static_cast<float>(k), to + kPi);
  }

  /// Another place for a thing on the ground, where it is apart from everything that stands there.
  std::optional<Footprint> another_place(const Standing& thing, const Footprint& ground, float least,
                                         float most) {
    const Vec2 at = thing.footprint.centre;
    const float way = draw(dice_, 0, 2 * kPi), distance = draw(dice_, least, most);
    Footprint there = thing.footprint;
    there.centre = {at.x + distance * std::cos(way), at.y + distance * std::sin(way)};
    if (!is_inside({there.centre, {0.01F, 0.01F}, 0}, Footprint{ground.centre, ground.half, 0}))
      return std::nullopt;
    return is_apart(thing, there) ? std::optional(there) : std::nullopt;
  }
  [[nodiscard]] bool is_apart(const Standing& thing, const Footprint& there) const {
    return std::ranges::all_of(standing_, [&](const Standing& other) {
      return other.id == thing.id || are_apart(other.footprint, there, kTourGap);
    });
  }

  void move_in_view(Tour& tour, const Footprint& ground) {
    if (standing_.empty()) return;
    for (int k = 0; k < kTries; ++k) {
      Standing& thing = standing_[static_cast<std::size_t>(dice_.below(static_cast<int>(standing_.size())))];
      const auto there = another_place(thing, ground, 0.7F, 1.2F);
      if (!there) continue;
      const Vec2 from = thing.footprint.centre, to = there->centre;
      bool is_open = true;
      for (int j = 1; j < 10; ++j) {
        Footprint between = *there;
        between.centre = {from.x + fraction(j, 10) * (to.x - from.x),
                          from.y + fraction(j, 10) * (to.y - from.y)};
        is_open = is_open && is_apart(thing, between);
      }
      if (!is_open) continue;
      tour.moves.push_back({thing.id, "moves in view", 4, 17, from, to, 0});
      thing.footprint = *there;
      return;
    }
  }

  void carry_away(Tour& tour, const Footprint& ground) {
    if (standing_.empty()) return;
    const int last = static_cast<int>(tour.path.size()) - 1,
              when = (tour.first_look + last - kSecondLook) / 2;  // on the arc
    const int enough = static_cast<int>(options_.size.area()) / kSeen;
    const auto seen = [&](int frame, int id) {
      const Truth truth = truth_of(world_of(tour, frame).scene);
      int count = 0;
      for (int y = 0; y < truth.ids.height(); ++y)
        count += static_cast<int>(std::count(truth.ids.row(y), truth.ids.row(y) + truth.ids.width(), id));
      return count;
    };
    for (int k = 0; k < 2 * kTries; ++k) {
      const Standing& thing = dice_.pick(standing_);
      const int id = thing.id;
      if (std::ranges::find(tour.moves, id, &Move::id) != tour.moves.end()) continue;
      const auto there = another_place(thing, ground, 0.5F, 1.8F);
      if (!there || seen(tour.first_look - 1, id) < enough || seen(last, id) < enough ||
          seen(when - 1, id) > 0)
        continue;
      tour.moves.push_back({id, "carried away while out of view", when, when, thing.footprint.centre,
                            there->centre, draw(dice_, -kPi, kPi)});
      if (seen(last, id) >= enough && seen(when, id) == 0) return;
      tour.moves.pop_back();
    }
  }

  // ---- outdoors ----

  /// A large ground, a little uneven: a grid whose cells are as fine as they look.
  Body& ground(const Look& look, float unevenness, float slope) {
    constexpr int kCells = 72;
    is_level_ = slope == 0;
    Mesh mesh;
    const std::uint64_t seed = dice_.bits();
    const float p1 = static_cast<float>(seed % 628) / 100, p2 = static_cast<float>(seed / 628 % 628) / 100;
    for (int i = 0; i <= kCells; ++i) {
      for (int j = 0; j <= kCells; ++j) {
        const float u = fraction(i, kCells), v = 2 * fraction(j, kCells) - 1;
        const float x = -2 + 72 * u * u, y = (2 + x + 2) * 1.6F * v;
        const float z = slope * x + unevenness * (std::sin(0.9F * x + p1) * std::sin(0.7F * y + p2) +
                                                  0.5F * std::sin(2.3F * x + p2) * std::sin(1.9F * y + p1));
        mesh.points.push_back({x, y, z});
        mesh.uv.push_back({x, y});
      }
    }
    for (std::uint32_t i = 0; i < kCells; ++i) {
      for (std::uint32_t j = 0; j < kCells; ++j) {
        const std::uint32_t a = i * (kCells + 1) + j, b = a + kCells + 1;
        mesh.triangles.push_back({a, b, b + 1});
        mesh.triangles.push_back({a, b + 1, a + 1});
      }
    }
    mesh.part.assign(mesh.triangles.size(), 0);
    Body& body = add(std::move(mesh), look);
    body.is_ground = true;
    return body;
  }

  void facade(Vec3 from, Vec3 along, float height) {
    const Vec3 u = unit(along), in{-u.y, u.x, 0};
    quad(from, along, {0, 0, height}, wall_look(dice_));
    walls_.push_back({{from.x, from.y}, {from.x + along.x, from.y + along.y}, {in.x, in.y}});
    windows(from, along, height, look_of_thing());
  }

  /// Rows of panes on the left-hand side of a wall.
  void windows(Vec3 from, Vec3 along, float height, const Look& frame) {
    const Vec3 u = unit(along), in{-u.y, u.x, 0};
    const float l = length(along);
    Look glass;
    glass.colours.fill(draw(dice_, 0.02, 0.3) * Vec3{0.8F, 0.95F, 1});
    glass.gloss = 0.08F, glass.roughness = 0.05F;
    const float w = draw(dice_, 0.7, 1.5), gap = draw(dice_, 0.6, 1.8), h = draw(dice_, 0.9, 1.7);
    for (float z = draw(dice_, 0.6, 1.2); z + h < height; z += h + 1.2F) {
      for (float t = gap; t + w < l; t += w + gap) {
        quad(from + t * u + Vec3{0, 0, z} + 0.02F * in, w * u, {0, 0, h}, glass);
        if (dice_.chance(0.9))
          add(beam(from + t * u + Vec3{0, 0, z - 0.04F} + 0.06F * in,
                   from + (t + w) * u + Vec3{0, 0, z - 0.04F} + 0.06F * in, 0.1F, 0.08F),
              frame);
      }
    }
  }

  /// A house behind its front, which looks to the left of `along`.
  void house(Vec3 from, Vec3 along, float depth, float height) {
    const Vec3 u = unit(along), in{-u.y, u.x, 0}, middle = from + 0.5F * along - 0.5F * depth * in;
    const float l = length(along), turn = std::atan2(u.y, u.x);
    const Look walls = dice_.chance(0.5) ? masonry_look(dice_) : wall_look(dice_);
    add(moved(turned(box({l, depth, height}), kZ, turn), middle), walls);
    const Look frame = look_of_thing();
    windows(from, along, height, frame);
    if (dice_.chance(0.6)) windows(from - depth * in, depth * in, height, frame);
    if (dice_.chance(0.6)) windows(from + along, -depth * in, height, frame);
    if (dice_.chance(0.3)) return;  // a flat roof
    const float rise = draw(dice_, 1, 3.5), over = draw(dice_, 0, 0.6),
                ridge = dice_.chance(0.3) ? 0.5F : 1.0F;
    Mesh roof = warped(box({l + over, depth + over, rise}), [&](Vec3 p) {
      return p.z > 0.5F * rise ? Vec3{ridge * p.x, 0, p.z} : p;
    });
    add(moved(turned(std::move(roof), kZ, turn), middle + Vec3{0, 0, height}), wall_look(dice_));
  }

  /// Houses, or sheds, on both sides of a way and at its end, apart or joined.
  void houses(float left, float right, float far) {
    const auto row = [&](const auto& front_of, float from, float to) {
      const bool are_joined = dice_.chance(0.35);
      const float back = draw(dice_, 0.2, 5), tall = draw(dice_, 3, 8);
      for (float t = from; t < to;) {
        const bool is_shed = dice_.chance(0.25);
        const float l = is_shed ? draw(dice_, 2, 6) : draw(dice_, 4, 13);
        const auto [corner, along] = front_of(t, l, back + (are_joined ? 0 : draw(dice_, 0, 2)));
        const float deep = draw(dice_, 2, 5) + (is_shed ? 0 : 4.0F);
        house(corner, along, deep, is_shed ? draw(dice_, 1.9, 2.8) : tall * draw(dice_, 0.8, 1.2));
        t += l + (are_joined ? 0 : draw(dice_, 0.5, 9));
      }
    };
    using Front = std::pair<Vec3, Vec3>;
    const auto on_the_left = [&](float x, float l, float back) {
      return Front{{x + l, left + back, 0}, {-l, 0, 0}};
    };
    const auto on_the_right = [&](float x, float l, float back) {
      return Front{{x, right - back, 0}, {l, 0, 0}};
    };
    const auto at_the_end = [&](float y, float l, float back) {
      return Front{{far + back, y, 0}, {0, l, 0}};
    };
    if (dice_.chance(0.75)) row(on_the_left, draw(dice_, -3, 14), 60);
    if (dice_.chance(0.75)) row(on_the_right, draw(dice_, -3, 14), 60);
    far += draw(dice_, 0.5, 20);
    if (dice_.chance(0.6)) row(at_the_end, right - draw(dice_, 0, 15), left + 10);
  }

  Look leaves() {
    Look leaves;
    leaves.pattern = Pattern::noise;
    leaves.period = {0.05F, 0.05F};
    const float green = draw(dice_, 0.06, 0.25);
    leaves.colours = {
        Vec3{0.35F * green, green, 0.3F * green}, Vec3{0.1F * green, 0.35F * green, 0.1F * green}, {}, {}};
    leaves.seed = static_cast<std::uint32_t>(dice_.bits());
    return leaves;
  }

  void hedge(Vec3 from, Vec3 along) {
    const float h = draw(dice_, 0.8, 2.2), l = length(along), w = draw(dice_, 0.4, 0.9);
    const Vec3 u = unit(along);
    const Look look = leaves();
    for (float t = 0; t < l; t += 0.8F * h) {
      Mesh lump = blob({0.7F * h, w, 0.55F * h}, 0.22F, 6, dice_, 40);
      add(moved(turned(std::move(lump), kZ, std::atan2(u.y, u.x)), from + t * u + Vec3{0, 0, 0.5F * h}),
          look);
    }
  }

  /// Trimmed hedges along a way, which begin and end in view.
  void hedges(float border, float way) {
    if (std::abs(border - way) < 1.2F) return;
    const float h = draw(dice_, 0.6, 2.4), w = draw(dice_, 0.4, 1), rough = draw(dice_, 0.005, 0.05),
                y = way + draw(dice_, 0.55, 0.95) * (border - way);
    const Look look = leaves();
    float x = draw(dice_, 0.5, 6);
    for (int k = dice_.between(1, 3); k > 0; --k) {
      const float l = draw(dice_, 1.5, 9);
      const auto parts = [](float side) { return std::max(static_cast<int>(8 * side), 2); };
      Mesh mesh = warped(slab({l, w, h}, parts(l), parts(w), parts(h)), [&](Vec3 p) {
        return p + rough * Vec3{draw(dice_, -1, 1), draw(dice_, -1, 1), p.z > 0.01F ? draw(dice_, -1, 1) : 0};
      });
      settle(mesh);
      add(moved(std::move(mesh), {x + l / 2, y, 0}), look);
      x += l + draw(dice_, 0.8, 4);
    }
  }

  void fence(Vec3 from, Vec3 along) {
    const float h = draw(dice_, 0.8, 1.9), l = length(along), w = draw(dice_, 0.06, 0.16),
                gap = w * draw(dice_, 0.02, 1.2);
    const Vec3 u = unit(along);
    const Look paint = look_of_thing();
    for (float t = 0; t + w < l; t += w + gap)
      add(beam(from + t * u, from + t * u + Vec3{0, 0, h}, 0.02F, w), paint);
    for (const float z : {0.25F * h, 0.8F * h})
      add(beam(from + Vec3{0, 0, z}, from + along + Vec3{0, 0, z}, 0.04F, 0.08F), paint);
  }

  [[nodiscard]] float height_of_ground(Vec2 at) const {
    float height = 0;
    for (const Raised& part : world_.raised) {
      if ((at.x - part.edge.x) * part.inward.x + (at.y - part.edge.y) * part.inward.y > 0)
        height = std::max(height, part.height_m);
    }
    return height;
  }

  /// A kerb across the robot's way, up or down, perhaps with stones along it.
  void kerb_ahead(Dice dice) {
    const bool is_down = dice.chance(0.4);
    const float height = draw(dice, 0.04, 0.2), away = draw(dice, 0.9, 5), turn = draw(dice, -0.6, 0.6);
    const Vec3 ahead = polar(is_down ? -1.0F : 1.0F, turn), edge{away, 0, 0};
    constexpr float kWide = 90, kDeep = 70;
    Mesh slab = moved(turned(box({kDeep, kWide, height + 0.3F}), kZ, turn),
                      edge + kDeep / 2 * ahead + Vec3{0, 0, -0.3F});
    add(std::move(slab), ground_look(dice)).is_ground = true;
    if (dice.chance(0.6)) {
      const float stone = draw(dice, 0.08, 0.3), gap = 0.01F, long_ = draw(dice, 0.4, 1.2);
      const Look look = wall_look(dice);
      const Vec3 along{-ahead.y, ahead.x, 0};
      for (float t = -12; t < 12; t += long_ + gap) {
        add(moved(turned(box({stone, long_, height + 0.004F}, 0.01F), kZ, turn),
                  edge + stone / 2 * ahead + t * along),
            look)
            .is_ground = true;
      }
    }
    world_.raised.push_back({{edge.x, edge.y}, {ahead.x, ahead.y}, height});
  }

  /// Cars that are parked behind or beside each other, on one side of the way or on both.
  void parked_cars(float left, float right) {
    const auto car = std::ranges::find(families(), std::string_view("car"), &Family::name);
    const float way = world_.scene.rig.eye.y;
    for (const float border : {left, right}) {
      if (std::abs(border - way) < 3.5F || dice_.chance(0.3)) continue;
      const bool is_across = std::abs(border - way) > 6 && dice_.chance(0.4);
      const float room = draw(dice_, 0.4, 1.6),
                  y = border - std::copysign(is_across ? 2.6F : 1.2F, border - way);
      float x = draw(dice_, 1, 7);
      for (int k = dice_.between(2, 8); k > 0; --k) {
        Dice own = dice_.fork(0xCA4);
        Made made{car->make(own), {}, "car"};
        resize(made.mesh, draw(dice_, 3.4, 4.8));
        paint(made);
        const auto [low, high] = bounds(made.mesh);
        const float reach = is_across ? high.y - low.y : high.x - low.x;
        const float yaw =
            (is_across ? kPi / 2 : 0) + (dice_.chance(0.5) ? kPi : 0) + draw(dice_, -0.04, 0.04);
        x += reach / 2;
        put(made, {x, y + draw(dice_, -0.15, 0.15)}, yaw, 0, 0.05F, "row");
        x += reach / 2 + room * draw(dice_, 0.6, 1.4) + (dice_.chance(0.15) ? 5.0F : 0.0F);
      }
    }
  }

  /// Doors of garages, or gates, in a row.
  void gates(Vec3 from, Vec3 along, float height, Dice dice) {
    const Vec3 u = unit(along), in{-u.y, u.x, 0};
    const float w = draw(dice, 2.2, 3), h = std::min(height, draw(dice, 1.9, 2.4)),
                gap = draw(dice, 0.1, 0.8);
    const Look look = random_look(dice);
    for (float t = draw(dice, 0.1, 4); t + w < length(along); t += w + gap)
      quad(from + t * u + 0.03F * in, w * u, {0, 0, h}, look);
  }

  void outdoors() {
    Scene& scene = world_.scene;
    const bool is_sunny = dice_.chance(0.55), is_dusk = dice_.chance(0.12);
    const float level = is_dusk ? 0.12F : 1;
    scene.sky_high = level * (is_sunny ? Vec3{0.35F, 0.55F, 1.0F} : Vec3{0.8F, 0.85F, 0.95F});
    scene.sky_low = level * Vec3{0.9F, 0.95F, 1.0F};
    scene.ambient = level * (is_sunny ? 0.35F : 0.8F) * Vec3{0.9F, 0.97F, 1.1F};
    scene.reach_m = draw(dice_, 1.5, 6);
    if (is_sunny) {
      const float turn = draw(dice_, 0, 2 * kPi), high = draw(dice_, 0.2, 1.2);
      scene.lamps.push_back({unit({std::cos(turn), std::sin(turn), std::tan(high)}), 0,
                             level * draw(dice_, 0.9, 1.6) * Vec3{1, 0.95F, 0.86F}});
    }
    const bool is_fit = options_.use == Use::fit;  // the yardstick is older than streets, and stays as it is
    Dice street = dice_.fork(0x57EE7);
    if (is_fit) small_share_ = 0.25;
    const Look look = marked(ground_look(dice_));
    floor_like_ = look;
    ground(look, dice_.chance(0.5) ? 0 : draw(dice_, 0.002, 0.02),
           dice_.chance(0.6) ? 0 : draw(dice_, -0.04, 0.06));
    const float left = draw(dice_, 1.5, 9), right = -draw(dice_, 1.5, 9), far = draw(dice_, 7, 40);
    const auto border = [&](Vec3 from, Vec3 along) {
      switch (dice_.below(5)) {
        case 0:
          hedge(from, along);
          break;
        case 1:
          fence(from, along);
          break;
        case 2:
          block(from + Vec3{0, -0.15F, 0}, from + along + Vec3{0.15F, 0.15F, draw(dice_, 0.5, 2.2)},
                wall_look(dice_));
          break;
        case 3: {
          const float height = draw(dice_, 3, 9);
          if (is_fit && street.chance(0.35)) {
            const float low = street.chance(0.5) ? draw(street, 2.3, 3) : height;
            block(from + Vec3{0, -0.15F, 0}, from + along + Vec3{0.15F, 0.15F, low}, wall_look(street));
            gates(from, along, low, street);
          } else {
            facade(from, along, height);
          }
          break;
        }
        default:
          break;  // open
      }
    };
    border({far, right, 0}, {0, left - right, 0});
    border({0, left, 0}, {far, draw(dice_, -0.1, 0.2) * far, 0});
    border({0, right, 0}, {far, draw(dice_, -0.2, 0.1) * far, 0});
    if (dice_.chance(0.5)) {  // a kerb with another ground behind it
      const float y = draw(dice_, 0.4, 0.9) * (dice_.chance(0.5) ? left : right),
                  step = draw(dice_, 0.04, 0.14);
      const float far_y = y > 0 ? 40.0F : -40.0F;
      block({-2, std::min(y, far_y), -0.3F}, {70, std::max(y, far_y), step}, ground_look(dice_)).is_ground =
          true;
      if (is_fit && is_level_) world_.raised.push_back({{0, y}, {0, y > 0 ? 1.0F : -1.0F}, step});
    }
    if (is_fit && is_level_ && street.chance(0.4)) kerb_ahead(street.fork(1));
    for (int k = dice_.below(7); k > 0; --k) {  // far trees are background
      Dice own = dice_.fork(0x7EE + static_cast<std::uint64_t>(k));
      const auto tree = std::ranges::find(families(), std::string_view("tree"), &Family::name);
      if (tree == families().end()) break;
      Mesh mesh = tree->make(own);
      resize(mesh, draw(dice_, 4, 9));
      const float x = far + draw(dice_, 3, 20);
      Look leaves;
      leaves.pattern = Pattern::noise;
      leaves.period = {0.2F, 0.2F};
      leaves.colours = {Vec3{0.06F, 0.14F, 0.04F}, Vec3{0.02F, 0.06F, 0.02F}, {}, {}};
      add(moved(std::move(mesh), {x, draw(dice_, -0.8, 0.8) * x, 0}), leaves);
    }
    const int kind = dice_.below(3);  // a small robot, a service robot, a vehicle
    const float eye = kind == 0   ? draw(dice_, 0.15, 0.5)
                      : kind == 1 ? draw(dice_, 0.5, 1.3)
                                  : draw(dice_, 1.1, 1.8);
    camera({0, draw(dice_, 0.3, 0.7) * left + 0.3F * right, eye}, draw(dice_, -0.25, 0.25),
           draw(dice_, -2, 6) + eye * draw(dice_, 2, 10), draw(dice_, 0.6, 1.9),
           kind == 2 ? draw(dice_, 0.2, 0.54) : static_cast<float>(dice_.log_uniform(0.07, 0.25)));
    Vec3& at = world_.scene.rig.eye;
    at.z += height_of_ground({at.x, at.y});
    nearest_ = 0.9F;
    if (is_fit && street.chance(0.3)) parked_cars(left, right);
    if (is_fit && street.chance(0.45)) houses(left, right, far);
    for (const float side : {left, right}) {
      if (is_fit && street.chance(0.2)) hedges(side, at.y);
    }
    Amount amount{dice_.chance(0.03) ? 0 : dice_.between(2, 9), 0, 0, 22, 0.15, 0.04, 0.12, 0.12};
    fill(0, amount);
  }

  // ---- sensor ----

  void sensor() {
    Sensor& sensor = world_.sensor;
    sensor.blur_px = draw(dice_, 0.3, 0.75);
    sensor.vignetting = dice_.chance(0.5) ? draw(dice_, 0, 0.35) : 0;
    sensor.shot_noise = static_cast<float>(dice_.log_uniform(0.0015, 0.008));
    sensor.read_noise = static_cast<float>(dice_.log_uniform(0.0004, 0.0025));
    sensor.gamma = draw(dice_, 1.8, 2.4);
    sensor.right_gain = 1 + (dice_.chance(0.4) ? draw(dice_, -0.06, 0.06) : draw(dice_, -0.015, 0.015));
    sensor.right_offset = dice_.chance(0.3) ? draw(dice_, -0.012, 0.012) : 0;
    sensor.is_grey = dice_.chance(0.15);
    if (dice_.chance(0.3))
      sensor.grey_weights = {draw(dice_, 0.2, 0.6), draw(dice_, 0.2, 0.6), draw(dice_, 0, 0.3)};
    sensor.exposure =
        static_cast<float>(dice_.log_uniform(0.1, 0.34));  // of the mean: frames.cpp divides by it
  }

  struct Upright {
    Vec2 from;
    Vec2 to;
    Vec2 inward;
  };

  World& world_;
  const WorldOptions& options_;
  Dice dice_;
  const std::vector<Model>& models_;
  std::vector<Standing> standing_;
  std::vector<Upright> walls_;
  Look floor_like_;
  bool may_show_photographs_ = false;
  float nearest_ = 0.3F;
  std::optional<Footprint> table_;
  bool is_level_ = true;       // the ground
  double small_share_ = 0.06;  // of the things that would be smaller than most
};

Dice dice_of(const WorldOptions& options, int index) {
  const std::uint64_t of_use = options.use == Use::fit ? 0 : 0xFEED;
  return Dice(options.seed ^ of_use << 32U).fork(static_cast<std::uint64_t>(index));
}

}  // namespace

World make_laboratory(int sequence, int frame) {
  World world;
  const WorldOptions options;
  const Dice dice = Dice(1962).fork(static_cast<std::uint64_t>(sequence));
  Builder(world, options, dice).laboratory(sequence, fraction(frame, kLaboratoryFrames));
  Dice noise = dice.fork(1000 + static_cast<std::uint64_t>(frame));
  world.scene.seed = noise.bits();
  return world;
}

Tour make_tour(const WorldOptions& options, int index) {
  Tour tour;
  const Dice dice = dice_of(options, index).fork(0x7042);
  Dice last = dice.fork(99);
  tour.world.scene.seed = last.bits();
  Builder(tour.world, options, dice).tour(tour);
  return tour;
}

World make_world(const WorldOptions& options, int index) {
  World world;
  const Dice dice = dice_of(options, index);
  Builder(world, options, dice).build();
  Dice last = dice.fork(99);
  world.scene.seed = last.bits();
  return world;
}

}  // namespace cairn::worlds
