// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/image.hpp>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <cairn/io/rle.hpp>
#include <cairn/sequence/pose.hpp>
#include <cairn/sequence/tracks.hpp>

/// Reading of the output of `cairn follow`. (docs/formats.md, "A sequence's result out")
namespace cairn::output {

/// A track in one frame of a tracks.jsonl.
struct TrackRecord {
  TrackId id = TrackId::none;
  TrackState state = TrackState::confirmed;
  bool is_moving = false;
  std::optional<Point3> position_m;  // in the map; nullopt without a rig
  std::optional<Covariance3> covariance_m2;
  std::optional<std::int64_t> landmark;
  std::optional<io::Rle> mask;  // if detected in this frame
  bool is_dont_care = false;    // class 10 of MOTS: neither right nor wrong
};

struct TrackFrame {
  std::size_t line = 0;  // in the file, from 1
  std::int64_t index = 0;
  std::string name;
  Stamp stamp;
  std::optional<Pose> map_from_camera;  // nullopt if the pose is unknown
  std::string refusal;                  // of the motion: "none", "few_points", …
  std::vector<TrackRecord> tracks;      // ids are unique
};

struct TrackFile {
  std::vector<TrackFrame> frames;  // index and stamp ascend, names are unique
  bool is_cut_off = false;         // the last line was incomplete, and was skipped
};

/// Throws Error (names file and line) if a line is malformed, a number is not finite, not an integer or out
/// of range, or frames, names or ids are repeated. Unknown keys are ignored.
TrackFile load_tracks(const std::filesystem::path& path);

/// Masks in the text form of MOTS (Voigtlaender et al. 2019), one line each: "frame id class height width
/// rle". One frame per number up to the last, named by it; frames without a line are empty. Stamps and poses
/// are unknown.
TrackFile load_mots(const std::filesystem::path& path);

/// A line of events.jsonl.
struct ChangeRecord {
  std::int64_t frame = 0;
  std::string kind;  // moved, gone, new, back, relocated
  std::optional<std::int64_t> landmark;
  std::optional<TrackId> track;
  std::optional<Point3> from_m;
  std::optional<Point3> to_m;
};
/// Like load_tracks(). A missing file has no events.
std::vector<ChangeRecord> load_changes(const std::filesystem::path& path);

/// The masks of a frame as one label image of this size. Throws Error (begins with `where`) if a mask has
/// another size, is malformed, or overlaps another.
Image<TrackId> track_labels(const std::vector<TrackRecord>& tracks, Size size, const std::string& where);

}  // namespace cairn::output
