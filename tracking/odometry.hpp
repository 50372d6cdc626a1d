// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/fields.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/disparity/disparity_map.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "pose.hpp"

namespace cairn {

enum class OdometryMethod : std::uint8_t { off, frame, keyframe };
inline constexpr std::array kOdometryMethods{Choice{"off", OdometryMethod::off},
                                             Choice{"frame", OdometryMethod::frame},
                                             Choice{"keyframe", OdometryMethod::keyframe}};

/// How the camera's own motion is estimated.
struct OdometryConfig {
  OdometryMethod method = OdometryMethod::keyframe;
  int max_features = 300;
  float quality_level = 0.01F;
  float min_distance = 8.0F;    // px
  float min_confidence = 0.5F;  // of a corner's disparity
  int win_size = 11;            // px
  int max_level = 3;
  float fb_max_error = 0.5F;        // px
  float reprojection_error = 1.5F;  // px
  int iterations = 200;
  float confidence = 0.999F;
  int min_inliers = 15;
  float keyframe_inliers = 0.6F;  // share
  float max_depth_baselines = 40.0F;
  float sigma_disparity = 0.35F;  // px
  float sigma_pixel = 0.3F;       // px
};
template <class V>
void fields(OdometryConfig& c, V&& v) {
  const auto on = unless("odometry.method", "off");
  v("method", c.method, "", "motion against the last keyframe, against the frame before, or none",
    kOdometryMethods);
  v("max_features", c.max_features, "", "corners of a keyframe", range(30, 2000), on);
  v("quality_level", c.quality_level, "", "a corner's strength, as a share of the strongest one's",
    range(0.0001F, 0.5F), on);
  v("min_distance", c.min_distance, "px", "between corners", range(2.0F, 50.0F), on);
  v("min_confidence", c.min_confidence, "", "corners whose disparity is less sure are left out",
    range(0.0F, 1.0F), on);
  v("win_size", c.win_size, "px", "window by which a corner is followed", odd_range(5, 41), on);
  v("max_level", c.max_level, "", "pyramid levels above the picture by which a corner is followed",
    range(0, 5), on);
  v("fb_max_error", c.fb_max_error, "px", "a corner that is followed back may miss itself by this",
    off_or(0.1F, 5.0F), on);
  v("reprojection_error", c.reprojection_error, "px",
    "a corner that a motion misses by more speaks against it", range(0.3F, 10.0F), on);
  v("iterations", c.iterations, "", "motions tried at most", range(20, 5000), on);
  v("confidence", c.confidence, "", "that the right motion is among those tried", range(0.9F, 0.9999F), on);
  v("min_inliers", c.min_inliers, "", "fewer corners tell no motion", range(6, 200), on);
  v("keyframe_inliers", c.keyframe_inliers, "", "a smaller share of a keyframe's corners asks for a new one",
    range(0.2F, 0.95F), when("odometry.method", "keyframe"));
  v("max_depth_baselines", c.max_depth_baselines, "baselines", "farther corners tell rotation only",
    off_or(5.0F, 1000.0F), on);
  v("sigma_disparity", c.sigma_disparity, "px", "standard deviation of a disparity", range(0.05F, 3.0F), on);
  v("sigma_pixel", c.sigma_pixel, "px", "standard deviation of a followed corner's place", range(0.05F, 3.0F),
    on);
}

/// Why a frame has no motion of its own.
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

/// What another sensor says of the camera's motion since the frame before: points of the camera's frame then
/// go to its frame now by `now_from_before`. Of a gyroscope only the rotation counts.
struct MotionPrior {
  PriorKind kind = PriorKind::wheels;
  Pose now_from_before;
  Covariance6 covariance{};
};

/// The motion that one frame shows.
struct Motion {
  Pose now_from_before;      // of the frame before, with the refusal's stand-in where it was refused
  Covariance6 covariance{};  // of the camera's pose against the keyframe, in the frame of the camera now
  MotionRefusal refusal = MotionRefusal::none;
  bool is_new_keyframe = false;
  // What is seen from here on is tied to what was seen before by a guess alone: the place is known to 1 m and
  // 30° (standard deviations, each axis), and a map may be asked where this is.
  bool is_new_segment = false;
  int followed = 0;  // corners
  int inliers = 0;
  float chi2_per_dof = 0;
  float inlier_share = 0;  // of the corners that were followed
};

struct Keyframe;  // odometry.cpp's own: corners with their points, and the image's pyramid

/// A keyframe and where it was taken. Covariances of poses in the map: translation = the position's error,
/// rotation = the attitude's, both along the map's axes.
struct PlacedKeyframe {
  std::shared_ptr<const Keyframe> frame;  // none: not there
  Pose map_from_key;
  Covariance6 covariance{};  // of map_from_key
  int inliers = 0;           // when it was first followed; 0 before
};

/// All that odometry remembers. A value: copying is cheap, and what is shared never changes.
struct OdometryState {
  PlacedKeyframe key;                    // none before the first frame that has corners
  PlacedKeyframe spare;                  // of the frame before where that was refused: the next try
  std::shared_ptr<const Keyframe> seen;  // the frame before, at a small size, however dark it was
  bool has_begun = false;
  Pose map_from_camera;             // of the frame before
  Covariance6 covariance{};         // of map_from_camera; grows
  Covariance6 covariance_to_key{};  // of the frame before against `key`, in the frame of the camera then
  Pose last_step;                   // now_from_before of the frame before
  int refused_in_a_row = 0;
  bool is_after_gap = false;  // see after_gap()
  int slipping = 0;           // frames in a row that stood still while the wheels said otherwise
  bool is_guessed = false;    // a frame since `key` was seen last moved by no sensor
  // After more than five refusals without wheels: the pose is not known until `key` is seen again, or until
  // three frames in a row show the same, which begin a new segment.
  bool lost = false;
  int coherent_in_a_row = 0;  // while lost: frames whose motion against the frame before was found
};

struct OdometryStep {
  OdometryState state;
  Motion motion;
};

/// The first frame's state: `map_from_camera` is where the run begins.
OdometryState begin_odometry(const Pose& map_from_camera);

/// A pause lies between the frame before and the next one: nobody knows how the camera went on meanwhile.
/// Where the keyframe is not found again and no wheels tell, the place is known to 1 m and 30° (standard
/// deviations, each axis) from then on.
OdometryState after_gap(OdometryState state);

/// The camera's motion up to this frame, and what is to be remembered for the next one. `confidence`: of the
/// disparities, may be empty; `moving`: 255 on what moves by itself, may be empty. Corners are Shi and
/// Tomasi's (1994), followed by pyramidal Lucas-Kanade (Bouguet 2000) from the keyframe; hypotheses by
/// perspective-3-points in RANSAC with a fixed seed; refined by Gauss-Newton over (u, v, d).
/// (docs/stages/odometry.md)
OdometryStep advance_odometry(const OdometryState& state, View<const Gray> left,
                              const DisparityMap& disparity, View<const float> confidence,
                              View<const std::uint8_t> moving, const StereoRig& rig,
                              const std::optional<MotionPrior>& prior, const OdometryConfig& config);

}  // namespace cairn
