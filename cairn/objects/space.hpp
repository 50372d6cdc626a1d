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

/// What a robot may hit, whether it is one of the objects or not, and where it may drive.
/// (docs/stages/space.md, beyond the paper)
namespace cairn {

/// What a pixel shows. The values are those of space.png.
enum class Space : std::uint8_t { unknown = 0, floor = 128, obstacle = 255 };

struct SpaceConfig {
  float max_height = 2.0F;  // m above the floor, 0.01 … 100; what is higher does not stand in the way
  float range = 6.0F;       // m, 0.1 … 1000; how far scan and grid reach
  float cell_size = 0.05F;  // m, 0.005 … 10; of the grid
};
template <class V>
void fields(SpaceConfig& c, V&& v) {
  v("max_height", c.max_height, "m", "higher things above the floor are in nobody's way",
    range(0.01F, 100.0F));
  v("range", c.range, "m", "how far the scan and the grid of obstacles reach", range(0.1F, 1000.0F));
  v("cell_size", c.cell_size, "m", "side of a cell of the grid of obstacles", range(0.005F, 10.0F));
}

/// What is known of the scene; the images are of one size. Borrows all.
struct SpaceCues {
  const DisparityMap& disparity;
  View<const float> seen_px;     // floor_under_reflections(); empty: the disparities
  View<const float> confidence;  // of the disparities; empty: they are believed
  const Ground& ground;
  const Background& background;
  View<const RegionId> superpixels;  // empty: each pixel by itself
  View<const ObjectId> objects;
};

/// For each pixel what it shows. obstacle: an object, or what stands above the floor (where none is known:
/// before the background) by more than config.margin, with a disparity that is rather right than wrong.
/// floor: what no object covers, in a superpixel of which at least a fifth is known, and of that three fifths
/// lie on the floor; but pixels that are off the floor themselves. A hole in such a piece is floor, too. All
/// else is unknown.
Image<Space> label_space(const SpaceCues& cues, const std::optional<StereoRig>& rig,
                         const GroundConfig& config, const Exec& exec);

/// 255 where the space is floor, else 0.
Image<std::uint8_t> floor_of(View<const Space> space, const Exec& exec);

/// The nearest obstacle in each direction, as a laser scanner has it (ROS sensor_msgs/LaserScan), seen from
/// the floor below the camera.
struct ObstacleScan {
  float angle_min_rad = 0;        // of the first; counter-clockwise from straight ahead
  float angle_increment_rad = 0;  // from one to the next
  float range_max_m = 0;          // how far it reaches
  std::vector<float> ranges_m;    // NaN: no obstacle is seen there, which does not say that there is none
};

/// `space` of label_space(); obstacles without a disparity have no place and are not in it. A range is that
/// of the fourth nearest pixel in its direction: single wrong matches do not count. As wide as the picture is
/// on the floor; all around where the camera sees what is beside it.
ObstacleScan scan_obstacles(View<const Space> space, View<const float> disparity_px, const FloorFrame& floor,
                            const StereoRig& rig, const SpaceConfig& config);

/// What stands where on the floor, as ROS nav_msgs/OccupancyGrid has it: rows along y, from the right to the
/// left, of cells along x, from the camera forward.
struct ObstacleGrid {
  static constexpr std::int8_t kUnknown = -1;
  static constexpr std::int8_t kFree = 0;
  static constexpr std::int8_t kOccupied = 100;
  static constexpr int kMostCells = 4096;  // from the camera on

  float cell_size_m = 0;
  int width = 0;         // cells along x
  int height = 0;        // cells along y
  float origin_x_m = 0;  // of the first cell's corner, in the floor's frame
  float origin_y_m = 0;
  std::vector<std::int8_t> cells;
};

/// Occupied: where at least three pixels of obstacles stand. Free: where else the floor itself is seen, with
/// a disparity of its own, at the cell's middle. Unknown: all else, such as what is hidden behind an
/// obstacle, and holes. At most kMostCells long.
ObstacleGrid map_obstacles(View<const Space> space, View<const float> disparity_px, const FloorFrame& floor,
                           const StereoRig& rig, const SpaceConfig& config);

/// Why something that stands before the background is no object.
enum class LeftOutReason : std::uint8_t { background, too_small, low_confidence };
inline constexpr std::array kLeftOutReasons{
    Choice<LeftOutReason>{"background", LeftOutReason::background},
    Choice<LeftOutReason>{"too small", LeftOutReason::too_small},
    Choice<LeftOutReason>{"low confidence", LeftOutReason::low_confidence}};

/// An obstacle that is no object.
struct LeftOut {
  LeftOutReason reason = LeftOutReason::background;
  Rect box_px;
  int pixel_count = 0;
  float disparity_px = 0;                    // mean of its pixels
  std::optional<Vec3> position_in_camera_m;  // of its middle; needs a rig
  float confidence = 0;  // 0 … 1: the best of a region that holds some of it; 0 where none was judged
};

/// What a region must be to be an object, for reasons.
struct LeftOutLimits {
  std::int64_t min_area = 0;  // px
  float wall_tolerance_px = 1;
};

/// The islands of obstacles that are no objects: 4-connected pixels, neighbours within 1 px of disparity, of
/// at least 0.05 % of the image, nearest first. background: most of it lies on a wall. `likeliest`: for each
/// superpixel how likely the likeliest region that holds it is an object; empty: nothing is known of that.
std::vector<LeftOut> left_out_of(View<const Space> space, const SpaceCues& cues,
                                 const std::vector<float>& likeliest, const std::optional<StereoRig>& rig,
                                 const LeftOutLimits& limits, const Exec& exec);

}  // namespace cairn
