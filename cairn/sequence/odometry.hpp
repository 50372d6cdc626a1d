// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/fields.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/stereo/disparity_map.hpp>
#include <memory>
#include <optional>
#include <vector>

#include <cairn/sequence/pose.hpp>

namespace cairn {

enum class OdometryMethod : std::uint8_t { off, frame, keyframe };
inline constexpr std::array kOdometryMethods{Choice{"off", OdometryMethod::off},
                                             Choice{"frame", OdometryMethod::frame},
                                             Choice{"keyframe", OdometryMethod::keyframe}};

/// The estimation of the camera motion.
struct OdometryConfig {
  OdometryMethod method = OdometryMethod::keyframe;
  int max_features = 300;
  int min_inliers = 15;
  float keyframe_inliers = 0.6F;  // share
  // Constants, not options.
  float quality_level = 0.01F;        // smallest strength of a corner, relative to the strongest
  float min_distance = 8.0F;          // px between corners
  float min_spacing = 0.5F;           // between corners, of the spacing of max_features on a grid
  float min_confidence = 0.5F;        // of the disparity of a corner
  int win_size = 11;                  // px; side of the window for tracking a corner
  int max_level = 3;                  // pyramid levels above the image
  float fb_max_error = 0.5F;          // px; forward-backward error of a tracked corner
  float reprojection_error = 1.5F;    // px; of an inlier
  int iterations = 200;               // RANSAC hypotheses
  float confidence = 0.999F;          // that RANSAC draws a correct hypothesis
  float max_depth_baselines = 40.0F;  // beyond it corners only constrain the rotation
  float sigma_disparity = 0.35F;      // px
  float sigma_pixel = 0.3F;           // px; of the position of a tracked corner
};
template <class V>
void fields(OdometryConfig& c, V&& v) {
  const auto on = unless("odometry.method", "off");
  v("method", c.method, "", "reference of the motion: last keyframe, previous frame, or off",
    kOdometryMethods);
  v("max_features", c.max_features, "", "largest number of corners of a keyframe", range(30, 2000), on);
  v("min_inliers", c.min_inliers, "", "smallest number of inlier corners for a motion", range(6, 200), on);
  v("keyframe_inliers", c.keyframe_inliers, "", "share of inlier corners below which a new keyframe starts",
    range(0.2F, 0.95F), when("odometry.method", "keyframe"));
}

/// Why the motion of a frame is not estimated from its image.
enum class MotionRefusal : std::uint8_t {
  none,
  off,
  no_rig,
  few_points,
  few_inliers,
  degenerate,
  disagrees_with_prior
};
inline constexpr std::array kMotionRefusals{
    Choice{"none", MotionRefusal::none},
    Choice{"off", MotionRefusal::off},
    Choice{"no_rig", MotionRefusal::no_rig},
    Choice{"few_points", MotionRefusal::few_points},
    Choice{"few_inliers", MotionRefusal::few_inliers},
    Choice{"degenerate", MotionRefusal::degenerate},
    Choice{"disagrees_with_prior", MotionRefusal::disagrees_with_prior}};

enum class PriorKind : std::uint8_t { wheels, gyroscope };

/// The camera motion since the frame before from another sensor: `now_from_before` maps points of the earlier
/// camera frame to the present one. Of a gyroscope only the rotation is used.
struct MotionPrior {
  PriorKind kind = PriorKind::wheels;
  Pose now_from_before;
  Covariance6 covariance{};
};

/// The motion of one frame.
struct Motion {
  Pose now_from_before;      // from the frame before; a substitute if it was refused
  Covariance6 covariance{};  // of the camera pose relative to the keyframe, in the present camera frame
  MotionRefusal refusal = MotionRefusal::none;
  bool is_new_keyframe = false;
  // From here on, poses relate to earlier ones by a guess only: the pose has standard deviations of 1 m and
  // 30° per axis, and a map may be consulted.
  bool is_new_segment = false;
  int followed = 0;  // corners
  int inliers = 0;
  float chi2_per_dof = 0;
  float inlier_share = 0;  // of the tracked corners
};

struct Keyframe;  // private to odometry.cpp: corners with their points, and the image pyramid

/// A keyframe and its pose. Covariances of poses in the map: translation = position error, rotation =
/// attitude error, both along the axes of the map.
struct PlacedKeyframe {
  std::shared_ptr<const Keyframe> frame;  // null: absent
  Pose map_from_key;
  Covariance6 covariance{};  // of map_from_key
  int inliers = 0;           // when it was first tracked; 0 before
};

/// The state of odometry. A value: copying is cheap, and shared data never changes.
struct OdometryState {
  PlacedKeyframe key;                    // absent before the first frame with corners
  PlacedKeyframe spare;                  // the frame before, if that was refused: the next attempt
  std::shared_ptr<const Keyframe> seen;  // the frame before, even if dark
  bool has_begun = false;
  Pose map_from_camera;             // of the frame before
  Covariance6 covariance{};         // of map_from_camera; grows
  Covariance6 covariance_to_key{};  // of the frame before relative to `key`, in the camera frame then
  // Covariance of `key` relative to the keyframe before it, if it is new with this frame; else 0. Along the
  // map's axes.
  Covariance6 key_covariance{};
  Pose last_step;  // now_from_before of the frame before
  int refused_in_a_row = 0;
  bool is_after_gap = false;  // see after_gap()
  int slipping = 0;           // consecutive frames without motion while the wheels turned
  bool is_guessed = false;    // true if a frame since `key` was last seen had no motion from any sensor
  // After more than five refusals without wheels: the pose is unknown until `key` is seen again, or until
  // three consecutive frames are consistent, which begin a new segment.
  bool lost = false;
  int coherent_in_a_row = 0;  // while lost: frames with a motion relative to the frame before
};

struct OdometryStep {
  OdometryState state;
  Motion motion;
};

/// The state before the first frame: `map_from_camera` is the start of the run.
OdometryState begin_odometry(const Pose& map_from_camera);

/// The position of a new segment is a guess, but its height, roll and pitch follow from the floor: `level`
/// (see levelled()) replaces the present pose, and the keyframe moves with it.
OdometryState stood_on_floor(OdometryState state, const Pose& level);

/// Covariance of the present pose relative to the keyframe, along the map's axes.
Covariance6 covariance_since_key(const OdometryState& state);

/// Announces a gap before the next frame, during which the camera motion is unknown. Unless the keyframe is
/// found again or wheels report, the pose then has standard deviations of 1 m and 30° per axis.
OdometryState after_gap(OdometryState state);

/// A frame as odometry uses it. Borrows it.
struct OdometryFrame {
  View<const Gray> left;
  const DisparityMap& disparity;
  View<const float> confidence = {};     // of the disparities; may be empty
  View<const std::uint8_t> moving = {};  // 255 on moving objects; may be empty
};

/// Estimates the camera motion up to this frame, and returns the state for the next one. Corners by Shi and
/// Tomasi (1994), tracked by pyramidal Lucas-Kanade (Bouguet 2000) from the keyframe; hypotheses by
/// perspective-3-points in RANSAC with a fixed seed; refined by Gauss-Newton over (u, v, d).
/// (docs/stages/odometry.md)
OdometryStep advance_odometry(const OdometryState& before, const OdometryFrame& frame, const StereoRig& rig,
                              const std::optional<MotionPrior>& given, const OdometryConfig& config);

}  // namespace cairn
