// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/sensor_topics.hpp>

#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <span>
#include <type_traits>
#include <utility>

#include <cairn/ros/from_step.hpp>
#include <cairn/ros/mcap.hpp>
#include <cairn/sequence/stamps.hpp>

namespace cairn::input {
namespace {

constexpr std::int64_t kKept_ns = 10'000'000'000;

Pose pose_of_message(const ros::Vector3& t, const ros::Quaternion& q) {
  return pose_of({t.x, t.y, t.z}, {q.x, q.y, q.z, q.w});
}

/// Whether all numbers are finite and the quaternion is not 0.
bool is_sound(const ros::Vector3& t, const ros::Quaternion& q) {
  const double squares = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
  return std::isfinite(t.x + t.y + t.z) && std::isfinite(squares) && squares > 1e-6;
}

/// tf allows a leading slash, which names the same frame.
std::string frame_named(const std::string& name) {
  return name.starts_with('/') ? name.substr(1) : name;
}

/// Whether a list that ends with `last` goes on with `now`. Clears it where the clock was set back.
template <class Clear>
bool goes_on(std::optional<Stamp> last, Stamp now, const Clear& clear) {
  const ClockStep step = last ? clock_step(*last, now) : ClockStep::forward;
  if (step == ClockStep::set_back) clear();
  return step != ClockStep::repeated;
}

Point3 cross(Point3 a, Point3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

}  // namespace

std::optional<std::string> topic_in(const std::string& option) {
  constexpr std::string_view kPrefix = "ros2:";
  if (!option.starts_with(kPrefix)) return std::nullopt;
  const std::string name = option.substr(kPrefix.size());
  return name.starts_with('/') ? name : "/" + name;
}

// ---- transforms ----

void StaticTransforms::add(const ros::TFMessage& message) {
  for (const ros::TransformStamped& one : message.transforms) {
    if (!is_sound(one.transform.translation, one.transform.rotation)) continue;
    by_child_[frame_named(one.child_frame_id)] = {
        frame_named(one.header.frame_id), pose_of_message(one.transform.translation, one.transform.rotation)};
  }
}

std::vector<std::pair<std::string, Pose>> StaticTransforms::ancestors(const std::string& frame) const {
  std::vector<std::pair<std::string, Pose>> all{{frame_named(frame), Pose{}}};
  // Not longer than the number of frames: links may form a circle.
  while (all.size() <= by_child_.size()) {
    const auto link = by_child_.find(all.back().first);
    if (link == by_child_.end()) break;
    all.emplace_back(link->second.parent, link->second.parent_from_child * all.back().second);
  }
  return all;
}

std::optional<Pose> StaticTransforms::between(const std::string& target, const std::string& source) const {
  const auto from_source = ancestors(source);
  for (const auto& [frame, frame_from_target] : ancestors(target)) {
    const auto common =
        std::ranges::find(from_source, frame, [](const auto& ancestor) { return ancestor.first; });
    if (common != from_source.end()) return inverse(frame_from_target) * common->second;
  }
  return std::nullopt;
}

// ---- messages ----

SensorTopics::SensorTopics(std::string camera)
    : camera_(camera.empty() ? ros::FrameNames{}.camera : std::move(camera)) {}

void SensorTopics::add(const ros::Odometry& message) {
  const auto& [position, orientation] = message.pose.pose;
  const ros::Vector3 place{position.x, position.y, position.z};
  if (!is_sound(place, orientation)) return;
  const Stamp stamp = ros::stamp_of(message.header.stamp);
  const auto last = poses_.empty() ? std::nullopt : std::optional(poses_.back().stamp);
  if (!goes_on(last, stamp, [&] { poses_.clear(), ++set_back_; })) return;
  robot_frame_ = message.child_frame_id;
  poses_.push_back({stamp, pose_of_message(place, orientation)});
}

void SensorTopics::add(const ros::Imu& message) {
  const Stamp stamp = ros::stamp_of(message.header.stamp);
  const auto last = rates_.stamps.empty() ? std::nullopt : std::optional(rates_.stamps.back());
  if (!goes_on(last, stamp, [&] { rates_ = {}, ++set_back_; })) return;
  const auto& [w, a] = std::pair(message.angular_velocity, message.linear_acceleration);
  imu_frame_ = message.header.frame_id;
  rates_.stamps.push_back(stamp);
  rates_.rates_rad_s.push_back({w.x, w.y, w.z});
  rates_.accelerations_m_s2.push_back({a.x, a.y, a.z});
  // As of a file: from the first half second, which is complete with the first later message.
  if (has_judged_bias_ || seconds_between(rates_.stamps.front(), stamp) < 0.5) return;
  has_judged_bias_ = true;
  bias_ = bias_at_rest(rates_);
}

void SensorTopics::add(const ros::LaserScan& message) {
  const auto last = scans_.empty() ? std::nullopt : std::optional(ros::stamp_of(scans_.back().header.stamp));
  if (goes_on(last, ros::stamp_of(message.header.stamp), [&] { scans_.clear(), ++set_back_; }))
    scans_.push_back(message);
}

void SensorTopics::add(const ros::TFMessage& message) {
  transforms_.add(message);
}

void SensorTopics::forget_old() {
  const auto old_of = [](const auto& list, auto&& stamp_of) {
    const auto is_new = [&](const auto& one) {
      return stamp_of(list.back()).ns - stamp_of(one).ns <= kKept_ns;
    };
    return std::ranges::find_if(list, is_new) - list.begin();
  };
  const auto of_scan = [](const ros::LaserScan& scan) { return ros::stamp_of(scan.header.stamp); };
  poses_.erase(poses_.begin(), poses_.begin() + old_of(poses_, [](const RobotPose& p) { return p.stamp; }));
  scans_.erase(scans_.begin(), scans_.begin() + old_of(scans_, of_scan));
  const auto old = old_of(rates_.stamps, [](Stamp stamp) { return stamp; });
  rates_.stamps.erase(rates_.stamps.begin(), rates_.stamps.begin() + old);
  for (auto* list : {&rates_.rates_rad_s, &rates_.accelerations_m_s2})
    list->erase(list->begin(), list->begin() + old);
}

std::optional<Stamp> SensorTopics::newest_motion() const {
  if (!poses_.empty()) return poses_.back().stamp;
  return rates_.stamps.empty() ? std::nullopt : std::optional(rates_.stamps.back());
}
std::optional<Stamp> SensorTopics::newest_scan() const {
  return scans_.empty() ? std::nullopt : std::optional(ros::stamp_of(scans_.back().header.stamp));
}

// ---- what they say ----

std::optional<Pose> SensorTopics::camera_from(const std::string& frame) const {
  return transforms_.between(camera_, frame);
}

PoseRows SensorTopics::pose_rows() const {
  PoseRows rows;
  const std::optional<Pose> camera_from_robot = camera_from(robot_frame_);
  rows.is_of_robot = !camera_from_robot;
  const Pose robot_from_camera = camera_from_robot ? inverse(*camera_from_robot) : Pose{};
  for (const RobotPose& pose : poses_) {
    rows.stamps.push_back(pose.stamp);
    rows.world_from_camera.push_back(camera_from_robot ? pose.world_from_robot * robot_from_camera
                                                       : level_camera_of(pose.world_from_robot));
  }
  return rows;
}

std::unique_ptr<MotionPriors> SensorTopics::priors() const {
  if (poses_.size() > 1) return priors_of(pose_rows());
  if (rates_.stamps.size() < 2) return nullptr;
  return priors_of(rates_, has_judged_bias_ ? bias_ : bias_at_rest(rates_),
                   camera_from(imu_frame_).value_or(Pose{}));
}

std::vector<LaserScan> SensorTopics::scans() const {
  std::vector<LaserScan> all;
  for (const ros::LaserScan& scan : scans_) all.push_back(scan_of(scan, camera_from(scan.header.frame_id)));
  return all;
}

std::optional<LaserScan> SensorTopics::scan_at(Stamp moment) const {
  std::vector<LaserScan> stamps;
  for (const ros::LaserScan& scan : scans_)
    stamps.push_back({ros::stamp_of(scan.header.stamp), 0, 0, {}, {}});
  const LaserScan* const nearest = input::scan_at(stamps, moment);
  if (nearest == nullptr) return std::nullopt;
  const ros::LaserScan& scan = scans_[static_cast<std::size_t>(nearest - stamps.data())];
  return scan_of(scan, camera_from(scan.header.frame_id));
}

void SensorTopics::check(const SensorTopicNames& names) const {
  if (!names.odometry.empty()) check_rows(pose_rows(), names.odometry);
  if (!names.imu.empty()) check_rows(rates_, names.imu);
  if (!names.scan.empty() && scans_.empty()) throw Error(names.scan + ": has no scan");
}

std::vector<std::string> SensorTopics::assumptions() const {
  std::vector<std::string> all;
  const auto add = [&](bool is_used, const std::string& frame, const std::string& assumed) {
    if (is_used && !camera_from(frame))
      all.push_back("/tf_static has no transform from " + frame + " to " + camera_ + ": " + assumed);
  };
  add(!poses_.empty(), robot_frame_, "the camera is assumed at the centre of the robot, looking ahead");
  add(!rates_.stamps.empty(), imu_frame_, "the axes of the gyroscope are taken for the camera's");
  if (!scans_.empty()) add(true, scans_.back().header.frame_id, "the laser is assumed at the camera");
  if (set_back_ > 0) {
    all.push_back("the clock of other sensors was set back " + std::to_string(set_back_) +
                  (set_back_ == 1 ? " time" : " times") + ": what they said before it is not used");
  }
  if (damaged_ > 0) all.push_back(std::to_string(damaged_) + " damaged messages of other sensors ignored");
  return all;
}

LaserScan scan_of(const ros::LaserScan& message, const std::optional<Pose>& camera_from_laser) {
  LaserScan scan{ros::stamp_of(message.header.stamp), message.angle_min, message.angle_increment, {}, {}};
  for (const float range : message.ranges) {
    const bool has_echo = range >= message.range_min && range <= message.range_max;
    scan.ranges_m.push_back(has_echo ? range : std::numeric_limits<float>::quiet_NaN());
  }
  if (!camera_from_laser) return scan;
  // The plane of the scan is level: its normal, turned upwards, is up.
  Point3 up = camera_from_laser->rotated({0, 0, 1});
  const double sign = up.y < 0 ? 1 : -1;  // y of the camera points down; -1: mounted upside down
  up = sign * up;
  const Point3 ahead = Point3{0, 0, 1} - dot({0, 0, 1}, up) * up;
  if (length(ahead) < 1e-3) return scan;  // the camera looks along the normal: no heading
  const Point3 forward = (1 / length(ahead)) * ahead;
  const Point3 left = cross(up, forward);
  const Point3 first = camera_from_laser->rotated({1, 0, 0});
  scan.first_rad = std::atan2(dot(first, left), dot(first, forward)) + sign * double{message.angle_min};
  scan.step_rad = sign * double{message.angle_increment};
  const Point3 place = camera_from_laser->translation_m;
  scan.in_level_camera_m = {-dot(place, left), -dot(place, up), dot(place, forward)};
  return scan;
}

// ---- recordings ----

SensorTopics read_sensor_topics(const std::filesystem::path& recording, const SensorTopicNames& names,
                                const std::string& camera) {
  ros::McapReader reader(recording);
  const auto channel_of = [&](const std::string& topic, std::string_view type) {
    const auto found = std::ranges::find_if(reader.channels(),
                                            [&](const auto& entry) { return entry.second.topic == topic; });
    if (found == reader.channels().end()) throw Error(recording.string() + ": has no topic " + topic);
    if (found->second.type != type) {
      throw Error(recording.string() + ": " + topic + " is " + found->second.type + ", expected " +
                  std::string(type));
    }
    return found->first;
  };
  SensorTopics topics(camera);
  std::map<std::uint16_t, std::function<void(std::span<const std::uint8_t>)>> adds;
  const auto read = [&]<class M>(const std::string& topic, std::type_identity<M>) {
    if (topic.empty()) return;
    adds[channel_of(topic, M::kType)] = [&](std::span<const std::uint8_t> bytes) {
      topics.add(ros::decode<M>(bytes));
    };
  };
  read(names.odometry, std::type_identity<ros::Odometry>{});
  read(names.imu, std::type_identity<ros::Imu>{});
  read(names.scan, std::type_identity<ros::LaserScan>{});
  for (const auto& [id, channel] : reader.channels()) {
    if (channel.topic == "/tf_static" && channel.type == ros::TFMessage::kType)
      read(channel.topic, std::type_identity<ros::TFMessage>{});
  }
  std::vector<std::uint16_t> wanted;
  wanted.reserve(adds.size());
  for (const auto& [id, add] : adds) wanted.push_back(id);
  reader.only(wanted);
  while (const auto message = reader.next()) {
    try {
      adds.at(message->channel)(message->bytes);
    } catch (const Error&) {
      topics.add_damaged();
    }
  }
  try {
    topics.check(names);
  } catch (const Error& error) {
    throw Error(recording.string() + ": " + error.what());
  }
  return topics;
}

}  // namespace cairn::input
