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

#include <cairn/sequence/pose.hpp>

#include <cairn/output/track_files.hpp>

/// The ground truth of a sequence. (docs/formats.md, "The truth of a sequence")
namespace cairn::input {

/// An object of a scene.json.
struct TruePlace {
  std::optional<Point3> visible_in_camera_m;  // centre of the visible part
  std::optional<Point3> in_world_m;           // centre of the object
};

struct TrueFrame {
  std::string name;
  bool is_partial = false;                // not every object is labelled
  std::optional<Pose> world_from_camera;  // of pose.txt
  std::map<std::int64_t, TruePlace> places;
  // One of the two:
  std::filesystem::path labels;            // objects.png
  std::vector<output::TrackRecord> masks;  // of a MOTS text
};

/// An entry of an events.json: a change that a person made to an object.
struct TrueEvent {
  std::int64_t id = 0;  // of the object
  bool is_in_view = false;
  std::int64_t first_frame = 0;
  std::int64_t last_frame = 0;
  std::optional<std::array<double, 2>> from_m;  // in the world, on the floor
  std::optional<std::array<double, 2>> to_m;
};

struct TrueSequence {
  std::vector<TrueFrame> frames;  // all frames, by name or number
  bool has_events = false;        // an events.json exists
  std::vector<TrueEvent> events;
  bool is_numbered = false;  // from a MOTS text: frames are known by number only
};

/// Reads a folder with a sub-folder per frame (objects.png, optionally pose.txt, scene.json, partial) and
/// optionally events.json, or a MOTS text. Throws Error (names the file) if there is no frame, or a file is
/// malformed.
TrueSequence load_truth(const std::filesystem::path& path);

/// The ids of a frame. Throws Error if the file cannot be read, or masks overlap or differ in size.
Image<TruthId> load_true_labels(const TrueFrame& frame);

}  // namespace cairn::input
