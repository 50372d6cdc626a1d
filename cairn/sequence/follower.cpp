// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/sequence/follower.hpp>

#include <cairn/core/error.hpp>
#include <cairn/pipeline/scenes_ahead.hpp>
#include <utility>

#include <cairn/sequence/controller.hpp>
#include <cairn/sequence/first_pose.hpp>
#include <cairn/sequence/stamps.hpp>

namespace cairn {
namespace {

/// Without a rig, masks are remembered in image coordinates: for a static camera any rig maps there and back.
StereoRig picture_rig(Size size) {
  return {.focal_px = static_cast<float>(size.width),
          .cx_px = static_cast<float>(size.width) / 2,
          .cy_px = static_cast<float>(size.height) / 2,
          .baseline_m = 1,
          .doffs_px = 0};
}

Image<TrackId> ids_of(const Tracks& tracks, const Objects& objects, const Exec& exec) {
  std::vector<TrackId> track_of(objects.list.size() + 1, TrackId::none);
  for (const Track& track : tracks.list) {
    if (track.object == ObjectId::none) continue;
    track_of[slot(number(track.object))] = track.id;
    for (const ObjectId part : track.parts) track_of[slot(number(part))] = track.id;
  }
  Image<TrackId> ids(objects.labels.size(), exec.pool);
  for (int y = 0; y < ids.height(); ++y) {
    for (int x = 0; x < ids.width(); ++x) ids(x, y) = track_of[slot(number(objects.labels(x, y)))];
  }
  return ids;
}

/// 255 where moving objects are expected, else 0. `map_from_camera`: the predicted pose.
Image<std::uint8_t> expected_movers(const MaskMemory& remembered, const Tracks& tracks,
                                    const Pose& map_from_camera, Stamp now, const StereoRig& rig, Size size,
                                    const Exec& exec) {
  Tracks moving;
  for (const Track& track : tracks.list)
    if (track.is_moving && track.state == TrackState::confirmed) moving.list.push_back(track);
  if (moving.list.empty()) return {};
  const MaskPrediction warped = warp(remembered, moving, map_from_camera, now, rig, size, exec);
  Image<std::uint8_t> mask(size, exec.pool);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x)
      mask(x, y) = warped.ids(x, y) == TrackId::none ? std::uint8_t{0} : std::uint8_t{255};
  }
  return mask;
}

}  // namespace

Follower::Follower(FollowConfig config, std::optional<StereoRig> rig, Exec exec)
    : config_(std::move(config)), rig_(rig), exec_(std::move(exec)) {
  validate(config_);
  if (rig_) rig_->validate();
  exec_.pool = Pool::make();
  ahead_ = std::make_unique<ScenesAhead>(config_.segmentation, rig_, exec_);
  begin_control();
}

Follower::~Follower() = default;
Follower::Follower(Follower&& from) noexcept = default;
Follower& Follower::operator=(Follower&& from) noexcept = default;

void Follower::begin_control() {
  const bool is_off = config_.control.method == ControlMethod::off;
  controller_ = is_off ? nullptr : std::make_unique<Controller>(config_);
}

void Follower::set_config(FollowConfig config) {
  validate(config);
  const auto values = [](const FollowConfig& c) {
    std::vector<std::string> all;
    for (OptionInfo& option : options(c)) all.push_back(std::move(option.value));
    return all;
  };
  const bool is_same = values(config) == values(config_);
  const bool is_same_floor =
      config.segmentation.ground.known == config_.segmentation.ground.known;  // no option
  config_ = std::move(config);
  if (!is_same || !is_same_floor) ahead_->set_config(config_.segmentation);
  if (!is_same) begin_control();
}

Follower Follower::with(FollowConfig config) const {
  config.control.method = ControlMethod::off;
  Follower copy(std::move(config), rig_, exec_.beside());
  copy.state_ = state_;
  return copy;
}

