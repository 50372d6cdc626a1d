// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/evaluation/object_error.hpp>
#include <filesystem>
#include <map>
#include <optional>
#include <source/track_files.hpp>
#include <source/true_frames.hpp>
#include <string>
#include <tracking/track_error.hpp>
#include <tracking/trajectory_error.hpp>
#include <vector>

/// What `cairn evaluate --sequence` says of a result. (docs/evaluation.md, "Sequences")
namespace cairn::cli {

struct SequenceOptions {
  int min_area = 200;      // px; smaller true objects are neither right nor wrong
  bool tentative = false;  // tracks that are not confirmed yet count, too
};

/// Errors in m, and how many of them lie in the ellipsoid that holds 95 % by what is stated.
struct PlaceErrors {
  std::vector<double> in_map_m;     // both trajectories laid together at the first frame that has both poses
  std::vector<double> in_camera_m;  // without what the camera's own place is off
  int stated = 0;                   // of the first, those with a covariance
  int inside = 0;
};

struct MovingErrors {
  /// By true object that moves in view: frames from the first in which it does so and counts until its track
  /// is labelled; none: never while it moved.
  std::map<std::int64_t, std::optional<std::int64_t>> frames_to_detect;
  int moving = 0;          // track-frames of what moves
  int labelled = 0;        // of these
  int at_rest = 0;         // of what does not, nor did in the 8 frames before
  int labelled_wrong = 0;  // of these
  bool is_known = false;   // the truth says what moves
};

struct LandmarkErrors {
  int again =
      0;  // true objects with a landmark, out of view for 10 frames or more, then in view for 10 or more
  int re_identified = 0;
  int wrong = 0;          // have another object's landmark
  bool is_known = false;  // the result has landmarks
};

struct ChangeErrors {
  int expected = 0;  // objects that were carried elsewhere while out of view
  int found = 0;
  int reported = 0;  // moved, gone, new; those of objects that moved in view count nowhere
  int wrong = 0;
  std::vector<double> errors_m;  // of the way on the floor, of those found
  bool is_known = false;
};

struct SequenceScores {
  std::string name;
  int frames = 0;
  bool is_cut_off = false;
  std::vector<std::string> without_truth;
  std::vector<std::string> without_result;
  std::vector<ScoredFrame> scored;
  TrackErrors tracks;
  TrackErrors oracle;
  Steadiness steadiness;
  ObjectSummary objects;
  PlaceErrors places;
  MovingErrors moving;
  LandmarkErrors landmarks;
  ChangeErrors changes;
  std::optional<TrajectoryError> trajectory;
};

/// `result`: a folder of `cairn follow`, its tracks.jsonl, or a MOTS text. Throws Error.
SequenceScores score_sequence(const std::filesystem::path& result, const io::TrueSequence& truth,
                              const SequenceOptions& options);

}  // namespace cairn::cli
