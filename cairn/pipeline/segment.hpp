// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/grouping/choose_objects.hpp>
#include <cairn/objects/space.hpp>
#include <cairn/pipeline/config.hpp>

namespace cairn {

/// Disparity with everything that speaks against it: matching and every check, ground and speckle included.
struct SceneDisparity {
  DisparityMap disparity;
  Ground ground;
  Image<std::uint8_t> floor;  // 255 = floor; empty where there is none
  EpipolarOffset epipolar{};  // how far the right image's rows were off
  Image<float> confidence{};  // 0 … 1, see estimate_confidence(); empty where nothing was matched
};

/// All that is known of one pair. What the other method makes is empty.
struct Frame {
  DisparityMap disparity;
  Ground ground;
  Image<std::uint8_t> floor;  // 255 = floor; empty where there is none; of hierarchy where `space` says so
  // With fusion.method=overlap: the left picture's regions, the disparities', and what unites them.
  Segmentation by_intensity;
  Segmentation by_disparity;
  Fusion fusion;
  // With fusion.method=hierarchy: the pieces of the left picture with their grey levels, and the regions that
  // were chosen to be objects (region 0 = all else) with their disparities.
  Segmentation superpixels;
  Segmentation groups;
  Objects objects;
  // What a robot may hit, object or not.
  Image<Space> space;             // obstacle, floor or unknown
  std::vector<LeftOut> left_out;  // obstacles that are no objects, nearest first, and why
  EpipolarOffset epipolar{};
  Image<float> confidence{};  // 0 … 1, see estimate_confidence(); empty where nothing was matched
};

/// What the options ask of an object in an image of this size, for choose_objects().
ChoiceLimits limits_of(const ObjectsConfig& config, Size image);

/// The method's first half: a pair in, checked disparities out. Throws Error where validate() does.
SceneDisparity estimate_disparity(const StereoPair& pair, const std::optional<StereoRig>& rig,
                                  const Config& config, const Exec& exec);

/// The whole method. Throws Error where validate() does; past that it cannot fail.
Frame segment(const StereoPair& pair, const std::optional<StereoRig>& rig, const Config& config,
              const Exec& exec);

/// The method on a disparity map from elsewhere (depth camera, learned matcher): see external_disparity().
/// Throws Error where sizes differ.
Frame segment(View<const Gray> left, View<const Rgb> left_rgb, DisparityMap disparity,
              const std::optional<StereoRig>& rig, const Config& config, const Exec& exec);

}  // namespace cairn
