// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/statistics.hpp>
#include <cairn/evaluation/disparity_error.hpp>
#include <cassert>
#include <cmath>
#include <limits>

namespace cairn {
namespace {

constexpr std::size_t kWithinOnePx = 1;
static_assert(kBadThresholdsPx[kWithinOnePx] == 1);

}  // namespace

DisparityErrors& DisparityErrors::operator+=(const DisparityErrors& other) {
  known += other.known;
  matched += other.matched;
  for (std::size_t t = 0; t < bad.size(); ++t) bad[t] += other.bad[t];
  absolute_sum_px += other.absolute_sum_px;
  square_sum_px2 += other.square_sum_px2;
  square_sum_within_1_px2 += other.square_sum_within_1_px2;
  return *this;
}

double DisparityErrors::density() const {
  return share(static_cast<double>(matched), known);
}
double DisparityErrors::bad_of_matched(std::size_t t) const {
  return share(static_cast<double>(bad[t]), matched);
}
double DisparityErrors::bad_of_known(std::size_t t) const {
  return share(static_cast<double>(bad[t] + known - matched), known);
}
double DisparityErrors::mean_absolute_px() const {
  return share(absolute_sum_px, matched);
}
double DisparityErrors::root_mean_square_px() const {
  return std::sqrt(share(square_sum_px2, matched));
}
double DisparityErrors::sigma_px() const {
  return std::sqrt(share(square_sum_within_1_px2, matched - bad[kWithinOnePx]));
}

DisparityErrors disparity_errors(View<const float> ours_px, View<const float> truth_px,
                                 View<const std::uint8_t> excluded, int skip_left) {
  assert(ours_px.size() == truth_px.size());
  assert(excluded.empty() || excluded.size() == truth_px.size());
  DisparityErrors errors;
  for (int y = 0; y < truth_px.height(); ++y) {
    for (int x = std::max(0, skip_left); x < truth_px.width(); ++x) {
      const float truth = truth_px(x, y);
      if (!std::isfinite(truth) || (!excluded.empty() && excluded(x, y) != 0)) continue;
      ++errors.known;
      const float ours = ours_px(x, y);
      if (std::isnan(ours)) continue;
      ++errors.matched;
      const double off = std::abs(static_cast<double>(ours) - static_cast<double>(truth));
      for (std::size_t t = 0; t < kBadThresholdsPx.size(); ++t) {
        errors.bad[t] += off > static_cast<double>(kBadThresholdsPx[t]) ? 1 : 0;
      }
      errors.absolute_sum_px += off;
      errors.square_sum_px2 += off * off;
      errors.square_sum_within_1_px2 += off > 1 ? 0 : off * off;
    }
  }
  return errors;
}

}  // namespace cairn
