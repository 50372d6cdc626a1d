// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/pipeline/segmenter.hpp>
#include <memory>
#include <optional>

#include <cairn/sequence/follow_config.hpp>
#include <cairn/sequence/reliability.hpp>
#include <cairn/sequence/warp.hpp>

namespace cairn {

/// The results of one frame of a sequence.
struct TrackedFrame {
  int index = 0;  // from 0
  Stamp stamp;
  Frame frame;
  Image<TrackId> ids;  // track of each pixel, from frame.objects.labels; none = no track
  Motion motion;
  Pose map_from_camera;
  Covariance6 pose_covariance{};
  bool is_lost = false;  // the pose of the camera is unknown
  Tracks tracks;
  Reliability reliability;
  std::optional<ControlEvent> control;  // found at this frame
};

class Controller;

/// Tracks camera and objects through a sequence by calling the stages in order. The origin of the map frame
/// is on the floor below the first camera, x forward, y left, z up (ROS REP 103); without a floor it is at
/// the camera, whose view is assumed to be level. Not thread-safe.
class Follower {
 public:
  /// Throws Error if validate(config) or the validate() of the rig does. Without a rig there are ids, but no
  /// metres and no motion. Regions below objects.min_confidence, down to tracking.low_confidence, only keep
  /// tracks alive.
  explicit Follower(FollowConfig config, std::optional<StereoRig> rig = std::nullopt, Exec exec = {});
  ~Follower();
  Follower(Follower&& from) noexcept;
  Follower& operator=(Follower&& from) noexcept;

  /// The next frame. Throws Error if its size differs from the first one's, its stamp is the one before or at most 1 s
  /// earlier, or the configuration does not suit its size. A stamp set back further, see clock_step(), begins a new run:
  /// another map frame, and new tracks, whose ids continue. `prior`: the motion since the frame before.
  /// `map_from_camera`: the pose of the camera if the robot knows it; used unchanged, without motion
  /// estimation. `scan`: of a laser at this time.
  TrackedFrame next(const StereoPair& pair, Stamp stamp,
                    const std::optional<MotionPrior>& prior = std::nullopt,
                    const std::optional<Pose>& map_from_camera = std::nullopt,
                    const LaserScan* scan = nullptr);
  /// The same with external disparities (depth camera, learned matcher), of the size of the left image, which are
  /// taken instead of those of a pair: NaN and ±inf are holes.
  TrackedFrame next(const LeftImage& left, View<const float> disparity_px, Stamp stamp,
                    const std::optional<MotionPrior>& prior = std::nullopt,
                    const std::optional<Pose>& map_from_camera = std::nullopt,
                    const LaserScan* scan = nullptr);

  /// Begins the segmentation of the pair after the next one, see Segmenter::prefetch(): call it before next(), or from
  /// another thread at any time. It is dropped when options of the segmentation change. Throws Error if the
  /// configuration does not suit the size.
  void prefetch(const StereoPair& pair);

  /// Announces a gap before the next frame (see source.max_gap), during which the motion of camera and
  /// objects is unknown. All tracks are lost until seen again, tentative ones end, and unless the camera
  /// finds its keyframe again, its position has a standard deviation of 1 m and 30°.
  void forget();

  /// A follower that goes on from here with another configuration, without a search for better options. Throws
  /// Error if validate(config) does.
  [[nodiscard]] Follower with(FollowConfig config) const;

  /// For the next frame; ControlMethod::tune changes options of the segmentation.
  [[nodiscard]] const FollowConfig& config() const { return config_; }
  /// Sets the configuration from the next frame on; the state is kept, but another configuration begins the
  /// search for better options anew. Throws Error if validate(config) does, without any change.
  void set_config(FollowConfig config);

 private:
  /// A pair, or the left image and external disparities.
  struct Seen {
    LeftImage left;
    View<const Gray> right{};
    View<const float> disparity_px{};
    [[nodiscard]] Size size() const { return left.gray.size(); }
  };
  /// What other sensors know.
  struct Known {
    const std::optional<MotionPrior>& prior;
    const std::optional<Pose>& map_from_camera;
    const LaserScan* scan;
  };

  /// Matches the frame's objects with the tracks, which advance.
  void match_tracks(TrackedFrame& step, const LeftImage& left, const MaskPrediction& predicted,
                    const Covariance6& since_key, const StereoRig& rig);
  TrackedFrame next(const Seen& seen, Stamp stamp, const Known& known);
  TrackedFrame follow(const Seen& seen, Stamp stamp, const Known& known);
  void begin_control();
  /// After the clock was set back.
  void start_again();
  /// Throws Error unless the frame continues the sequence.
  void check(const Seen& seen, Stamp stamp) const;

  /// The motion since the frame before; moves the camera of `state_`.
  Motion move_camera(View<const Gray> left, Stamp stamp, const StereoResult& stereo, const Known& known);

  struct State {
    std::optional<Size> size;
    int frames = 0;
    bool is_over_floor = false;   // the map's z = 0 is the floor
    std::optional<Stamp> before;  // nullopt at the beginning of a run
    OdometryState odometry;
    Tracks tracks;
    MaskMemory remembered;
    Reliability reliability;
  };

  FollowConfig config_;
  std::optional<StereoRig> rig_;
  Exec exec_;
  State state_;
  std::unique_ptr<ScenesAhead> ahead_;
  std::unique_ptr<Controller> controller_;  // null if off
};

}  // namespace cairn
