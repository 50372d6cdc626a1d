// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/pipeline/segment.hpp>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace cairn::output {

struct StageTime {
  std::string stage;  // as the observer names it
  double milliseconds = 0;
};

/// The origin of a frame, as recorded in its result.
struct Provenance {
  std::string preset;
  Config config;
  std::optional<StereoRig> rig;
  std::vector<StageTime> timings;
  bool external_disparity = false;  // the disparity was given, not matched
  std::optional<std::int64_t> stamp_ns = {};
};

/// The version of objects.json: a reader of 1.x may rely on everything in docs/schema/objects.schema.json for
/// 1.0; additions increase the number after the dot.
inline constexpr const char* kObjectsSchema = "2.1";

/// The content of objects.json (docs/formats.md). Ends with a newline.
std::string objects_json(const Frame& frame, const Provenance& provenance);

/// The image overlay.png: draw_objects(), with the steps of the ground. `left_rgb` may be empty.
Image<Rgb> draw_frame(View<const Gray> left, View<const Rgb> left_rgb, const Frame& frame,
                      const Provenance& provenance);

/// A frame as one line of a run (docs/batch.md), without a newline: its name, its stamp if it has one, and
/// objects.json except for what is common to the run (version, preset, options) and the times, so that the
/// line depends on images, calibration and options only.
std::string frame_row(const std::string& name, const Frame& frame, const Provenance& provenance);

/// The disparity file of a result: "disparity.png", or "disparity.pfm" if 16 bits cannot hold the search
/// range (for a given disparity: its values).
std::string disparity_file_name(const Frame& frame, const Provenance& provenance);

/// Writes confidences (0 … 1) as 8-bit PNG: round(255·confidence).
void save_confidence(const std::filesystem::path& path, View<const float> confidence);

/// Optional files of a result.
struct Extras {
  bool point_cloud = false;    // cloud.ply, see save_ply(); needs provenance.rig
  bool object_clouds = false;  // objects/1.ply and so on, see save_object_plys(); needs provenance.rig
  bool depth = false;          // depth.png (16 bits, mm) and depth.npy (m); needs provenance.rig
  bool grid = false;           // grid.pgm, grid.yaml: the obstacles as a ROS map; also needs a ground
};

/// Atomically writes the files of a frame's result as listed in docs/formats.md, as far as the frame has the
/// data: everything is written under a temporary name first. Replaces an older result in `folder`, including
/// files that the new one lacks; other files stay. `left_rgb` may be empty. Throws Error (names the folder).
void write_result(const std::filesystem::path& folder, View<const Gray> left, View<const Rgb> left_rgb,
                  const Frame& frame, const Provenance& provenance, Extras extras = {});

/// Removes the files of a result in `folder`, and the folder if nothing else is in it. Nothing happens if it has no
/// objects.json.
void remove_result(const std::filesystem::path& folder);

/// The data that `cairn evaluate` needs from an objects.json. Throws Error if the file is not one.
struct ObjectConfidence {
  ObjectId id = ObjectId::none;
  double confidence = 0;
};
std::vector<ObjectConfidence> load_confidences(const std::filesystem::path& path);

}  // namespace cairn::output
