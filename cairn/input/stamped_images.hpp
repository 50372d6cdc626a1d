// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <deque>
#include <optional>
#include <utility>

#include <cairn/sequence/stamps.hpp>

namespace cairn::input {

/// Images of a topic that accompanies the frames of others, in the order of their stamps.
template <class T>
class StampedImages {
 public:
  /// Of more than `most` that wait, the oldest is dropped.
  StampedImages(double max_skew_ms, std::size_t most) : max_skew_ns_(max_skew_ms * 1e6), most_(most) {}

  void push(Stamp stamp, T image) {
    if (!waiting_.empty() && stamp < waiting_.back().stamp) waiting_.clear();  // the clock was set back
    waiting_.push_back({stamp, std::move(image)});
    if (waiting_.size() > most_) waiting_.pop_front();
  }
  /// Whether none that comes later can be nearer to this stamp.
  [[nodiscard]] bool reaches(Stamp stamp) const {
    return !waiting_.empty() && !(waiting_.back().stamp < stamp);
  }
  /// The nearest one within the skew. Those before it are dropped.
  std::optional<T> take(Stamp stamp) {
    const auto apart = [&](std::size_t i) { return std::abs(waiting_[i].stamp.ns - stamp.ns); };
    while (waiting_.size() > 1 && apart(1) <= apart(0)) waiting_.pop_front();
    if (waiting_.empty() || static_cast<double>(apart(0)) > max_skew_ns_) return std::nullopt;
    T image = std::move(waiting_.front().image);
    waiting_.pop_front();
    return image;
  }

 private:
  struct Waiting {
    Stamp stamp;
    T image;
  };
  double max_skew_ns_;
  std::size_t most_;
  std::deque<Waiting> waiting_;
};

}  // namespace cairn::input
