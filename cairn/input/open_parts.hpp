// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/input/sensor_topics.hpp>
#include <cairn/input/sequence.hpp>
#include <cairn/io/load_module.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

/// Sources that are parts of their own (io/load_module.hpp): videos and topics of ROS 2. In a build without
/// them these functions throw Error. Internal.
namespace cairn::input {

/// One video with both images in every frame, according to options.layout.
std::unique_ptr<Sequence> open_video(const std::filesystem::path& file, const SourceOptions& options,
                                     const Pool& pool);
/// One video per camera, paired by stamps; by order if options.rate_hz is given.
std::unique_ptr<Sequence> open_videos(const std::filesystem::path& left, const std::filesystem::path& right,
                                      const SourceOptions& options, const Pool& pool);
/// "ros2:/stereo": the topics /stereo/left/image_rect and so on.
std::unique_ptr<Sequence> open_ros2(const std::string& source, const SourceOptions& options,
                                    const Pool& pool);

/// Topics of other sensors; `camera`: the frame_id of the left images.
std::unique_ptr<LiveSensors> open_sensor_topics(const SensorTopicNames& names, const std::string& camera);

// The entries of the parts; the caller owns the results.

struct VideoRequest {
  std::filesystem::path left;
  std::optional<std::filesystem::path> right;
  SourceOptions options;
  Pool pool;
};
struct Ros2Request {
  std::string source;
  SourceOptions options;
  Pool pool;
};
inline constexpr io::Part kRos2Part{
    "cairn-dds.so", "topics of ROS 2 need", "Cyclone DDS (libddsc0debian)",
    "package cairn-ros2; it is built where cyclonedds-dev is",
    "topics of ROS 2 are not built in: they need Cyclone DDS (cyclonedds-dev)"};

}  // namespace cairn::input

extern "C" {
CAIRN_EXPORT cairn::input::LiveSensors* cairn_open_sensor_topics(const cairn::input::SensorTopicNames& names,
                                                                 const std::string& camera);
CAIRN_EXPORT cairn::input::Sequence* cairn_open_video(const cairn::input::VideoRequest& request);
CAIRN_EXPORT cairn::input::Sequence* cairn_open_ros2(const cairn::input::Ros2Request& request);
}
