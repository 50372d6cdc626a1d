// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include <cairn/ros/mcap.hpp>

/// The stereo topics of a recording; internal to source.
namespace cairn::input {

struct StereoTopics {
  ros::McapChannel left;
  ros::McapChannel right;                    // or, with has_depth, the depth or disparity image
  std::optional<ros::McapChannel> checking;  // with has_depth: the right image that checks it
  std::optional<std::uint16_t> left_grey;    // the grey of left images if not derivable from colours
  std::optional<std::uint16_t> left_info;
  std::optional<std::uint16_t> right_info;
  bool is_raw = false;  // by the topic name
  /// By its type or because it was found as one; a named image may still be one.
  bool has_depth = false;
};

/// Finds the pair by type and name ("left" and "right", "infra1" and "infra2", "cam0" and "cam1"): rectified
/// before raw images, uncompressed before compressed ones, colour before grey. Without a pair, a depth or disparity
/// image and the image that it belongs to. `wanted`: SourceOptions::topics. `file`: for messages.
/// Throws Error if there is no pair, or more than one.
StereoTopics find_stereo_topics(const std::map<std::uint16_t, ros::McapChannel>& channels,
                                const std::string& wanted, const std::string& file);

}  // namespace cairn::input
