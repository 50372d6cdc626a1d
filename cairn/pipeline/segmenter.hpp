// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/pipeline/segment.hpp>
#include <optional>

namespace cairn {

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

  [[nodiscard]] const Config& config() const { return config_; }
  [[nodiscard]] const std::optional<StereoRig>& rig() const { return rig_; }
  [[nodiscard]] const Exec& exec() const { return exec_; }

 private:
  Config config_;
  std::optional<StereoRig> rig_;
  Exec exec_;
};

}  // namespace cairn
