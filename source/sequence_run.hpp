// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "../landmarks/map_file.hpp"
#include "../tracking/follower.hpp"
#include "../tracking/trajectory_error.hpp"
#include "laser_scans.hpp"
#include "priors.hpp"
#include "sequence.hpp"

namespace cairn::io {

/// Files of what is known of a sequence beside its images. Of odometry, imu and poses one at most; all are in
/// metres, so the source needs a rig.
struct CompanionFiles {
  std::optional<std::filesystem::path> odometry;
  std::optional<std::filesystem::path> imu;
  std::optional<std::filesystem::path> poses;
  std::optional<std::filesystem::path> scan;
  std::optional<std::filesystem::path> map;
  bool is_map_read_only = false;
  std::optional<Pose> start;  // in the map; none: to be found out
};

/// The odometry's or the gyroscope's motions, whichever is named; none where neither is. `source_name`: what
/// open_sequence() was given. Throws Error as load_odometry() and load_imu() do.
std::unique_ptr<MotionPriors> open_priors(const std::optional<std::filesystem::path>& odometry,
                                          const std::optional<std::filesystem::path>& imu,
                                          const std::string& source_name, const Sequence& source);

/// Follows a source frame by frame, with what is known beside it and what its landmarks say: what `cairn
/// follow` and Python's cairn.follow() both do.
class SequenceRun {
 public:
  /// Opens the files; a map's run begins with the first frame. Throws Error as the readers, MapFile::open()
  /// and Follower do, and where the poses have no stamps. `source` must outlive it.
  SequenceRun(const Sequence& source, std::string source_name, const CompanionFiles& files,
              FollowConfig config, Exec exec);

  /// The next frame of the source. Throws Error as Follower::next() and MapFile::write() do, and where the
  /// known poses have none within 5 ms of its stamp.
  Step next(const SequenceFrame& frame);

  /// What the landmarks make of the last frame; empty without a rig.
  [[nodiscard]] const Landmarked& marked() const { return marked_; }
  [[nodiscard]] const FollowConfig& config() const { return follower_.config(); }
  /// As of Follower.
  void set_config(FollowConfig config) { follower_.set_config(std::move(config)); }
  /// Ends the run in the map. Nothing where there is no map, none is written, or no frame came.
  void close(RunState state);

 private:
  void mark(const Step& step, const SequenceFrame& frame);

  const Sequence& source_;
  std::string source_name_;
  Follower follower_;
  std::unique_ptr<MotionPriors> priors_;
  std::vector<TimedPose> poses_;
  std::string poses_name_;
  std::vector<LaserScan> scans_;
  std::optional<MapFile> map_;  // closed: none
  bool is_map_read_only_ = false;
  std::optional<Pose> start_;
  bool has_begun_ = false;
  Landmarked marked_;
  Stamp before_;
  Pose pose_before_;
};

}  // namespace cairn::io
