// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/diagnosis/rig_watch.hpp>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace cairn::cli {

/// "broken", "warning", "note".
std::string name_of(Severity severity);

/// Whether any of them is broken.
bool is_broken(const std::vector<Finding>& findings);

/// ", in 2 of 40 pairs (a, b)"; "" for a single frame. `noun`: "pairs" or "frames".
std::string frames_text(const Finding& finding, const std::vector<std::string>& names, const char* noun);

/// A line for stderr per change of the findings of a run, with its remedy. `frame`: the name of the frame.
std::string changes_text(const std::string& frame, const std::vector<FindingChange>& changes);

/// Compares given disparities with the pairs: of the first frames and of every hundredth, and of all after a map that
/// was refused.
class GivenCheck {
 public:
  /// `right`: loads the right image, of the left one's size; called for the compared frames only. Throws Error, beginning with
  /// `name`, if the map is certainly none of these images; a finding if it is suspect.
  std::optional<Finding> check(View<const float> given_px, View<const Gray> left,
                               const std::function<Image<Gray>()>& right, const std::optional<StereoRig>& rig,
                               const std::string& name, const Exec& exec);

 private:
  int frames_ = 0;
  bool was_refused_ = false;
};

/// The findings of a folder run, reported once for all frames with them.
class PassingFindings {
 public:
  void add(const std::string& frame, std::vector<Finding> findings);
  /// Counts a doubtful frame that was not measured.
  void add_doubtful() { ++doubtful_; }
  /// Prints one line on stderr per finding, with its remedy.
  void tell() const;

 private:
  std::vector<std::string> names_;
  std::vector<std::vector<Finding>> of_frames_;
  int doubtful_ = 0;
};

}  // namespace cairn::cli
