// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/pipeline/segment.hpp>
#include <memory>
#include <optional>

namespace cairn {

class ScenesAhead;  // private to the library

/// The method for video: keeps what the frames of one camera share, above all the pool of image buffers, so
/// that from the second frame on no image is allocated (once earlier frames have been destroyed). The only
/// class of the library with state; the state never changes a result: every call returns the result of
/// segment(). Several threads may call one Segmenter at once: their frames share its workers and buffers, and
/// an observer in its Exec is called from all of these threads.
class Segmenter {
 public:
  /// Throws Error like validate(config) or the validate() of the rig. Buffers come from its own pool, not
  /// from exec.pool.
  explicit Segmenter(Config config, std::optional<StereoRig> rig = std::nullopt, Exec exec = {});

  /// Throws Error if the configuration does not suit the size of the pair.
  [[nodiscard]] Frame segment(const StereoPair& pair) const;

  /// Begins the frame of the pair after the next one: call it before segment() of the next pair, so that both frames
  /// are computed at once, each with half of the threads. Two threads then do almost twice the frames of one. The
  /// images are copied. segment() finds by their pixels what was begun, and returns the same frame without this call.
  /// With one thread, only the matches of a device (Exec::device) are begun. Throws Error like segment().
  void prefetch(const StereoPair& pair) const;

  [[nodiscard]] const Config& config() const { return config_; }
  [[nodiscard]] const std::optional<StereoRig>& rig() const { return rig_; }
  [[nodiscard]] const Exec& exec() const { return exec_; }

 private:
  Config config_;
  std::optional<StereoRig> rig_;
  Exec exec_;
  std::shared_ptr<ScenesAhead> ahead_;  // of all copies
};

}  // namespace cairn
