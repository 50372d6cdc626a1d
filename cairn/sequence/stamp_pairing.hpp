// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <utility>

#include <cairn/sequence/stamps.hpp>

namespace cairn {

/// Pairs the images of two ordered streams: mutual nearest neighbours in time, at most `max_skew_ms` apart. Where the
/// clock is set back, images that wait from before it remain without a partner. Sides: 0 is left, 1 is right.
template <class T>
class StampPairing {
 public:
  struct WaitingItem {
    Stamp stamp;
    T value;
  };
  struct Pair {
    WaitingItem left;
    WaitingItem right;
  };
  /// Calls `alone` for each image without a partner.
  StampPairing(double max_skew_ms, std::function<void(std::size_t side, WaitingItem&&)> alone)
      : max_skew_ns_(max_skew_ms * 1e6), alone_(std::move(alone)) {}

  void push(std::size_t side, Stamp stamp, T value) {
    if (last_[side] && clock_step(*last_[side], stamp) == ClockStep::set_back) {
      while (!waiting_[side].empty()) leave(side);
      // The other side may have been set back earlier.
      const std::size_t other = 1 - side;
      while (!waiting_[other].empty() &&
             clock_step(waiting_[other].front().stamp, stamp) == ClockStep::set_back)
        leave(other);
    }
    last_[side] = stamp;
    waiting_[side].push_back({stamp, std::move(value)});
  }
  /// For live streams: keeps at most `most` waiting.
  void push_live(std::size_t side, Stamp stamp, T value, std::size_t most) {
    push(side, stamp, std::move(value));
    if (waiting_[side].size() > most) leave(side);
  }
  [[nodiscard]] const std::deque<WaitingItem>& waiting(std::size_t side) const { return waiting_[side]; }

  /// The next pair; nullopt once a side has ended. `has(side, count)` returns whether that many of a side
  /// wait, after reading on if possible; reading on keeps one waiting image of each side.
  template <class Has>
  std::optional<Pair> next(const Has& has) {
    while (has(0, 1) && has(1, 1)) {
      if (auto pair = decide(has)) return pair;
    }
    return std::nullopt;
  }
  /// The next pair among the waiting images, without reading on.
  std::optional<Pair> next() { return next(waits()); }

  /// Reports the longest-waiting image of a side as unpaired.
  void leave(std::size_t side) {
    WaitingItem alone = std::move(waiting_[side].front());
    waiting_[side].pop_front();
    alone_(side, std::move(alone));
  }
  /// All waiting images, and those found by reading on, see next().
  template <class Has>
  void leave_all(const Has& has) {
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
      while (has(side, 1)) leave(side);
    }
  }
  void leave_all() { leave_all(waits()); }

 private:
  /// Decides on the longest-waiting image of each side: they form a pair, or one of them is unpaired.
  template <class Has>
  std::optional<Pair> decide(const Has& has) {
    auto& [left, right] = waiting_;
    // Reading on may come to a clock that is set back, which takes away what waits from before it.
    const auto is_without = [&] { return left.empty() || right.empty(); };
    if (is_without()) return std::nullopt;
    const bool is_exact = apart(0, 0) == 0;
    if (!is_exact && has(1, 2) && !is_without() && apart(0, 1) < apart(0, 0)) {
      leave(1);
    } else if (!is_exact && has(0, 2) && !is_without() && apart(1, 0) < apart(0, 0)) {
      leave(0);
    } else if (is_without()) {
      return std::nullopt;
    } else if (static_cast<double>(apart(0, 0)) > max_skew_ns_) {
      leave(left.front().stamp < right.front().stamp ? 0 : 1);
    } else {
      Pair pair{std::move(left.front()), std::move(right.front())};
      left.pop_front();
      right.pop_front();
      return pair;
    }
    return std::nullopt;
  }

  /// Time between a left and a right image, ns.
  [[nodiscard]] std::int64_t apart(std::size_t left, std::size_t right) const {
    const std::int64_t difference = waiting_[0][left].stamp.ns - waiting_[1][right].stamp.ns;
    return difference < 0 ? -difference : difference;
  }

  /// The `has` of next() without reading on.
  auto waits() const {
    return [this](std::size_t side, std::size_t count) { return waiting_[side].size() >= count; };
  }

  double max_skew_ns_;
  std::function<void(std::size_t, WaitingItem&&)> alone_;
  std::array<std::deque<WaitingItem>, 2> waiting_;
  std::array<std::optional<Stamp>, 2> last_;
};

}  // namespace cairn
