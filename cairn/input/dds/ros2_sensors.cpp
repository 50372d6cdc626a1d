// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/dds/ros2_sensors.hpp>

#include <cairn/core/error.hpp>
#include <chrono>
#include <cmath>
#include <optional>

#include <cairn/io/text_lines.hpp>
#include <cairn/ros/dds/participant.hpp>

namespace cairn::input {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kLongestWait = 50ms;
constexpr auto kNotice = 5ms;
/// A sensor this far behind the frames is silent, or has another clock: waiting would not help.
constexpr double kSilent_s = 1;

template <ros::Message M>
std::optional<ros::Reader<M>> reader_of(const ros::Participant& participant, const std::string& topic,
                                        const char* option, int depth) {
  if (topic.empty()) return std::nullopt;
  return std::optional<ros::Reader<M>>(std::in_place, participant, ros::checked_name(topic, option),
                                       ros::ReaderQos{.depth = depth});
}

class Ros2Sensors : public LiveSensors {
 public:
  Ros2Sensors(const SensorTopicNames& names, const std::string& camera)
      : names_(names),
        odometry_(reader_of<ros::Odometry>(participant_, names.odometry, "--odometry", 500)),
        imu_(reader_of<ros::Imu>(participant_, names.imu, "--imu", 2000)),
        scan_(reader_of<ros::LaserScan>(participant_, names.scan, "--scan", 50)),
        transforms_(participant_, "/tf_static", {.reliable = true, .depth = 100, .latched = true}),
        wait_(participant_, readers()),
        topics_(camera) {}

  std::optional<MotionPrior> between(Stamp before, Stamp now, const Pose& camera_from_level) override {
    if (!odometry_ && !imu_) return std::nullopt;
    asked_ = now;
    wait_until([&] { return topics_.newest_motion() >= now; },
               [&] { return is_silent(topics_.newest_motion(), now); });
    const auto priors = topics_.priors();
    return priors ? priors->between(before, now, camera_from_level) : std::nullopt;
  }

  std::optional<LaserScan> scan_at(Stamp moment) override {
    if (!scan_) return std::nullopt;
    asked_ = moment;
    std::optional<LaserScan> nearest;
    const auto look = [&] {
      nearest = topics_.scan_at(moment);
      return nearest || topics_.newest_scan() >= moment;
    };
    wait_until(look, [&] { return is_silent(topics_.newest_scan(), moment); });
    return nearest;
  }

  [[nodiscard]] std::vector<std::string> assumptions() const override {
    std::vector<std::string> all = topics_.assumptions();
    const auto check = [&](const std::string& topic, std::optional<Stamp> newest) {
      if (topic.empty()) return;
      if (!newest) {
        all.push_back(topic + ": received nothing in domain " + std::to_string(participant_.domain()));
      } else if (asked_ && std::abs(seconds_between(*newest, *asked_)) > kSilent_s) {
        all.push_back(topic + ": its stamps are " + io::text_of("%.3g s", seconds_between(*asked_, *newest)) +
                      " from those of the images");
      }
    };
    check(names_.odometry, topics_.newest_motion());
    check(names_.imu, topics_.newest_motion());
    check(names_.scan, topics_.newest_scan());
    return all;
  }

 private:
  static bool is_silent(std::optional<Stamp> newest, Stamp now) {
    return !newest || seconds_between(*newest, now) > kSilent_s;
  }

  [[nodiscard]] std::vector<const ros::BytesReader*> readers() const {
    std::vector<const ros::BytesReader*> all{&transforms_};
    if (odometry_) all.push_back(&*odometry_);
    if (imu_) all.push_back(&*imu_);
    if (scan_) all.push_back(&*scan_);
    return all;
  }

  /// Takes what has arrived until `is_there` or there is no point in waiting.
  template <class IsThere, class IsHopeless>
  void wait_until(const IsThere& is_there, const IsHopeless& is_hopeless) {
    const Clock::time_point deadline = Clock::now() + kLongestWait;
    take();
    while (!is_there() && !is_hopeless() && Clock::now() < deadline) {
      wait_.wait(kNotice);
      take();
    }
  }

  void take() {
    take_from(transforms_);
    if (odometry_) take_from(*odometry_);
    if (imu_) take_from(*imu_);
    if (scan_) take_from(*scan_);
    topics_.forget_old();
  }
  template <ros::Message M>
  void take_from(ros::Reader<M>& reader) {
    while (true) {
      try {
        const std::optional<M> message = reader.take();
        if (!message) return;
        topics_.add(*message);
      } catch (const Error&) {  // any node may publish on a topic
        topics_.add_damaged();
      }
    }
  }

  SensorTopicNames names_;
  std::optional<Stamp> asked_;  // of the last frame
  ros::Participant participant_;
  std::optional<ros::Reader<ros::Odometry>> odometry_;
  std::optional<ros::Reader<ros::Imu>> imu_;
  std::optional<ros::Reader<ros::LaserScan>> scan_;
  ros::Reader<ros::TFMessage> transforms_;
  ros::ReaderWait wait_;
  SensorTopics topics_;
};

}  // namespace

std::unique_ptr<LiveSensors> ros2_sensors(const SensorTopicNames& names, const std::string& camera) {
  return std::make_unique<Ros2Sensors>(names, camera);
}

}  // namespace cairn::input
