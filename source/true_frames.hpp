// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/evaluation/object_error.hpp>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "../tracking/pose.hpp"

#include "track_files.hpp"

/// The truth of a sequence. (docs/formats.md, "The truth of a sequence")
namespace cairn::io {

/// An object of a scene.json.
struct TruePlace {
  std::optional<Point3> visible_in_camera_m;  // centre of what is seen of it
  std::optional<Point3> in_world_m;           // its own centre
};

struct TrueFrame {
  std::string name;
  bool is_partial = false;                // not every object is labelled
  std::optional<Pose> world_from_camera;  // of pose.txt
  std::map<std::int64_t, TruePlace> places;
  // One of the two:
  std::filesystem::path labels;    // objects.png
  std::vector<TrackRecord> masks;  // of a MOTS text
};

/// Of an events.json: what somebody did to an object.
struct TrueEvent {
  std::int64_t id = 0;  // the object's
  bool is_in_view = false;
  std::int64_t first_frame = 0;
  std::int64_t last_frame = 0;
  std::optional<std::array<double, 2>> from_m;  // in the world, on the floor
  std::optional<std::array<double, 2>> to_m;
};

struct TrueSequence {
  std::vector<TrueFrame> frames;  // all that there are, by name or number
  bool has_events = false;        // an events.json was there
  std::vector<TrueEvent> events;
  bool is_numbered = false;  // of a MOTS text: frames are known by their number alone
};

/// A folder with a sub-folder for each frame (objects.png, and perhaps pose.txt, scene.json, partial) and
/// perhaps events.json, or a MOTS text. Throws Error (names the file) where there is no frame, or a file is
/// malformed.
TrueSequence load_truth(const std::filesystem::path& path);

/// The ids of a frame. Throws Error where the file cannot be read, or masks overlap or differ in size.
Image<TruthId> load_true_labels(const TrueFrame& frame);

}  // namespace cairn::io
