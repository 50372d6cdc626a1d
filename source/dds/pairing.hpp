// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cstdint>
#include <cstdlib>
#include <deque>
#include <optional>
#include <utility>

#include "../../tracking/pose.hpp"

namespace cairn::dds {

/// Pairs left and right values of two streams in order: by equal stamps, else the nearest one available
/// within `max_skew_ns`.
template <class T>
class Pairing {
 public:
  explicit Pairing(std::int64_t max_skew_ns) : max_skew_ns_(max_skew_ns) {}

  /// `side`: 0 left, 1 right. Values older than a pair's other half are dropped and counted. A stamp that is
  /// not later than the one before on its side resets both: the clock was set back.
  std::optional<std::pair<T, T>> add(std::size_t side, Stamp stamp, T value) {
    auto& own = waiting_[side];
    auto& other = waiting_[1 - side];
    if (last_[side] && stamp <= *last_[side]) {
      unpaired_ += own.size() + other.size();
      own.clear();
      other.clear();
    }
    last_[side] = stamp;
    own.push_back({stamp, std::move(value)});
    auto nearest = other.end();
    for (auto at = other.begin(); at != other.end(); ++at)
      if (nearest == other.end() || distance(at->first, stamp) <= distance(nearest->first, stamp))
        nearest = at;
    if (nearest == other.end() || distance(nearest->first, stamp) > max_skew_ns_) {
      if (own.size() > kMostWaiting) {
        own.pop_front();
        ++unpaired_;
      }
      return std::nullopt;
    }
    unpaired_ += own.size() - 1 + static_cast<std::size_t>(nearest - other.begin());
    std::pair<T, T> pair = side == 0
                               ? std::pair<T, T>(std::move(own.back().second), std::move(nearest->second))
                               : std::pair<T, T>(std::move(nearest->second), std::move(own.back().second));
    own.clear();
    other.erase(other.begin(), std::next(nearest));
    return pair;
  }
  [[nodiscard]] std::uint64_t unpaired() const { return unpaired_; }

 private:
  static std::int64_t distance(Stamp a, Stamp b) { return a < b ? b.ns - a.ns : a.ns - b.ns; }

  static constexpr std::size_t kMostWaiting = 4;
  std::int64_t max_skew_ns_;
  std::array<std::deque<std::pair<Stamp, T>>, 2> waiting_;
  std::array<std::optional<Stamp>, 2> last_;
  std::uint64_t unpaired_ = 0;
};

}  // namespace cairn::dds
