// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "findings.hpp"

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/diagnosis/given_disparity.hpp>
#include <iostream>
#include <string_view>

namespace cairn::cli {

std::string name_of(Severity severity) {
  return choice_name(severity, kSeverities);
}

bool is_broken(const std::vector<Finding>& findings) {
  return std::any_of(findings.begin(), findings.end(),
                     [](const Finding& finding) { return finding.severity == Severity::broken; });
}

std::string frames_text(const Finding& finding, const std::vector<std::string>& names, const char* noun) {
  constexpr std::size_t kNamed = 3;
  if (names.size() < 2 || finding.frames.empty()) return {};
  std::string all =
      ", in " + std::to_string(finding.frames.size()) + " of " + std::to_string(names.size()) + " " + noun;
  if (finding.frames.size() == names.size()) return all;
  for (std::size_t i = 0; i < std::min(kNamed, finding.frames.size()); ++i)
    all += (i == 0 ? " (" : ", ") + names[finding.frames[i]];
  return all + (finding.frames.size() > kNamed ? ", ...)" : ")");
}

namespace {

/// "cairn: broken: cameras swapped: 98 % of …, in 2 of 5 frames. Exchange the two images."
std::string line_of(const Finding& finding, const std::string& where) {
  const std::string_view remedy = info(finding.kind).remedy;
  return "cairn: " + name_of(finding.severity) + ": " + std::string(info(finding.kind).name) + ": " +
         finding.says + where + (finding.says.ends_with('?') && where.empty() ? " " : ". ") +
         std::string(remedy.substr(0, remedy.find(". "))) + (remedy.find(". ") < remedy.size() ? "." : "") +
         "\n";
}

}  // namespace

std::string changes_text(const std::string& frame, const std::vector<FindingChange>& changes) {
  const std::string where = " (frame " + on_one_line(frame) + ")";
  std::string text;
  for (const auto& [finding, is_gone] : changes) {
    text += is_gone ? "cairn: note: no longer found: " + std::string(info(finding.kind).name) + where + "\n"
                    : line_of(finding, where);
  }
  return text;
}

std::optional<Finding> GivenCheck::check(View<const float> given_px, View<const Gray> left,
                                         const std::function<Image<Gray>()>& right,
                                         const std::optional<StereoRig>& rig, const std::string& name,
                                         const Exec& exec) {
  const int index = frames_++;
  if (!was_refused_ && index >= RigWatch::kFrames && index % RigWatch::kEvery != 0) return std::nullopt;
  was_refused_ = false;
  const Image<Gray> other = right();
  auto found = check_given_disparity(given_px, StereoPair::from(left, other), rig, exec);
  was_refused_ = found && found->severity == Severity::broken;
  if (!was_refused_) return found;
  const FindingInfo& known = info(found->kind);
  throw Error(name + ": " + std::string(known.name) + ": " + found->says + ". " + std::string(known.remedy));
}

void PassingFindings::add(const std::string& frame, std::vector<Finding> findings) {
  names_.push_back(frame);
  of_frames_.push_back(std::move(findings));
}

void PassingFindings::tell() const {
  std::cout.flush();
  for (const Finding& finding : united(of_frames_))
    std::cerr << line_of(finding, frames_text(finding, names_, "frames"));
  if (doubtful_ == 0) return;
  std::cerr << "cairn: note: " << doubtful_
            << " more frames have hardly any common rows or disparities; cairn "
            << "doctor measures them\n";
}

}  // namespace cairn::cli
