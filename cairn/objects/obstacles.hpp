// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/fields.hpp>
#include <cairn/objects/measure.hpp>
#include <cairn/scene/background.hpp>
#include <cairn/scene/floor_frame.hpp>
#include <optional>
#include <string_view>
#include <vector>

/// Obstacles, whether objects or not, and free floor, for a robot. (docs/stages/obstacles.md, beyond the paper)
namespace cairn {

/// The class of a pixel. The values are those of space.png.
enum class ObstacleLabel : std::uint8_t { unknown = 0, sky = 64, floor = 128, obstacle = 255 };

struct ObstaclesConfig {
  float max_height = 2.0F;  // m above the floor, 0.01 … 100; higher things do not obstruct
  float range = 6.0F;       // m, 0.1 … 1000; of scan, grid and steps
  float cell_size = 0.05F;  // m, 0.005 … 10; of the grid
};
template <class V>
void fields(ObstaclesConfig& c, V&& v) {
  v("max_height", c.max_height, "m", "largest height above the floor that can obstruct the robot",
    range(0.01F, 100.0F));
  v("range", c.range, "m", "range of the obstacle scan and grid, and of steps of the ground",
    range(0.1F, 1000.0F));
  v("cell_size", c.cell_size, "m", "cell size of the obstacle grid", range(0.005F, 10.0F));
}

/// What obstacles are labelled by. Borrows everything; all images have one size.
struct ObstacleCues {
  const DisparityMap& disparity;
  View<const float> surface_disparity_px;  // floor_under_reflections(); empty: the disparities
  View<const float> confidence;            // of the disparities; empty: all are trusted
  const Ground& ground;
  const Background& background;
  View<const RegionId> superpixels;  // for group_by_floor() and rejected_obstacles(); may be empty
  View<const ObjectId> objects;
  View<const float> refined_px = {};          // refine_disparity(); empty: none
  View<const float> refined_confidence = {};  // its probability
  View<const float> floor_probability = {};   // floor_probability(); empty: disparities alone decide
};
/// Refined disparities that are at least as likely, 0 … 1, are preferred to those of matches.
inline constexpr float kLikelyRefined = 0.8F;
/// With a probability of the floor of at least the first, label_obstacles() says floor; below the second, obstacle. 0 … 1.
inline constexpr float kLikelyFloor = 0.7F, kUnlikelyFloor = 0.35F;

/// Classifies each pixel. obstacle: part of an object. sky: rejected as such. Other pixels by the probability that they
/// show the floor: floor from kLikelyFloor on, obstacle below kUnlikelyFloor, unknown in between. Where that is not
/// known, by its refined disparity if that is likely, else by the matched one: floor within config.margin of the
/// floor, obstacle above it (without a floor: in front of the walls; without either: nearer than infinity) by more
/// than that, if the disparity is more likely right than wrong, else unknown.
Image<ObstacleLabel> label_obstacles(const ObstacleCues& cues, const std::optional<StereoRig>& rig,
                                     const GroundConfig& config, const Exec& exec);

/// 255 for floor, else 0.
Image<std::uint8_t> floor_of(View<const ObstacleLabel> space, const Exec& exec);

/// The disparities for scan_obstacles() and map_obstacles(): of obstacles the refined one if it is likely, so holes that
/// were filled have a position, too; of all others that of the match. With refined disparities, NaN where the disparity
/// contradicts the label: an obstacle that is no object and not more than 1 px in front of the floor, and floor more than
/// 1 px off it. Such a place is neither free nor known to be occupied. `cues`: those of label_obstacles().
Image<float> obstacle_disparities(View<const ObstacleLabel> space, const ObstacleCues& cues,
                                  const Exec& exec);

/// The nearest obstacle in each direction, as from a laser scanner (ROS sensor_msgs/LaserScan), seen from the
/// floor below the camera.
struct ObstacleScan {
  float angle_min_rad = 0;        // of the first range; counter-clockwise from straight ahead
  float angle_increment_rad = 0;  // between ranges
  float range_max_m = 0;          // largest range
  std::vector<float> ranges_m;    // NaN: no obstacle seen, but not necessarily free
};

/// `space` as returned by label_obstacles(), `disparity_px` by obstacle_disparities(); obstacles without
/// disparity have no position and are left out. A range is that of the fourth nearest pixel in its direction,
/// so that single false matches do not count. Spans the image width on the floor; all around if the camera
/// sees what is next to it.
ObstacleScan scan_obstacles(View<const ObstacleLabel> space, View<const float> disparity_px,
                            const FloorFrame& floor, const StereoRig& rig, const ObstaclesConfig& config);

/// Occupancy of the floor, like ROS nav_msgs/OccupancyGrid: rows along y, from right to left, of cells along
/// x, from the camera forward.
struct ObstacleGrid {
  static constexpr std::int8_t kUnknown = -1;
  static constexpr std::int8_t kFree = 0;
  static constexpr std::int8_t kOccupied = 100;
  static constexpr int kMaxCells = 4096;  // largest number of cells along x

  float cell_size_m = 0;
  int width = 0;         // cells along x
  int height = 0;        // cells along y
  float origin_x_m = 0;  // corner of the first cell, in the floor frame
  float origin_y_m = 0;
  std::vector<std::int8_t> cells;
};

/// Occupied: cells with at least three obstacle pixels. Free: other cells whose centre shows the floor, with
/// a disparity of its own. Unknown: all others, such as those occluded by an obstacle, and holes. At most
/// kMaxCells long.
ObstacleGrid map_obstacles(View<const ObstacleLabel> space, View<const float> disparity_px,
                           const FloorFrame& floor, const StereoRig& rig, const ObstaclesConfig& config);

/// Why something in front of the background is not an object.
enum class RejectionReason : std::uint8_t { background, too_small, low_confidence };
inline constexpr std::array kLeftOutReasons{
    Choice<RejectionReason>{"background", RejectionReason::background},
    Choice<RejectionReason>{"too small", RejectionReason::too_small},
    Choice<RejectionReason>{"low confidence", RejectionReason::low_confidence}};

/// An obstacle that is not an object.
struct RejectedObstacle {
  RejectionReason reason = RejectionReason::background;
  Rect box_px;
  int pixel_count = 0;
  float disparity_px = 0;                    // mean of its pixels
  std::optional<Vec3> position_in_camera_m;  // of its centre; needs a rig
  float confidence = 0;  // 0 … 1: the best of the regions that overlap it; 0 if none was judged
};

/// The limits of an object, for the reasons.
struct RejectedObstacleLimits {
  std::int64_t min_area = 0;  // px
  float wall_tolerance_px = 1;
};

/// The connected obstacles that are not objects: 4-connected pixels, neighbours within 1 px of disparity, of
/// at least 0.05 % of the image, nearest first. background: most of it is on a wall. `likeliest`: for each
/// superpixel the probability of its likeliest object region; empty: unknown.
std::vector<RejectedObstacle> rejected_obstacles(View<const ObstacleLabel> space, const ObstacleCues& cues,
                                                 const std::vector<float>& likeliest,
                                                 const std::optional<StereoRig>& rig,
                                                 const RejectedObstacleLimits& limits, const Exec& exec);

}  // namespace cairn
