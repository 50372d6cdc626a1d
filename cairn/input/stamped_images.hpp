// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/io/raster.hpp>
#include <cstddef>
#include <deque>
#include <optional>

#include <cairn/sequence/stamps.hpp>

namespace cairn::input {

/// Images of a topic that accompanies the frames of others, in the order of their stamps.
class StampedImages {
 public:
  /// Of more than `most` that wait, or of more than one with more than `most_bytes`, the oldest is dropped.
  StampedImages(double max_skew_ms, std::size_t most, std::size_t most_bytes = std::size_t{512} << 20);

  /// One that is out of order is dropped; where the clock is set back, those from before it are.
  void push(Stamp stamp, io::Raster image);
  /// Whether none that comes later can be nearer to this stamp.
  [[nodiscard]] bool reaches(Stamp stamp) const;
  /// The nearest one to a frame's stamp, within the skew and half of the time since the frame before: others belong to
  /// another frame. It and those before it no longer wait. Frames are asked for in their order.
  std::optional<io::Raster> take(Stamp stamp);

 private:
  struct Waiting {
    Stamp stamp;
    io::Raster image;
  };
  double max_skew_ns_;
  std::size_t most_;
  std::size_t most_bytes_;
  std::deque<Waiting> waiting_;
  std::optional<Stamp> before_;  // of the last frame
};

}  // namespace cairn::input
