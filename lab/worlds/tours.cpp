// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "lab/worlds/tours.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "lab/worlds/dice.hpp"
#include "lab/worlds/frames.hpp"
#include "lab/worlds/shapes.hpp"

namespace cairn::worlds {
namespace {

constexpr double kWheelError = 0.03;                         // of speed and turn rate
constexpr double kTurnNoise = 0.5 * std::numbers::pi / 180;  // rad/s
constexpr float kShakeRad = 0.001F, kShakeM = 0.001F;        // of the camera, from frame to frame

Vec3 about_z(Vec3 v, float angle) {
  const float c = std::cos(angle), s = std::sin(angle);
  return {c * v.x - s * v.y, s * v.x + c * v.y, v.z};
}

/// Moves a thing by its share of the way.
void carry(World& world, const Move& move, float share) {
  const Vec2 by{share * (move.to.x - move.from.x), share * (move.to.y - move.from.y)};
  for (Body& body : world.scene.bodies) {
    if (body.id != move.id) continue;
    Mesh mesh = moved(std::move(body.mesh), {-move.from.x, -move.from.y, 0});
    body.mesh =
        moved(turned(std::move(mesh), kZ, share * move.turned), {move.from.x + by.x, move.from.y + by.y, 0});
  }
  Vec3& centre = world.things.at(static_cast<std::size_t>(move.id - 1)).centre;
  centre = centre + Vec3{by.x, by.y, 0};
}

}  // namespace

World world_of(const Tour& tour, int frame) {
  World world = tour.world;
  for (const Move& move : tour.moves) {
    const int frames = move.last_frame - move.first_frame + 1;
    carry(world, move, std::clamp(fraction(frame - move.first_frame + 1, frames), 0.0F, 1.0F));
  }
  const PathPoint first = tour.path.at(static_cast<std::size_t>(tour.first_look - 1));
  const PathPoint now = tour.path.at(static_cast<std::size_t>(frame));
  Dice dice = Dice(world.scene.seed).fork(static_cast<std::uint64_t>(frame));
  world.scene.seed = dice.bits();
  Rig& rig = world.scene.rig;
  const float turn = now.heading - first.heading + kShakeRad * static_cast<float>(dice.normal());
  for (Vec3* const axis : {&rig.right, &rig.down, &rig.forward}) *axis = about_z(*axis, turn);
  rig.eye = {now.at.x, now.at.y, rig.eye.z + kShakeM * static_cast<float>(dice.normal())};
  return world;
}

void write_tour_files(const Tour& tour, const std::filesystem::path& folder) {
  std::ostringstream path, wheels;
  path.precision(9), wheels.precision(9);
  path << "frame,t_s,x_m,y_m,heading_rad\n";
  wheels << "frame,t_s,v_m_per_s,omega_rad_per_s\n";
  Dice dice(tour.world.scene.seed);
  for (std::size_t i = 0; i < tour.path.size(); ++i) {
    const PathPoint now = tour.path[i], before = tour.path[i > 0 ? i - 1 : 0];
    const double t = static_cast<double>(i) / kTourRateHz;
    path << i << ',' << t << ',' << now.at.x << ',' << now.at.y << ',' << now.heading << '\n';
    const double speed = kTourRateHz * std::hypot(now.at.x - before.at.x, now.at.y - before.at.y);
    const double turn = kTourRateHz * double{now.heading - before.heading};
    const double of_speed = dice.normal(), of_turn = dice.normal(), noise = i > 0 ? dice.normal() : 0;
    wheels << i << ',' << t << ',' << speed * (1 + kWheelError * of_speed) << ','
           << turn * (1 + kWheelError * of_turn) + kTurnNoise * noise << '\n';
  }
  write_text(folder / "trajectory.csv", path.str());
  write_text(folder / "odometry.csv", wheels.str());
  nlohmann::ordered_json list = nlohmann::json::array();
  for (const Move& move : tour.moves) {
    list.push_back({{"id", move.id},
                    {"what", move.what},
                    {"first_frame", move.first_frame},
                    {"last_frame", move.last_frame},
                    {"from_xy", {move.from.x, move.from.y}},
                    {"to_xy", {move.to.x, move.to.y}},
                    {"turned_rad", move.turned}});
  }
  const nlohmann::ordered_json events{
      {"rate_hz", kTourRateHz}, {"frames", tour.path.size()}, {"events", list}};
  write_text(folder / "events.json", events.dump(1) + "\n");
}

}  // namespace cairn::worlds
