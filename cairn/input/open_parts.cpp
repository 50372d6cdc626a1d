// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/camera/gst_camera.hpp>
#include <cairn/input/open_parts.hpp>

namespace cairn::input {
namespace {

namespace fs = std::filesystem;

/// FFmpeg and the dependencies of OpenCV's video module are 200 libraries, which take a quarter of a second
/// to load.
constexpr io::Part kVideo{
    "cairn-video.so", "videos need", "OpenCV's videoio (libopencv-videoio)",
    "package cairn-video; it is built where libopencv-videoio-dev is",
    "videos are not built in: they need OpenCV's videoio (libopencv-videoio-dev); a folder of images can be read"};
constexpr io::Part kGstreamer{
    "cairn-gstreamer.so", "they need", "GStreamer (libgstreamer-plugins-base1.0-0)",
    "package cairn-gstreamer; it is built where libgstreamer-plugins-base1.0-dev is",
    "not built in: they need GStreamer (libgstreamer1.0-dev libgstreamer-plugins-base1.0-dev); v4l2:/dev/video0 can "
    "be read"};

std::unique_ptr<Sequence> open(const VideoRequest& request) {
  const auto entry = CAIRN_ENTRY(CAIRN_HOW_VIDEO, cairn_open_video, kVideo, request.left.string());
  return std::unique_ptr<Sequence>(entry(request));
}

}  // namespace

std::unique_ptr<Sequence> open_video(const fs::path& file, const SourceOptions& options, const Pool& pool) {
  return open({file, {}, options, pool});
}

std::unique_ptr<Sequence> open_videos(const fs::path& left, const fs::path& right,
                                      const SourceOptions& options, const Pool& pool) {
  return open({left, right, options, pool});
}

std::unique_ptr<Camera> open_gst(const GstRequest& request) {
  const auto entry = CAIRN_ENTRY(CAIRN_HOW_GSTREAMER, cairn_open_gst, kGstreamer, "pipelines");
  return std::unique_ptr<Camera>(entry(request));
}

std::unique_ptr<Sequence> open_ros2(const std::string& source, const SourceOptions& options,
                                    const Pool& pool) {
  const auto entry = CAIRN_ENTRY(CAIRN_HOW_DDS, cairn_open_ros2, kRos2Part, source);
  return std::unique_ptr<Sequence>(entry({source, options, pool}));
}

std::unique_ptr<LiveSensors> open_sensor_topics(const SensorTopicNames& names, const std::string& camera) {
  const auto entry = CAIRN_ENTRY(CAIRN_HOW_DDS, cairn_open_sensor_topics, kRos2Part, "other sensors");
  return std::unique_ptr<LiveSensors>(entry(names, camera));
}

}  // namespace cairn::input
