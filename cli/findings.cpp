// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "findings.hpp"

#include <algorithm>
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

void PassingFindings::add(const std::string& frame, std::vector<Finding> findings) {
  names_.push_back(frame);
  of_frames_.push_back(std::move(findings));
}

void PassingFindings::tell() const {
  std::cout.flush();
  for (const Finding& finding : united(of_frames_)) {
    const std::string_view remedy = info(finding.kind).remedy;
    std::cerr << "cairn: " << name_of(finding.severity) << ": " << info(finding.kind).name << ": "
              << finding.says << frames_text(finding, names_, "frames")
              << (finding.says.ends_with('?') ? " " : ". ") << remedy.substr(0, remedy.find(". "))
              << (remedy.find(". ") < remedy.size() ? "." : "") << "\n";
  }
  if (doubtful_ == 0) return;
  std::cerr << "cairn: note: " << doubtful_
            << " more frames have hardly any common rows or disparities; cairn "
            << "doctor measures them\n";
}

}  // namespace cairn::cli
