// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/core/left_image.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/pipeline/config.hpp>
#include <cairn/stereo/disparity_map.hpp>
#include <optional>

namespace cairn {

/// The input of a frame: a pair or, without a right image, a left image and external disparities.
struct FrameInput {
  LeftImage left;
  View<const Gray> right = {};
  DisparityMap disparity = {};

  static FrameInput from(const StereoPair& pair) { return {{pair.left(), pair.left_rgb()}, pair.right()}; }
};

/// Everything else that a frame depends on. Borrows it.
struct Run {
  const std::optional<StereoRig>& rig;
  const Config& config;
  const Exec& exec;
};

}  // namespace cairn
