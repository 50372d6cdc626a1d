// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include <cairn/sequence/follower.hpp>
#include <cairn/sequence/landmarks.hpp>

namespace cairn::output {

/// A frame of tracks.jsonl (docs/formats.md): one line of JSON, with the newline.
std::string step_json(const TrackedFrame& step, const std::string& name, const LandmarkUpdate& marked = {},
                      const std::string& frame_id = {});

/// Whether the frame is the one at which a run of weak frames is reported, in events.jsonl.
bool becomes_unreliable(const TrackedFrame& step);

/// A line of poses.tum: "t x y z qx qy qz qw", t in s; empty if the pose is unknown.
std::string pose_tum(const TrackedFrame& step);

/// The masks of a frame in the text form of MOTS (Voigtlaender et al. 2019), one line each: "frame id class
/// height width rle".
std::string masks_mots(const TrackedFrame& step);

/// The left image with every tracked object tinted, outlined and labelled with track id and distance.
Image<Rgb> draw_tracks(View<const Gray> left, View<const Rgb> left_rgb, const TrackedFrame& step);

/// The output files of a sequence in a folder. Text files grow by whole lines and are valid at any time;
/// older results are replaced when the first frame arrives.
class FollowFiles {
 public:
  /// Throws Error (names the folder) if it cannot be created or written.
  explicit FollowFiles(std::filesystem::path folder);

  /// `line`: the frame's step_json(). Throws Error (names the file) if it cannot be written.
  void add(const TrackedFrame& step, const std::string& line);
  /// A line of events.jsonl, with the newline.
  void add_event(const std::string& line);

 private:
  void append(std::ofstream& file, const char* name, const std::string& text);

  std::filesystem::path folder_;
  std::ofstream tracks_, poses_, masks_, events_;
};

}  // namespace cairn::output
