// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/diagnosis/findings.hpp>
#include <string>
#include <vector>

namespace cairn::cli {

/// "broken", "warning", "note".
std::string name_of(Severity severity);

/// Whether one of them is.
bool is_broken(const std::vector<Finding>& findings);

/// ", in 2 of 40 pairs (a, b)"; "" where there is one frame only. `noun`: "pairs" or "frames".
std::string frames_text(const Finding& finding, const std::vector<std::string>& names, const char* noun);

/// What a folder run finds in passing, said once for all frames that show it.
class PassingFindings {
 public:
  void add(const std::string& frame, std::vector<Finding> findings);
  /// One more frame that was doubtful and not measured.
  void add_doubtful() { ++doubtful_; }
  /// One line on stderr for each finding, with what to do.
  void tell() const;

 private:
  std::vector<std::string> names_;
  std::vector<std::vector<Finding>> of_frames_;
  int doubtful_ = 0;
};

}  // namespace cairn::cli
