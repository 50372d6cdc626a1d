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

#include <cairn/ros/cdr.hpp>

/// ROS 2 topics through Cyclone DDS, without any part of ROS. (docs/ros2.md)
namespace cairn::ros {

/// An owning handle of Cyclone (dds_entity_t).
class Entity {
 public:
  Entity() = default;
  /// Throws Error beginning with `what` if the handle is a Cyclone error code.
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

/// The domain and its configuration, from the environment variables of ROS 2 nodes.
struct DomainSettings {
  std::uint32_t id = 0;  // ROS_DOMAIN_ID
  /// The Cyclone configuration; empty: its default, with CYCLONEDDS_URI. CYCLONEDDS_URI overrides
  /// ROS_LOCALHOST_ONLY and ROS_AUTOMATIC_DISCOVERY_RANGE.
  std::string configuration;
  bool is_own = false;  // refused if this process is in the domain with another configuration
};
/// Throws Error if a variable has an invalid value.
DomainSettings domain_of_environment();
/// The domain that agents share: this computer only, or the network of `interface`, if given ("wlan0"). Members that were
/// cut off are found again within a second. CYCLONEDDS_URI overrides it, as all of Cyclone's settings. Throws Error for a
/// domain without ports.
DomainSettings domain_of_fleet(std::uint32_t id, const std::string& interface);

/// A member of a domain; sockets are open while one exists.
class Participant {
 public:
  /// Throws Error if no network interface is usable, or the settings are refused.
  explicit Participant(const DomainSettings& settings = domain_of_environment());
  [[nodiscard]] std::int32_t handle() const { return participant_.handle(); }
  [[nodiscard]] std::uint32_t domain() const { return id_; }

 private:
  std::uint32_t id_;
  std::shared_ptr<Entity> domain_;  // shared by the participants of this process
  Entity participant_;
};

/// "cairn" → "/cairn", "/robot/stereo" unchanged. Throws Error naming `option` for an invalid ROS name.
std::string checked_name(const std::string& name, const std::string& option);
/// "sensor_msgs/msg/Image" → "sensor_msgs::msg::dds_::Image_".
std::string dds_type_name(std::string_view ros_type);
/// The hash of the type description that nodes compare since Iron (REP 2016), "RIHS01_…"; empty if unknown
/// here.
std::string_view type_hash(std::string_view ros_type);

/// The type of a topic.
struct TopicType {
  std::string_view ros;           // "sensor_msgs/msg/Image"
  std::vector<std::uint8_t> key;  // key_sizes()
};
template <Message M>
TopicType topic_type() {
  return {M::kType, key_sizes<M>()};
}

/// RELIABLE, VOLATILE, KEEP_LAST 5: compatible with readers of any reliability. `depth`: of each instance; latched:
/// later readers receive the last ones, too.
struct WriterQos {
  bool latched = false;
  int depth = 5;
  /// Readers notice within this time that write() and assert_alive() are no longer called.
  std::optional<std::chrono::nanoseconds> lease = std::nullopt;
};
class BytesWriter {
 public:
  /// `topic` as in ROS: "/cairn/objects". Throws Error.
  BytesWriter(const Participant& participant, const std::string& topic, const TopicType& type,
              WriterQos qos = {});
  /// Whether there is a subscriber, in this process or another.
  [[nodiscard]] bool has_reader() const;
  /// False if readers were too slow to accept it for 0.1 s, or the message is too short for its key.
  bool write(Bytes message);
  void assert_alive() const;
  /// Waits until all readers have received everything written; false on timeout.
  bool wait_for_readers(std::chrono::nanoseconds timeout) const;

 private:
  Entity topic_;
  Entity writer_;
  const void* type_ = nullptr;
};

/// BEST_EFFORT, VOLATILE, KEEP_LAST 2: compatible with writers of any reliability. Or RELIABLE with a longer
/// history; latched: TRANSIENT_LOCAL, with what was sent before it, such as /tf_static.
struct ReaderQos {
  bool reliable = false;
  int depth = 2;
  bool latched = false;
};
class BytesReader {
 public:
  /// Throws Error.
  BytesReader(const Participant& participant, const std::string& topic, const TopicType& type,
              ReaderQos qos = {});
  /// The next message; nullopt if there is none now.
  std::optional<Bytes> take();
  /// The next change of an instance: a message, that its writers have gone or are not alive, or both.
  struct Change {
    Bytes bytes;  // of the message, else of the key alone
    bool has_message = true;
    bool is_alive = true;
  };
  std::optional<Change> take_change();
  /// Messages that were sent but not received, or replaced before they were taken.
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
  /// False on timeout.
  bool wait(std::chrono::nanoseconds timeout) const;

 private:
  std::vector<Entity> conditions_;
  Entity waitset_;
};

template <Message M>
class Writer : public BytesWriter {
 public:
  Writer(const Participant& participant, const std::string& topic, WriterQos qos = {})
      : BytesWriter(participant, topic, topic_type<M>(), qos) {}
  bool write(const M& message) { return BytesWriter::write(encode(message)); }
};

template <Message M>
class Reader : public BytesReader {
 public:
  Reader(const Participant& participant, const std::string& topic, ReaderQos qos = {})
      : BytesReader(participant, topic, topic_type<M>(), qos) {}
  /// Throws Error if the bytes are not such a message.
  std::optional<M> take() {
    const std::optional<Bytes> bytes = BytesReader::take();
    if (!bytes) return std::nullopt;
    return decode<M>(*bytes);
  }
};

}  // namespace cairn::ros
