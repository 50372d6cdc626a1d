// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/pipeline/segment.hpp>
#include <optional>

namespace cairn {

/// The method for video: holds what the frames of one camera share, above all the pool of image buffers, so
/// that from the second frame on no image is allocated (as long as the frames before it have died). The only
/// class of the library with state, and none of it reaches a result: every call returns what segment() would.
class Segmenter {
 public:
  /// Throws Error where validate(config) or the rig's own validate() does. Buffers come from a pool of its
  /// own, whatever exec.pool is.
  explicit Segmenter(Config config, std::optional<StereoRig> rig = std::nullopt, Exec exec = {});

  /// Throws Error where the configuration does not suit the pair's size.
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
