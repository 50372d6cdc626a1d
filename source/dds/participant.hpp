// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "../../ros/cdr.hpp"

/// Topics of ROS 2, spoken by Cyclone DDS without any part of ROS. (docs/ros2.md)
namespace cairn::dds {

/// A handle of Cyclone's (dds_entity_t); deletes what it names.
class Entity {
 public:
  Entity() = default;
  /// Throws Error, which begins with `what`, where Cyclone gave a failure instead of a handle.
  Entity(std::int32_t handle, const std::string& what);
  ~Entity() { reset(); }
  Entity(Entity&& other) noexcept : handle_(std::exchange(other.handle_, 0)) {}
  Entity& operator=(Entity&& other) noexcept;
  Entity(const Entity&) = delete;
  Entity& operator=(const Entity&) = delete;
  void reset();
  [[nodiscard]] std::int32_t handle() const { return handle_; }

 private:
  std::int32_t handle_ = 0;
};

/// Which domain, and how it is set up: what ROS 2 nodes read from their environment.
struct DomainSettings {
  std::uint32_t id = 0;  // ROS_DOMAIN_ID
  /// Cyclone's configuration; empty: its own, with CYCLONEDDS_URI. What CYCLONEDDS_URI says goes before what
  /// ROS_LOCALHOST_ONLY and ROS_AUTOMATIC_DISCOVERY_RANGE say.
  std::string configuration;
};
/// Throws Error where a variable holds what it cannot.
DomainSettings domain_of_environment();

/// One member of a domain; the sockets are open as long as there is one.
class Participant {
 public:
  /// Throws Error where no network interface can be used, or the settings are refused.
  explicit Participant(const DomainSettings& settings = domain_of_environment());
  [[nodiscard]] std::int32_t handle() const { return participant_.handle(); }
  [[nodiscard]] std::uint32_t domain() const { return id_; }

 private:
  std::uint32_t id_;
  std::shared_ptr<Entity> domain_;  // shared by the participants of this process
  Entity participant_;
};

/// "cairn" → "/cairn", "/robot/stereo" as it is. Throws Error, naming `option`, where ROS has no such name.
std::string checked_name(const std::string& name, const std::string& option);
/// "sensor_msgs/msg/Image" → "sensor_msgs::msg::dds_::Image_".
std::string dds_type_name(std::string_view ros_type);
/// The hash of a type's description that nodes from Iron on compare (REP 2016), "RIHS01_…"; empty where it is
/// not known here.
std::string_view type_hash(std::string_view ros_type);

/// RELIABLE, VOLATILE, KEEP_LAST 5: fits readers of every reliability.
class BytesWriter {
 public:
  /// `topic` as ROS has it: "/cairn/objects". Throws Error.
  BytesWriter(const Participant& participant, const std::string& topic, std::string_view ros_type);
  /// Whether anybody listens, in this process or another.
  [[nodiscard]] bool has_reader() const;
  /// False where readers were too slow to take it for 0.1 s.
  bool write(ros::Bytes message);
  /// Until all readers have what was written; false where that is not so in time.
  bool wait_for_readers(std::chrono::nanoseconds timeout) const;

 private:
  Entity topic_;
  Entity writer_;
  const void* type_ = nullptr;
};

/// BEST_EFFORT, VOLATILE, KEEP_LAST 2: fits writers of every reliability. Or RELIABLE with a longer history.
struct ReaderQos {
  bool reliable = false;
  int depth = 2;
};
class BytesReader {
 public:
  /// Throws Error.
  BytesReader(const Participant& participant, const std::string& topic, std::string_view ros_type,
              ReaderQos qos = {});
  /// The next message; none where there is none now.
  std::optional<ros::Bytes> take();
  /// Messages that were sent and never came, or were replaced before they were taken.
  [[nodiscard]] std::uint64_t lost() const;
  [[nodiscard]] bool has_writer() const;
  [[nodiscard]] std::int32_t handle() const { return reader_.handle(); }

 private:
  Entity topic_;
  Entity reader_;
};

/// Waits until one of several readers has a message.
class ReaderWait {
 public:
  ReaderWait(const Participant& participant, const std::vector<const BytesReader*>& readers);
  /// False where nothing came in time.
  bool wait(std::chrono::nanoseconds timeout) const;

 private:
  std::vector<Entity> conditions_;
  Entity waitset_;
};

template <ros::Message M>
class Writer : public BytesWriter {
 public:
  Writer(const Participant& participant, const std::string& topic)
      : BytesWriter(participant, topic, M::kType) {}
  bool write(const M& message) { return BytesWriter::write(ros::encode(message)); }
};

template <ros::Message M>
class Reader : public BytesReader {
 public:
  Reader(const Participant& participant, const std::string& topic, ReaderQos qos = {})
      : BytesReader(participant, topic, M::kType, qos) {}
  /// Throws Error where the bytes are no such message.
  std::optional<M> take() {
    const std::optional<ros::Bytes> bytes = BytesReader::take();
    if (!bytes) return std::nullopt;
    return ros::decode<M>(*bytes);
  }
};

}  // namespace cairn::dds
