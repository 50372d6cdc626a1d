// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace cairn::live {

/// A histogram of frame times in steps of 0.1 ms up to 2 s, of constant size.
class Latencies {
 public:
  void add(double ms) {
    const double at = std::clamp(ms / kStepMs, 0.0, static_cast<double>(counts_.size() - 1));
    ++counts_[static_cast<std::size_t>(at)];
    ++all_;
    max_ms_ = std::max(max_ms_, ms);
  }
  /// The time that `share` (0 … 1) of the frames did not exceed, in ms; 0 without frames.
  [[nodiscard]] double percentile(double share) const {
    const auto wanted = static_cast<std::uint64_t>(share * static_cast<double>(all_));
    std::uint64_t seen = 0;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      seen += counts_[i];
      if (seen > wanted || (seen == all_ && all_ > 0))
        return std::min(max_ms_, (static_cast<double>(i) + 1) * kStepMs);
    }
    return 0;
  }
  [[nodiscard]] double max_ms() const { return max_ms_; }
  [[nodiscard]] std::uint64_t count() const { return all_; }

 private:
  static constexpr double kStepMs = 0.1;
  std::vector<std::uint64_t> counts_ = std::vector<std::uint64_t>(20000);
  std::uint64_t all_ = 0;
  double max_ms_ = 0;
};

}  // namespace cairn::live
