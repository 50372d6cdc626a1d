// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lab/worlds/scene.hpp"

namespace cairn::worlds {

inline constexpr int kTourRateHz = 5;

/// Where the robot is in a frame: metres, radians from the x axis to the left.
struct PathPoint {
  Vec2 at;
  float heading = 0;
};

/// A thing that is elsewhere from some frame on; in between it moves evenly.
struct Move {
  int id = 0;
  std::string what;  // "moves in view", "carried away while out of view"
  int first_frame = 0;
  int last_frame = 0;
  Vec2 from;
  Vec2 to;
  float turned = 0;  // rad, about its centre
};

/// A robot's drive: it looks at a group of things and comes closer, turns away, drives on along an arc around them, and
/// looks again from there. Meanwhile somebody carried one of them elsewhere, in most tours.
struct Tour {
  World world;  // as it is at first, seen at the end of the first look
  std::vector<PathPoint> path;
  int first_look = 0;  // frames
  std::vector<Move> moves;
};

/// Tour number `index`: depends on the options and the index only. Whatever is carried is seen (at least 250 px of 320×240) in the
/// last frame of the first look and in that of the second, and so would be what had stayed at its old place.
Tour make_tour(const WorldOptions& options, int index);

/// The world as the robot sees it in a frame.
World world_of(const Tour& tour, int frame);

/// Writes trajectory.csv, odometry.csv (as wheels with an error of 3 % and 0.5°/s would report it) and events.json, the
/// truth of a sequence (docs/formats.md), next to the folders of the frames. Throws Error if it cannot.
void write_tour_files(const Tour& tour, const std::filesystem::path& folder);

}  // namespace cairn::worlds