void Follower::forget() {
  state_.odometry = after_gap(std::move(state_.odometry));
  std::erase_if(state_.tracks.list, [](const Track& track) { return track.state == TrackState::tentative; });
  for (Track& track : state_.tracks.list) track.state = TrackState::lost;
  state_.reliability.floor.reset();
  if (controller_) controller_->forget();
}

void Follower::start_again() {
  State fresh;
  fresh.size = state_.size;
  fresh.frames = state_.frames;
  fresh.tracks.next = state_.tracks.next;
  state_ = std::move(fresh);
  if (controller_) controller_->forget();
}

TrackedFrame Follower::next(const StereoPair& pair, Stamp stamp, const std::optional<MotionPrior>& prior,
                            const std::optional<Pose>& map_from_camera, const LaserScan* scan) {
  return next({{pair.left(), pair.left_rgb()}, pair.right()}, stamp, {prior, map_from_camera, scan});
}

TrackedFrame Follower::next(const LeftImage& left, View<const float> disparity_px, Stamp stamp,
                            const std::optional<MotionPrior>& prior,
                            const std::optional<Pose>& map_from_camera, const LaserScan* scan) {
  return next({left, {}, disparity_px}, stamp, {prior, map_from_camera, scan});
}

TrackedFrame Follower::next(const Seen& seen, Stamp stamp, const Known& known) {
  TrackedFrame step = follow(seen, stamp, known);
  if (controller_) {
    step.control = controller_->next(
        step, *this, [&](Follower& candidate) { return candidate.follow(seen, stamp, known); });
    if (step.control && step.control->is_set) {
      set(config_.segmentation, step.control->candidate.option, step.control->candidate.value);
      ahead_->set_config(config_.segmentation);
    }
  }
  return step;
}

void Follower::prefetch(const StereoPair& pair) {
  ahead_->begin(pair);
}

void Follower::check(const Seen& seen, Stamp stamp) const {
  const auto refuse = [&](const std::string& why) {
    throw Error("frame " + std::to_string(state_.frames) + ": " + why);
  };
  if (seen.right.empty() && seen.disparity_px.size() != seen.size())
    refuse("its disparity map is " + text(seen.disparity_px.size()) + ", the left image " +
           text(seen.size()));
  if (state_.size && *state_.size != seen.size())
    refuse("is " + text(seen.size()) + ", the first one is " + text(*state_.size));
  if (state_.before && clock_step(*state_.before, stamp) == ClockStep::repeated) {
    refuse("its stamp " + std::to_string(stamp.ns) + " ns is not later than the one before, " +
           std::to_string(state_.before->ns) + " ns");
  }
}

Motion Follower::move_camera(View<const Gray> left, Stamp stamp, const StereoResult& stereo,
                             const Known& known) {
  const auto& [prior, map_from_camera, scan] = known;
  OdometryState& odometry = state_.odometry;
  if (!state_.before) {
    odometry = begin_odometry(map_from_camera.value_or(first_pose(stereo.ground, rig_)));
    state_.is_over_floor = !map_from_camera && stereo.ground.plane.has_value();
  }
  Motion motion;
  if (map_from_camera) {
    motion.refusal = MotionRefusal::off;
    motion.now_from_before = inverse(*map_from_camera) * odometry.map_from_camera;
    odometry = begin_odometry(*map_from_camera);  // the start if a later frame has no pose
    return motion;
  }
  if (!rig_) {
    motion.refusal = MotionRefusal::no_rig;
    return motion;
  }
  const bool has_wheels = prior && prior->kind == PriorKind::wheels;
  const Pose expected_step = has_wheels ? prior->now_from_before : odometry.last_step;
  const Image<std::uint8_t> moving =
      expected_movers(state_.remembered, state_.tracks, odometry.map_from_camera * inverse(expected_step),
                      stamp, *rig_, left.size(), exec_);
  OdometryStep moved = advance_odometry(odometry, {left, stereo.disparity, stereo.confidence, moving}, *rig_,
                                        prior, config_.odometry);
  const Pose before = odometry.map_from_camera;
  odometry = std::move(moved.state);
  motion = moved.motion;
  if (motion.is_new_segment && state_.is_over_floor) {
    if (const auto level = levelled(odometry.map_from_camera, stereo.ground, rig_)) {
      odometry = stood_on_floor(std::move(odometry), *level);
      motion.now_from_before = inverse(*level) * before;
    }
  }
  return motion;
}

