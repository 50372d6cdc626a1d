// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/diagnosis/diagnose.hpp>
#include <optional>
#include <set>
#include <vector>

/// The rig of a run, judged while it runs.
namespace cairn {

struct FrameFindings {
  std::vector<Finding> list;
  bool is_doubtful = false;
};
/// The findings of a frame by its results. If these are doubtful and `may_measure`, also by its images, which takes
/// about as long as segmenting them. `right` is empty if the disparity was given.
FrameFindings judge(const Frame& frame, View<const Gray> left, View<const Gray> right,
                    const std::optional<StereoRig>& rig, const Config& config, bool may_measure,
                    const Exec& exec);

/// A finding that a run has from now on, or no longer.
struct FindingChange {
  Finding finding;
  bool is_gone = false;
};

/// Judges the first frames of a run and then every hundredth; if that one is judged differently, the next ones, too.
/// A finding holds if half of these frames have it.
class RigWatch {
 public:
  static constexpr int kFrames = 5;   // judged together
  static constexpr int kEvery = 100;  // frames

  /// To be called with every frame; most calls do nothing. Returns what has changed: new and worse findings, and
  /// those that are gone. Notes are reported once. `given_px`: external disparities, which are compared with the pair
  /// if there is a right image.
  std::vector<FindingChange> next(const Frame& frame, View<const Gray> left, View<const Gray> right,
                                  const std::optional<StereoRig>& rig, const Config& config, const Exec& exec,
                                  View<const float> given_px = {});
  /// The same without segmentation: by the pair, or, with given disparities, by how they fit the pair. `right` may be
  /// empty only with them; then nothing is compared.
  std::vector<FindingChange> next(View<const Gray> left, View<const Gray> right,
                                  const std::optional<StereoRig>& rig, const MatchConfig& range,
                                  const Exec& exec, View<const float> given_px = {});
  /// The findings that hold now.
  [[nodiscard]] const std::vector<Finding>& findings() const { return findings_; }

 private:
  bool is_due();
  std::vector<FindingChange> add(std::vector<Finding> of_frame, bool has_metres);
  std::vector<FindingChange> settle();

  int frames_ = 0;        // since the last series of judged frames began
  bool is_first_ = true;  // of these series
  std::vector<std::vector<Finding>> series_;
  std::vector<Finding> findings_;
  std::set<FindingKind> noted_;
};

}  // namespace cairn
