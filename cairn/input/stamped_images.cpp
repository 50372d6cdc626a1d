// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/stamped_images.hpp>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <numeric>
#include <utility>

namespace cairn::input {

StampedImages::StampedImages(double max_skew_ms, std::size_t most, std::size_t most_bytes)
    : max_skew_ns_(max_skew_ms * 1e6), most_(most), most_bytes_(most_bytes) {}

void StampedImages::push(Stamp stamp, io::Raster image) {
  if (!waiting_.empty()) {
    const ClockStep step = clock_step(waiting_.back().stamp, stamp);
    if (step == ClockStep::repeated) return;
    if (step == ClockStep::set_back) waiting_.clear();
  }
  waiting_.push_back({stamp, std::move(image)});
  const auto bytes = [&] {
    return std::accumulate(waiting_.begin(), waiting_.end(), std::size_t{0},
                           [](std::size_t sum, const Waiting& one) { return sum + one.image.bytes.size(); });
  };
  while (waiting_.size() > most_ || (waiting_.size() > 1 && bytes() > most_bytes_)) waiting_.pop_front();
}

bool StampedImages::reaches(Stamp stamp) const {
  return !waiting_.empty() && !(waiting_.back().stamp < stamp) &&
         clock_step(waiting_.back().stamp, stamp) != ClockStep::set_back;
}

std::optional<io::Raster> StampedImages::take(Stamp stamp) {
  const std::optional<Stamp> before = std::exchange(before_, stamp);
  double most_ns = max_skew_ns_;
  if (before && *before < stamp) most_ns = std::min(most_ns, static_cast<double>(stamp.ns - before->ns) / 2);
  const auto apart = [&](std::size_t i) { return std::abs(waiting_[i].stamp.ns - stamp.ns); };
  while (waiting_.size() > 1 && apart(1) <= apart(0)) waiting_.pop_front();
  if (waiting_.empty() || static_cast<double>(apart(0)) > most_ns) return std::nullopt;
  io::Raster image = std::move(waiting_.front().image);
  waiting_.pop_front();
  return image;
}

}  // namespace cairn::input
