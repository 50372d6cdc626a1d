// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/evaluation/object_error.hpp>
#include <cairn/input/true_frames.hpp>
#include <cairn/output/track_files.hpp>
#include <cairn/sequence/track_error.hpp>
#include <cairn/sequence/trajectory_error.hpp>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

/// The scores of a followed sequence against its truth. (docs/evaluation.md, "Sequences")
namespace cairn::input {

struct ScoreOptions {
  int min_area = 200;      // px; smaller true objects are ignored
  bool tentative = false;  // unconfirmed tracks count too
};

/// Errors in m, and the number of errors within the stated 95 % ellipsoid.
struct PlaceErrors {
  std::vector<double> in_map_m;     // with the trajectories aligned at the first common frame
  std::vector<double> in_camera_m;  // without the error of the camera pose
  int stated = 0;                   // of in_map_m, those with a covariance
  int inside = 0;
  std::vector<double> normalised;  // squared errors of these, eᵀ·C⁻¹·e
};

struct MovingErrors {
  /// Per true object that moves in view: frames from its first moving frame until its track is labelled so;
  /// nullopt: never while it moved.
  std::map<std::int64_t, std::optional<std::int64_t>> frames_to_detect;
  int moving = 0;          // track-frames of moving objects
  int labelled = 0;        // of these
  int at_rest = 0;         // track-frames of objects at rest for 8 frames
  int labelled_wrong = 0;  // of these
  bool is_known = false;   // the truth has motion labels
};

struct LandmarkErrors {
  int again = 0;  // true objects with a landmark, in view for 10 frames again after 10 out of view
  int re_identified = 0;
  int wrong = 0;          // with the landmark of another object
  bool is_known = false;  // the result has landmarks
};

struct ChangeErrors {
  int expected = 0;  // objects relocated while out of view
  int found = 0;
  int reported = 0;  // moved, gone, new; excludes objects that moved in view
  int wrong = 0;
  std::vector<double> errors_m;  // of the displacement on the floor, for those found
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
  /// Tracks with the same last landmark share an id, unless they are seen together: what is known at the end,
  /// since a moved object is recognised once its old place has been seen empty. nullopt without landmarks.
  std::optional<TrackErrors> by_landmark;
  TrackErrors oracle;
  Steadiness steadiness;
  ObjectSummary objects;
  PlaceErrors places;
  MovingErrors moving;
  LandmarkErrors landmarks;
  ChangeErrors changes;
  std::optional<TrajectoryError> trajectory;
};

/// `path`: a folder from `cairn follow`, its tracks.jsonl, or a MOTS text. Throws Error.
SequenceScores score_sequence(const std::filesystem::path& path, const TrueSequence& truth,
                              const ScoreOptions& options);

}  // namespace cairn::input
