// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/live/sequence_run.hpp>

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/sequence/first_pose.hpp>
#include <cairn/sequence/stamps.hpp>
#include <cstdlib>
#include <iterator>
#include <utility>

#include <cairn/input/camera/without_password.hpp>
#include <cairn/output/trajectory_files.hpp>

namespace cairn::live {
namespace {

namespace fs = std::filesystem;

std::vector<TimedPose> known_poses(const fs::path& path) {
  output::Trajectory known = output::load_trajectory(path);
  if (!known.has_stamps) {
    throw Error(path.string() +
                ": its poses have no stamps, expected the form of TUM or EuRoC, or a times.txt next to it");
  }
  return std::move(known.poses);
}

/// The pose nearest in time; nullopt without any.
std::optional<Pose> pose_at(const std::vector<TimedPose>& poses, Stamp stamp, const std::string& file) {
  if (poses.empty()) return std::nullopt;
  constexpr std::int64_t kMaxDistance = 5'000'000;  // ns
  auto best = std::ranges::lower_bound(poses, stamp, {}, &TimedPose::stamp);
  if (best == poses.end() ||
      (best != poses.begin() && stamp.ns - std::prev(best)->stamp.ns < best->stamp.ns - stamp.ns))
    --best;
  if (std::abs(best->stamp.ns - stamp.ns) > kMaxDistance)
    throw Error(file + ": has no pose within 5 ms of the stamp " + std::to_string(stamp.ns) + " ns");
  return best->map_from_camera;
}

}  // namespace

SequenceRun::SequenceRun(const input::Sequence& source, std::string source_name, const SensorFiles& files,
                         FollowConfig config, Exec exec)
    : source_(source),
      source_name_(std::move(source_name)),
      follower_(std::move(config), source.rig(), std::move(exec)),
      sensors_(files, source_name_, source),
      is_map_read_only_(files.is_map_read_only),
      start_(files.start) {
  if (files.poses) {
    poses_name_ = files.poses->string();
    poses_ = known_poses(*files.poses);
  }
  if (files.map) {
    map_.emplace(
        MapFile::open(*files.map, is_map_read_only_ ? MapMode::read_only : MapMode::update, source.rig()));
    map_id_ = map_->map_id();
  }
}

void SequenceRun::begin_run(Stamp began, LandmarkMap landmarks, std::int64_t number,
                            const std::optional<Pose>& start) {
  if (map_ && !is_map_read_only_) number = map_->begin_run(input::without_password(source_name_), began);
  marked_.state = begin_landmarks(std::move(landmarks), number, start);
}

TrackedFrame SequenceRun::next(const input::SequenceFrame& frame) {
  std::optional<MotionPrior> prior;
  // Like the follower: stamps are comparable, and unique in the map, within a run only.
  const bool is_set_back = has_begun_ && clock_step(before_, frame.stamp) == ClockStep::set_back;
  if (is_set_back && source_.rig()) {
    if (map_ && !is_map_read_only_) map_->end_run(RunState::done, marked_.state.map);
    begin_run(frame.stamp, std::move(marked_.state.map), marked_.state.run + 1, std::nullopt);
  }
  if (has_begun_ && !is_set_back)
    prior = sensors_.between(before_, frame.stamp, camera_from_level(pose_before_));
  if (frame.after_gap) follower_.forget();
  const std::optional<Pose> pose = pose_at(poses_, frame.stamp, poses_name_);
  const LaserScan* const scan = sensors_.scan_at(frame.stamp);
  TrackedFrame step = frame.disparity_px.empty()
                          ? follower_.next(input::pair_of(frame), frame.stamp, prior, pose, scan)
                          : follower_.next({frame.left.gray, frame.left.rgb}, frame.disparity_px, frame.stamp,
                                           prior, pose, scan);
  if (source_.rig()) mark(step, frame);
  has_begun_ = true;
  before_ = step.stamp;
  pose_before_ = step.map_from_camera;
  return step;
}

void SequenceRun::prefetch(const input::SequenceFrame& frame) {
  if (frame.disparity_px.empty()) follower_.prefetch(input::pair_of(frame));
}

void SequenceRun::mark(const TrackedFrame& step, const input::SequenceFrame& frame) {
  const bool writes = map_ && !is_map_read_only_;
  if (!has_begun_) begin_run(step.stamp, map_ ? map_->load() : LandmarkMap{}, 0, start_);
  const LandmarkFrame seen = landmark_frame(step, *source_.rig(), frame.left.gray, frame.left.rgb);
  marked_ = advance_landmarks(std::move(marked_.state), seen, config().landmarks);
  if (writes) map_->write(seen, marked_);
}

void SequenceRun::close(RunState state) {
  if (map_ && !is_map_read_only_ && has_begun_) map_->end_run(state, marked_.state.map);
  map_.reset();
}

}  // namespace cairn::live
