// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/diagnosis/given_disparity.hpp>
#include <cairn/diagnosis/rig_watch.hpp>
#include <utility>

namespace cairn {
namespace {

const Finding* find(const std::vector<Finding>& findings, FindingKind kind) {
  const auto found = std::find_if(findings.begin(), findings.end(),
                                  [kind](const Finding& finding) { return finding.kind == kind; });
  return found == findings.end() ? nullptr : &*found;
}

/// Of the same kinds and severities.
bool are_same(const std::vector<Finding>& a, const std::vector<Finding>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Finding& one, const Finding& other) {
    return one.kind == other.kind && one.severity == other.severity;
  });
}

/// Adds what the given disparities do not have in common with the pair, if there is a right image.
void add_given(std::vector<Finding>& found, View<const float> given_px, View<const Gray> left,
               View<const Gray> right, const std::optional<StereoRig>& rig, const Exec& exec) {
  if (right.empty()) return;
  if (auto of_map = check_given_disparity(given_px, StereoPair::from(left, right), rig, exec))
    found.push_back(std::move(*of_map));
}

}  // namespace

FrameFindings judge(const Frame& frame, View<const Gray> left, View<const Gray> right,
                    const std::optional<StereoRig>& rig, const Config& config, bool may_measure,
                    const Exec& exec) {
  const DiagnosisConfig limits;
  FrameFindings found{diagnose(frame, left, right, rig, config, limits),
                      !right.empty() && is_doubtful(frame)};
  if (found.is_doubtful && may_measure) {
    const PairMeasures measures = measure_pair(StereoPair::from(left, right), exec);
    found.list = united({diagnose(measures, rig, config.match, limits), found.list});
  }
  return found;
}

std::vector<FindingChange> RigWatch::next(const Frame& frame, View<const Gray> left, View<const Gray> right,
                                          const std::optional<StereoRig>& rig, const Config& config,
                                          const Exec& exec, View<const float> given_px) {
  if (!is_due()) return {};
  const bool is_given = !given_px.empty();
  std::vector<Finding> found =
      judge(frame, left, is_given ? View<const Gray>{} : right, rig, config, true, exec).list;
  if (is_given) add_given(found, given_px, left, right, rig, exec);
  return add(std::move(found), rig.has_value());
}

std::vector<FindingChange> RigWatch::next(View<const Gray> left, View<const Gray> right,
                                          const std::optional<StereoRig>& rig, const MatchConfig& range,
                                          const Exec& exec, View<const float> given_px) {
  if (!is_due()) return {};
  std::vector<Finding> found;
  if (given_px.empty()) {
    found = diagnose(measure_pair(StereoPair::from(left, right), exec), rig, range, {});
  } else {
    add_given(found, given_px, left, right, rig, exec);
  }
  return add(std::move(found), rig.has_value());
}

bool RigWatch::is_due() {
  const bool begins = series_.empty() && (is_first_ || frames_ >= kEvery);
  if (begins) frames_ = 0;
  ++frames_;
  return begins || !series_.empty();
}

std::vector<FindingChange> RigWatch::add(std::vector<Finding> of_frame, bool has_metres) {
  if (!has_metres) {
    of_frame.push_back({FindingKind::no_metres, Severity::note, 0,
                        "the source has no calibration with a baseline: no distances, and no motion"});
    of_frame = united({of_frame});
  }
  series_.push_back(std::move(of_frame));
  const bool is_whole = series_.size() == kFrames;
  std::vector<FindingChange> changes;
  if (is_first_ || is_whole) changes = settle();
  if (is_whole || (!is_first_ && series_.size() == 1 && are_same(series_.front(), findings_))) {
    series_.clear();
    is_first_ = false;
  }
  return changes;
}

std::vector<FindingChange> RigWatch::settle() {
  std::vector<Finding> now = united(series_);
  std::erase_if(now, [&](const Finding& finding) { return 2 * finding.frames.size() < series_.size(); });
  for (Finding& finding : now) finding.frames.clear();
  std::vector<FindingChange> changes;
  for (const Finding& finding : now) {
    const Finding* before = find(findings_, finding.kind);
    if (before != nullptr && before->severity >= finding.severity) continue;
    if (finding.severity == Severity::note && !noted_.insert(finding.kind).second) continue;
    changes.push_back({finding, false});
  }
  for (const Finding& finding : findings_) {
    if (finding.severity > Severity::note && find(now, finding.kind) == nullptr)
      changes.push_back({finding, true});
  }
  findings_ = std::move(now);
  return changes;
}

}  // namespace cairn
