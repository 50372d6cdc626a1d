// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "../io/atomic_file.hpp"
#include "../landmarks/landmarks.hpp"
#include "../page/html_page.hpp"
#include "../tracking/follower.hpp"

/// The player: a sequence's tracks as one page for the browser, which needs nothing but itself. Layout, style
/// and script are page/follow.html and what lies beside it. (docs/looking_at_results.md, "The player")
namespace cairn::io {

/// A step as text. `facts`: its line of tracks.jsonl without the masks, and where a track's name is drawn;
/// `maps`: the left picture as JPEG, and for each pixel 0 or 1 + the place in `facts`' list of the track that
/// it belongs to, without loss. `milliseconds`: what the frame took; none is left out.
EncodedFrame encode_step(const Step& step, const std::string& name, View<const Gray> left,
                         View<const Rgb> left_rgb, std::optional<double> milliseconds = std::nullopt,
                         const Landmarked& marked = {});

struct FollowPageHead {
  std::string title;  // the source
  Size image;
  std::optional<StereoRig> rig;  // none: no metres, no view from above
};

/// A page that grows with the sequence: what is added goes to a temporary file, so that memory does not grow.
class FollowPage {
 public:
  /// Throws Error (names the file) where it cannot be written.
  FollowPage(const std::filesystem::path& file, FollowPageHead head);

  /// The next frame. Throws Error as the constructor does.
  void add(const EncodedFrame& step);
  /// A line of events.jsonl, of any frame.
  void add_event(const std::string& line);
  /// The page takes its name, whole, with the landmarks as they are at the end. Without this call no page is
  /// left, and one that is there stays. Throws Error as the constructor does.
  void finish(const LandmarkMap& map = {});

 private:
  FollowPageHead head_;
  std::string end_;     // of the page
  std::string events_;  // JSON for the page, separated by commas
  int frames_ = 0;
  GrowingFile file_;
};

}  // namespace cairn::io
