// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "stamp_pairer.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace cairn::io {
namespace {

/// More of one side do not wait for the other: at 30 Hz a quarter of a second.
constexpr std::size_t kMostWaiting = 8;
/// A skew that changes by more from pair to pair is no drift: another image has become the nearest.
constexpr double kJumpMs = 3;

}  // namespace

std::int64_t StampPairer::apart(std::size_t left, std::size_t right) const {
  return std::abs(waiting_[0][left].stamp.ns - waiting_[1][right].stamp.ns);
}

std::optional<StampPairer::Pair> StampPairer::push(int side, CameraImage&& image) {
  waiting_[index(side)].push_back(std::move(image));
  if (waiting_[index(side)].size() > kMostWaiting) leave(side);
  auto& [left, right] = waiting_;
  while (!left.empty() && !right.empty()) {
    // What waits behind may be nearer; what has not come yet is not waited for.
    if (right.size() > 1 && apart(0, 1) < apart(0, 0)) {
      leave(1);
    } else if (left.size() > 1 && apart(1, 0) < apart(0, 0)) {
      leave(0);
    } else if (static_cast<double>(apart(0, 0)) > max_skew_ns_) {
      const double ms = static_cast<double>(apart(0, 0)) * 1e-6;
      nearest_unpaired_ms_ = std::min(nearest_unpaired_ms_.value_or(ms), ms);
      leave(left.front().stamp < right.front().stamp ? 0 : 1);
    } else {
      Pair pair{std::move(left.front()), std::move(right.front())};
      left.pop_front();
      right.pop_front();
      note_skew(pair.left.stamp, pair.right.stamp);
      return pair;
    }
  }
  return std::nullopt;
}

void StampPairer::leave(int side) {
  waiting_[index(side)].pop_front();
  ++unpaired_[index(side)];
}

void StampPairer::note_skew(Stamp left, Stamp right) {
  const double skew = static_cast<double>(right.ns - left.ns) * 1e-6;
  extent_.least_ms = pairs_ == 0 ? skew : std::min(extent_.least_ms, skew);
  extent_.most_ms = pairs_ == 0 ? skew : std::max(extent_.most_ms, skew);
  ++pairs_;
  if (line_.count == 0 || std::abs(skew - line_.last_skew) > kJumpMs) line_ = {left};
  const double time = seconds_between(line_.begin, left);
  line_.count += 1;
  line_.time += time;
  line_.time2 += time * time;
  line_.skew += skew;
  line_.time_skew += time * skew;
  line_.last_time = time;
  line_.last_skew = skew;
}

StampPairer::Skew StampPairer::skew() const {
  Skew skew = extent_;
  const double spread = line_.count * line_.time2 - line_.time * line_.time;
  if (line_.count > 2 && spread > 0) {
    // ms in a second are 1000 ppm.
    skew.drift_ppm = 1000 * (line_.count * line_.time_skew - line_.time * line_.skew) / spread;
    skew.drift_over_s = line_.last_time;
  }
  return skew;
}

}  // namespace cairn::io
