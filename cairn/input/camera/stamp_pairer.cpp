// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/camera/stamp_pairer.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace cairn::input {
namespace {

/// Images of one side kept waiting for the other: a quarter of a second at 30 Hz.
constexpr std::size_t kMaxWaiting = 8;
/// A larger change of skew between pairs is not drift: another image has become the nearest.
constexpr double kJumpMs = 3;

}  // namespace

StampPairer::StampPairer(double max_skew_ms)
    : pairing_(max_skew_ms, [this](std::size_t side, Pairing::WaitingItem&& alone) {
        ++unpaired_[side];
        const auto& others = pairing_.waiting(1 - side);
        if (others.empty()) return;
        const double ms = std::abs(static_cast<double>(alone.stamp.ns - others.front().stamp.ns)) * 1e-6;
        nearest_unpaired_ms_ = std::min(nearest_unpaired_ms_.value_or(ms), ms);
      }) {}

std::optional<StampPairer::Pair> StampPairer::push(std::size_t side, CameraImage&& image) {
  const Stamp stamp = image.stamp;
  pairing_.push_live(side, stamp, std::move(image), kMaxWaiting);
  auto pair = pairing_.next();
  if (!pair) return std::nullopt;
  note_skew(pair->left.stamp, pair->right.stamp);
  return Pair{std::move(pair->left.value), std::move(pair->right.value)};
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
    // 1 ms/s = 1000 ppm.
    skew.drift_ppm = 1000 * (line_.count * line_.time_skew - line_.time * line_.skew) / spread;
    skew.drift_over_s = line_.last_time;
  }
  return skew;
}

}  // namespace cairn::input
