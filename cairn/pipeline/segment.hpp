// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/objects/fuse.hpp>
#include <cairn/objects/ground_steps.hpp>
#include <cairn/objects/obstacles.hpp>
#include <cairn/pipeline/input.hpp>
#include <cairn/regions/choose_objects.hpp>
#include <cairn/regions/refine_disparity.hpp>

namespace cairn {

/// Disparity with the reason of every hole: after matching and all checks, ground and speckle included.
struct StereoResult {
  DisparityMap disparity{};
  Ground ground{};
  Image<std::uint8_t> floor{};  // 255 = floor; empty without a ground
  EpipolarOffset epipolar{};    // row offset of the right image
  Image<float> confidence{};    // 0 … 1, see estimate_confidence(); empty without matching
};

/// The results of one pair. Results of the other method are empty. With pipeline.method=region_tree, `floor` is
/// the floor of `space`.
struct Frame : StereoResult {
  // With pipeline.method=paper: the regions of the left image, those of the disparities, and their fusion.
  Segmentation by_intensity{};
  Segmentation by_disparity{};
  Fusion fusion{};
  // With pipeline.method=region_tree: the superpixels with their grey levels, and the regions chosen as objects
  // (region 0 = the rest) with their disparities.
  Segmentation superpixels{};
  Segmentation groups{};
  RefinedDisparity
      refined{};  // the most likely disparity of each pixel, without the sky; empty without a pair
  Objects objects{};
  // Obstacles for a robot, whether objects or not.
  Image<ObstacleLabel> space{};              // obstacle, floor, sky or unknown
  std::vector<RejectedObstacle> left_out{};  // obstacles that are not objects, nearest first, and why
};

/// obstacle_disparities() of a frame.
Image<float> obstacle_disparities(const Frame& frame);
/// scan_obstacles(), find_steps() and map_obstacles() of a frame; in the grid, the cells along steps are occupied.
ObstacleScan scan_obstacles(const Frame& frame, const FloorFrame& floor, const StereoRig& rig,
                            const ObstaclesConfig& config);
std::vector<GroundStep> find_steps(const Frame& frame, const FloorFrame& floor, const StereoRig& rig,
                                   const ObstaclesConfig& config);
ObstacleGrid map_obstacles(const Frame& frame, const FloorFrame& floor, const StereoRig& rig,
                           const ObstaclesConfig& config);
/// The same, with the steps that find_steps() has found.
ObstacleGrid map_obstacles(const Frame& frame, const std::vector<GroundStep>& steps, const FloorFrame& floor,
                           const StereoRig& rig, const ObstaclesConfig& config);

/// The limits of an object in an image of this size, for choose_objects().
ChoiceLimits limits_of(const ObjectsConfig& config, Size image);

/// The first half of the method: from a pair to checked disparities. Throws Error like validate().
StereoResult estimate_disparity(const StereoPair& pair, const std::optional<StereoRig>& rig,
                                const Config& config, const Exec& exec);

/// The same, also for external disparities. Throws Error if sizes differ.
StereoResult estimate_disparity(FrameInput in, const Run& run);

/// The whole method. Throws Error like validate(); it has no other failures.
Frame segment(const StereoPair& pair, const std::optional<StereoRig>& rig, const Config& config,
              const Exec& exec);

/// The same, also for external disparities (depth camera, learned matcher): see external_disparity(). Throws
/// Error if sizes differ.
Frame segment(FrameInput in, const Run& run);

}  // namespace cairn
