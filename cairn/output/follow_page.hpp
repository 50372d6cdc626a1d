// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <cairn/io/atomic_file.hpp>
#include <cairn/output/web/html_page.hpp>
#include <cairn/sequence/follower.hpp>
#include <cairn/sequence/landmarks.hpp>

/// The player: the tracks of a sequence as one self-contained page for the browser. Layout, style and script
/// are cairn/output/web/follow.html and the files next to it. (docs/looking_at_results.md, "The player")
namespace cairn::output {

/// A step as text. `facts`: its line of tracks.jsonl without masks, and the label position of each track;
/// `maps`: the left image as JPEG, and for each pixel 0 or 1 + the index of its track in the list of `facts`,
/// lossless. `milliseconds`: the time of the frame.
EncodedFrame encode_step(const TrackedFrame& step, const std::string& name, View<const Gray> left,
                         View<const Rgb> left_rgb, std::optional<double> milliseconds = std::nullopt,
                         const LandmarkUpdate& marked = {});

struct FollowPageHead {
  std::string title;  // the source
  Size image;
  std::optional<StereoRig> rig;  // nullopt: no metres, no top view
};

/// A page that grows with the sequence: data goes to a temporary file, so memory does not grow.
class FollowPage {
 public:
  /// Throws Error (names the file) if it cannot be written.
  FollowPage(const std::filesystem::path& file, FollowPageHead head);

  /// The next frame. Throws Error like the constructor.
  void add(const EncodedFrame& step);
  /// A line of events.jsonl, of any frame.
  void add_event(const std::string& line);
  /// Writes the page under its final name, with the final landmarks. Without this call no page is written,
  /// and an existing one stays. Throws Error like the constructor.
  void finish(const LandmarkMap& map = {});

 private:
  FollowPageHead head_;
  std::string end_;     // of the page
  std::string events_;  // JSON for the page, separated by commas
  int frames_ = 0;
  io::GrowingFile file_;
};

}  // namespace cairn::output
