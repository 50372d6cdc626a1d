// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <filesystem>
#include <string>

#include "lab/worlds/scene.hpp"

namespace cairn::worlds {

/// A world as a robot's cameras deliver it, with its truth.
struct WorldFrame {
  World world;
  Image<Rgb> left;
  Image<Rgb> right;
  Truth truth;
};

/// Renders and exposes a world, with `samples` rays per pixel.
WorldFrame make_frame(World world, int samples);

/// Writes left.png, right.png, disp_left.png, objects.png, occlusion.png, ground.png, calib.txt, pose.txt and scene.json,
/// as in a data set of frames (docs/formats.md); the folder appears whole. Throws Error if it cannot be written.
void write_frame(const WorldFrame& frame, const std::filesystem::path& folder);

/// Throws Error if the file cannot be written.
void write_text(const std::filesystem::path& file, const std::string& text);

}  // namespace cairn::worlds
