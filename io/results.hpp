// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/pipeline/segment.hpp>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace cairn::io {

struct StageTime {
  std::string stage;  // as the observer names it
  double milliseconds = 0;
};

/// How a frame came about: what its result says beside what was found.
struct Provenance {
  std::string preset;
  Config config;
  std::optional<StereoRig> rig;
  std::vector<StageTime> timings;
  bool external_disparity = false;  // the disparity was given, not matched
};

/// Every option that `config` reads by section, as a JSON object.
std::string config_json(const Config& config);

/// The form of objects.json: a reader of 1.x may rely on all that docs/schema/objects.schema.json says
/// of 1.0; the number behind the dot grows with what is added.
inline constexpr const char* kObjectsSchema = "1.1";

/// The content of objects.json (docs/formats.md). Ends with a newline.
std::string objects_json(const Frame& frame, const Provenance& provenance);

/// A frame as one line among those of a run (docs/batch.md), without a newline: its name, its stamp where it
/// has one, and of objects.json all but what is one for the whole run (version, preset, options) and the
/// times, so that the line depends on nothing but images, calibration and options.
std::string frame_row(const std::string& name, std::optional<std::int64_t> stamp_ns, const Frame& frame,
                      const Provenance& provenance);

/// A result's disparity file: "disparity.png", or "disparity.pfm" where 16 bits cannot hold the search range
/// (of a given disparity: its values).
std::string disparity_file_name(const Frame& frame, const Provenance& provenance);

/// Writes how likely each disparity is right (0 … 1) as 8-bit PNG: round(255·confidence).
void save_confidence(const std::filesystem::path& path, View<const float> confidence);

/// What a result holds on request.
struct Extras {
  bool point_cloud = false;  // cloud.ply, see save_ply(); needs provenance.rig
  bool depth = false;        // depth.png (16 bits, mm) and depth.npy (m); needs provenance.rig
  bool grid = false;         // grid.pgm, grid.yaml: the obstacles as a map of ROS; needs a ground, too
};

/// Writes the files that docs/formats.md lists for a frame's result, each where the frame has what it shows,
/// whole or not at all: everything is written under a temporary name first. An older result in `folder` is
/// replaced, files of it that the new one has not are removed, foreign files stay. `left_rgb` may be empty.
/// Throws Error (names the folder).
void write_result(const std::filesystem::path& folder, View<const Gray> left, View<const Rgb> left_rgb,
                  const Frame& frame, const Provenance& provenance, Extras extras = {});

/// What `cairn evaluate` needs of an objects.json. Throws Error where the file is none.
struct ObjectConfidence {
  ObjectId id = ObjectId::none;
  double confidence = 0;
};
std::vector<ObjectConfidence> load_confidences(const std::filesystem::path& path);

}  // namespace cairn::io
