// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/pipeline/config.hpp>

#include <cairn/sequence/control.hpp>
#include <cairn/sequence/landmarks_config.hpp>
#include <cairn/sequence/odometry.hpp>
#include <cairn/sequence/repair.hpp>
#include <cairn/sequence/tracks.hpp>

namespace cairn {

/// The configuration of a sequence: one section per stage, and everything in segment().
struct FollowConfig {
  Config segmentation;
  OdometryConfig odometry;
  TrackingConfig tracking;
  RepairConfig repair;
  LandmarksConfig landmarks;
  ControlConfig control;
};

/// Calls visit("match", c.segmentation.match), …, visit("odometry", c.odometry), …
template <class C, class F>
requires requires(C& c) {
  c.odometry;
}
void for_each_section(C& c, F&& visit) {
  for_each_section(c.segmentation, visit);
  visit("odometry", c.odometry);
  visit("tracking", c.tracking);
  visit("repair", c.repair);
  visit("landmarks", c.landmarks);
  visit("control", c.control);
}

/// Like those of Config, see <cairn/pipeline/config.hpp>.
std::vector<OptionInfo> options(const FollowConfig& config);
void set(FollowConfig& config, std::string_view name, std::string_view value);
void require_active(const FollowConfig& config, std::string_view name);
/// Whether the option belongs to sequences, not to segment().
bool is_of_following(std::string_view option);
/// Throws Error if validate(config.segmentation) does, a value is out of range, or two values are
/// incompatible.
void validate(const FollowConfig& config);

}  // namespace cairn