void Follower::match_tracks(TrackedFrame& step, const LeftImage& left, const MaskPrediction& predicted,
                            const Covariance6& since_key, const StereoRig& rig) {
  const Frame& frame = step.frame;
  const TrackingConfig& config = config_.tracking;
  const CameraAt camera{step.stamp, step.map_from_camera, since_key, step.is_lost};
  const Overlaps overlaps = overlaps_of(predicted, state_.tracks, frame.objects, frame.disparity);
  const auto detections = detect(frame, left, rig_, config);
  const auto matches = step.is_lost ? std::vector<Assignment>{}
                                    : associate(state_.tracks, detections, overlaps, camera, config);
  state_.tracks = advance_tracks(std::move(state_.tracks), detections, matches, overlaps, camera, config);
  state_.remembered = remember(std::move(state_.remembered), state_.tracks, frame.objects, frame.disparity,
                               step.map_from_camera, step.stamp, rig);
  step.tracks = state_.tracks;
  step.ids = ids_of(state_.tracks, frame.objects, exec_);
}

TrackedFrame Follower::follow(const Seen& seen, Stamp stamp, const Known& known) {
  check(seen, stamp);
  if (state_.before && clock_step(*state_.before, stamp) == ClockStep::set_back) start_again();
  TrackedFrame step;
  step.index = state_.frames;
  step.stamp = stamp;
  const Config& config = config_.segmentation;
  if (!seen.right.empty()) validate(config, seen.size(), rig_.has_value());
  const StereoRig rig = rig_.value_or(picture_rig(seen.size()));
  Covariance6 since_key{};
  MaskPrediction warped;
  // The motion of the camera, and the tracks as predicted for this frame.
  const auto predict = [&](const StereoResult& stereo) {
    step.motion = move_camera(seen.left.gray, stamp, stereo, known);
    step.map_from_camera = state_.odometry.map_from_camera;
    step.pose_covariance = state_.odometry.covariance;
    step.is_lost = state_.odometry.lost;
    since_key = covariance_since_key(state_.odometry);
    state_.tracks = rebased_to_keyframe(std::move(state_.tracks), step.map_from_camera,
                                        state_.odometry.key_covariance, step.motion.is_new_segment);
    warped = warp(state_.remembered, state_.tracks, step.map_from_camera, stamp, rig, seen.size(), exec_);
  };

  // Segment the frame; in a tree of regions, the tracks help to choose the objects.
  Image<std::int16_t> best_right;
  const auto choose = [&](RegionCandidates& found, const ChoiceLimits& limits) {
    predict(found.match.stereo);
    best_right = std::move(found.match.matches.best_right);
    std::vector<float> scores = score_nodes(found.tree, object_classifier(), limits, exec_);
    if (!step.is_lost) {
      scores = repaired_scores(found.tree, std::move(scores), found.superpixels, warped, state_.tracks,
                               config_.repair);
    }
    return choose_candidates(found.tree, scores, limits, config_.tracking.low_confidence);
  };
  step.frame = seen.right.empty()
                   ? ahead_->segment(seen.left, seen.disparity_px, choose)
                   : ahead_->segment(StereoPair::from(seen.left.gray, seen.right, seen.left.rgb), choose);
  if (config.pipeline.method == Method::paper) predict(step.frame);
  state_.size = seen.size();
  state_.before = stamp;
  ++state_.frames;

  match_tracks(step, seen.left, warped, since_key, rig);

  const bool looks_for_floor = config.ground.source == GroundSource::automatic;
  state_.reliability = assess_reliability(
      step, warped, {seen.left.gray, seen.right, best_right, rig_, looks_for_floor, known.scan},
      state_.reliability);
  step.reliability = state_.reliability;
  return step;
}

}  // namespace cairn
