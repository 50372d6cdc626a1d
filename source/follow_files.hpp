// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "../landmarks/landmarks.hpp"
#include "../tracking/follower.hpp"

namespace cairn::io {

/// A frame of tracks.jsonl (docs/formats.md): one line of JSON, with the newline.
std::string step_json(const Step& step, const std::string& name, const Landmarked& marked = {});

/// A frame of poses.tum: "t x y z qx qy qz qw", t in s; empty where the pose is not known.
std::string pose_tum(const Step& step);

/// A frame's masks in the text form of MOTS (Voigtlaender et al. 2019), a line each: "frame id class height
/// width rle".
std::string masks_mots(const Step& step);

/// The left picture with every tracked object tinted, outlined and labelled with its track's id and distance.
Image<Rgb> draw_tracks(View<const Gray> left, View<const Rgb> left_rgb, const Step& step);

/// The files of a sequence in a folder. What is text grows by whole lines and is valid up to the last one at
/// any time; an older result of these names is replaced when the first frame comes.
class FollowFiles {
 public:
  /// Throws Error (names the folder) where it cannot be made or written to.
  explicit FollowFiles(std::filesystem::path folder);

  /// Throws Error (names the file) where it cannot be written.
  void add(const Step& step, const std::string& name, const Landmarked& marked = {});
  /// A line of events.jsonl, with the newline.
  void add_event(const std::string& line);

 private:
  void append(std::ofstream& file, const char* name, const std::string& text);

  std::filesystem::path folder_;
  std::ofstream tracks_, poses_, masks_, events_;
};

}  // namespace cairn::io
