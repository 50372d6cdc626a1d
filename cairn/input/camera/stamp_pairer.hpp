// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <cairn/input/camera/camera.hpp>
#include <cairn/sequence/stamp_pairing.hpp>

namespace cairn::input {

/// Pairs the images of two cameras by nearest stamp as they arrive. Not thread-safe.
class StampPairer {
 public:
  explicit StampPairer(double max_skew_ms);
  StampPairer(const StampPairer&) = delete;
  StampPairer& operator=(const StampPairer&) = delete;

  struct Pair {
    CameraImage left;
    CameraImage right;
  };
  /// `side`: 0 = left. Returns the pair that this image completes, if any.
  std::optional<Pair> push(std::size_t side, CameraImage&& image);

  /// Number of images without a partner.
  [[nodiscard]] std::uint64_t unpaired(std::size_t side) const { return unpaired_[side]; }
  [[nodiscard]] std::uint64_t pairs() const { return pairs_; }

  /// Right stamp minus left stamp, over the pairs.
  struct Skew {
    double least_ms = 0;
    double most_ms = 0;
    double drift_ppm = 0;     // relative slowness of the right clock, over the pairs since the last jump
    double drift_over_s = 0;  // duration of that; the drift is unreliable below some 10 s
  };
  [[nodiscard]] Skew skew() const;
  /// The smallest distance of two images that were not paired, in ms; nullopt without any.
  [[nodiscard]] std::optional<double> nearest_unpaired_ms() const { return nearest_unpaired_ms_; }

 private:
  using Pairing = StampPairing<CameraImage>;
  void note_skew(Stamp left, Stamp right);

  Pairing pairing_;
  std::array<std::uint64_t, 2> unpaired_{};
  std::uint64_t pairs_ = 0;
  std::optional<double> nearest_unpaired_ms_;
  Skew extent_;
  // Sums for the line fit to the skews, times since its first pair.
  struct Line {
    Stamp begin;
    double count = 0, time = 0, time2 = 0, skew = 0, time_skew = 0, last_time = 0, last_skew = 0;
  } line_;
};

}  // namespace cairn::input
