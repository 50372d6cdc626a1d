// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/live/sensors.hpp>

#include <cairn/core/error.hpp>

#include <cairn/input/mcap_sequence.hpp>
#include <cairn/input/open_parts.hpp>

namespace cairn::live {
namespace {

namespace fs = std::filesystem;

/// The topics among these files.
input::SensorTopicNames topics_among(const SensorFiles& files) {
  const auto topic = [](const std::optional<fs::path>& file) {
    return file ? input::topic_in(file->string()).value_or("") : "";
  };
  return {topic(files.odometry), topic(files.imu), topic(files.scan)};
}

/// The topics of the recording that the source is. Throws Error if it is none.
input::SensorTopics recorded(const input::SensorTopicNames& names, const std::string& source_name,
                             const input::Sequence& source) {
  const auto recording = input::recording_of(source_name);
  if (!recording) {
    const std::string& topic = !names.odometry.empty() ? names.odometry
                               : !names.imu.empty()    ? names.imu
                                                       : names.scan;
    throw Error("ros2:" + topic + ": is a topic, expected a recording (MCAP) or a live source, found " +
                source.name());
  }
  return input::read_sensor_topics(*recording, names, source.frame_id());
}

}  // namespace

Sensors::Sensors(const SensorFiles& files, const std::string& source_name, const input::Sequence& source) {
  const input::SensorTopicNames topics = topics_among(files);
  const bool is_live = source.status().is_live;
  if (topics.any() && is_live) {
    live_ = input::open_sensor_topics(topics, source.frame_id());
    const std::string& topic = topics.odometry.empty() ? topics.imu : topics.odometry;
    if (!topic.empty()) description_ = "topic " + topic;
  } else if (topics.any()) {
    const input::SensorTopics said = recorded(topics, source_name, source);
    priors_ = said.priors();
    scans_ = said.scans();
    assumptions_ = said.assumptions();
  }
  if (topics.odometry.empty() && topics.imu.empty()) {
    if (files.odometry) {
      priors_ = input::load_odometry(*files.odometry, source_name);
    } else if (files.imu) {
      priors_ = input::load_imu(*files.imu,
                                input::mounting_of_imu(*files.imu, source.rectifier()).value_or(Pose{}));
    }
  }
  if (priors_) description_ = priors_->description();
  if (files.scan && topics.scan.empty()) scans_ = input::load_scans(*files.scan);
}

std::optional<MotionPrior> Sensors::between(Stamp before, Stamp now, const Pose& camera_from_level) const {
  std::optional<MotionPrior> prior;
  if (priors_) prior = priors_->between(before, now, camera_from_level);
  if (live_ && !prior) prior = live_->between(before, now, camera_from_level);
  return prior;
}

const LaserScan* Sensors::scan_at(Stamp moment) {
  live_scan_ = live_ ? live_->scan_at(moment) : std::nullopt;
  return live_scan_ ? &*live_scan_ : input::scan_at(scans_, moment);
}

std::vector<std::string> Sensors::assumptions() const {
  return live_ ? live_->assumptions() : assumptions_;
}

}  // namespace cairn::live
