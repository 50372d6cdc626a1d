// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/pipeline/segmenter.hpp>
#include <optional>

#include "follow_config.hpp"
#include "reliability.hpp"
#include "warp.hpp"

namespace cairn {

/// All that is known after one frame of a sequence.
struct Step {
  int index = 0;  // from 0
  Stamp stamp;
  Frame frame;
  Image<TrackId> ids;  // frame.objects.labels by track; none where no track is
  Motion motion;
  Pose map_from_camera;
  Covariance6 pose_covariance{};
  bool is_lost = false;  // the camera's place is not known
  Tracks tracks;
  Reliability reliability;
};

/// Follows the camera and the objects through a sequence: the page that calls the stages in order. The map's
/// frame has its origin on the floor below the first frame's camera, x forward, y left, z up (ROS REP 103);
/// without a floor at the camera, whose view is then taken for level.
class Follower {
 public:
  /// Throws Error where validate(config) or the rig's own validate() does. Without a rig there are ids, but
  /// no metres and no motion. objects.min_confidence is not read: tracking.low_confidence takes its place.
  explicit Follower(FollowConfig config, std::optional<StereoRig> rig = std::nullopt, Exec exec = {});

  /// The next frame. Throws Error where its size differs from the first one's, where its stamp is not later
  /// than the one before, or where the configuration does not suit its size. `prior`: since the frame before.
  /// `map_from_camera`: where the camera is, of a robot that knows; it is taken as it is, and no motion is
  /// estimated. `scan`: a laser's, of this moment.
  Step next(const StereoPair& pair, Stamp stamp, const std::optional<MotionPrior>& prior = std::nullopt,
            const std::optional<Pose>& map_from_camera = std::nullopt, const LaserScan* scan = nullptr);

  /// A pause lies between the frame before and the next one (see source.max_gap): how the camera and the
  /// things moved meanwhile is not known. All tracks are lost until they are seen again, those that were not
  /// sure yet end, and where the camera does not find its keyframe again its place is known to 1 m and 30°
  /// only.
  void forget();

  [[nodiscard]] const FollowConfig& config() const { return config_; }
  /// From the next frame on; what is known stays known. Throws Error where validate(config) does, and changes
  /// nothing then.
  void set_config(FollowConfig config);

 private:
  FollowConfig config_;
  std::optional<StereoRig> rig_;
  Exec exec_;
  std::optional<Size> size_;
  int frames_ = 0;
  Stamp before_;
  OdometryState odometry_;
  Tracks tracks_;
  Remembered remembered_;
  Reliability reliability_;
};

}  // namespace cairn
