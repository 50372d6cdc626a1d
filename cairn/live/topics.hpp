// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <cairn/live/live_frame.hpp>
#include <cairn/live/recorder.hpp>
#include <cairn/output/json.hpp>
#include <cairn/ros/cdr.hpp>

/// The topics of a run: one table for recordings, ROS 2 and the live view. Each message is made once a frame and
/// shared by those who want it. Internal. (docs/recordings.md, docs/ros2.md and docs/live_view.md list them)
namespace cairn::live {

/// What a sink knows of the run, and how it wants its messages.
struct MessageForm {
  std::optional<StereoRig> rig = {};
  std::string camera_frame = {};    // frame_id of the left camera; empty: the source's
  int cloud_stride = 1;             // px
  bool marks_holes_as_ros = false;  // min_disparity − 1 instead of NaN
  std::string preset = "default";
  bool tracks = true;  // false: single frames
  std::optional<std::uint64_t> not_published =
      {};  // frames that the sink has skipped so far, for the statistics
};

using Message = std::optional<ros::Bytes>;  // nullopt if the frame lacks the data
using MessagePtr = std::shared_ptr<const ros::Bytes>;

/// When a recording declares a topic.
enum class Announcement : std::uint8_t { always, with_rig, with_first_message };

struct Topic {
  std::string_view name;  // "/tf"; without a slash, below the namespace of cairn: "objects" is /cairn/objects
  std::string_view type;  // of ROS; without a slash, JSON
  std::string (*schema)();
  Message (*make)(const LiveFrame&, const MessageForm&);  // null: by the sink
  // Who wants it:
  bool RecordWhat::*recorded = nullptr;
  int published = 0;  // order of sending on ROS 2, from 1: small ones first; 0: not there
  int viewed = 0;     // number in the live view, from 1; 0: not there
  Announcement declared = Announcement::always;
  // Parts of MessageForm that change it.
  bool has_stride = false;
  bool has_holes = false;
  std::chrono::milliseconds interval{0};  // on ROS 2, at least; 0: with every frame
};

/// In the order of recordings.
std::span<const Topic> topics();
/// Those with a number in `order` (Topic::published or Topic::viewed), by it.
std::vector<const Topic*> topics_by(int Topic::*order);
/// "/cairn/objects"; `name_space` begins with a slash.
std::string full_name(const Topic& topic, const std::string& name_space = "/cairn");
/// Null if the frame lacks the data. Throws Error if a message cannot hold the stamp of the frame, or its image
/// cannot be encoded.
MessagePtr message_of(const Topic& topic, const LiveFrame& frame, const MessageForm& form);

/// /diagnostics while no pair arrives: an error, so many seconds after the last frame.
ros::Bytes silence_message(const LiveFrame& last, const MessageForm& form, double seconds);
constexpr std::string_view kDiagnosticsTopic = "/diagnostics";

/// The frame as in tracks.jsonl; without tracking as in objects.json.
std::shared_ptr<const output::Json> results_of(const LiveFrame& frame, const MessageForm& form);
/// The text of it, with a newline.
std::shared_ptr<const std::string> text_of(const LiveFrame& frame, const MessageForm& form);
/// The left image as JPEG.
std::shared_ptr<const std::string> left_jpeg(const LiveFrame& frame);

}  // namespace cairn::live
