// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/ros/messages.hpp>

#include <algorithm>
#include <limits>

namespace cairn::ros {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;  // ns

/// "sensor_msgs/Image" of "sensor_msgs/msg/Image".
std::string short_name(std::string_view type) {
  std::string name(type);
  return name.erase(name.find("/msg"), 4);
}

template <class T>
std::string type_name() {
  if constexpr (Message<T>) {
    return short_name(T::kType);
  } else if constexpr (std::is_same_v<T, std::string>) {
    return "string";
  } else if constexpr (std::is_same_v<T, bool>) {
    return "bool";
  } else if constexpr (std::is_same_v<T, std::byte>) {
    return "byte";
  } else if constexpr (std::is_floating_point_v<T>) {
    return "float" + std::to_string(8 * sizeof(T));
  } else {
    return std::string(std::is_signed_v<T> ? "" : "u") + "int" + std::to_string(8 * sizeof(T));
  }
}

/// A message definition's lines, followed by those of the types that it uses, each once.
class Definitions {
 public:
  template <Message M>
  void add() {
    if (std::find(known_.begin(), known_.end(), M::kType) != known_.end()) return;
    known_.push_back(M::kType);
    if (known_.size() > 1) text_ += std::string(80, '=') + "\nMSG: " + short_name(M::kType) + "\n";
    const M message;
    M::each(message, [this](std::string_view name, const auto& member) { add_line(name, member); });
    M::each(message, [this](std::string_view /*name*/, const auto& member) { add_part(member); });
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  template <class T>
  void add_line(std::string_view name, const T& /*member*/) {
    add_line(type_name<T>(), name);
  }
  template <class T>
  void add_line(std::string_view name, const std::vector<T>& /*member*/) {
    add_line(type_name<T>() + "[]", name);
  }
  template <class T, std::size_t N>
  void add_line(std::string_view name, const std::array<T, N>& /*member*/) {
    add_line(type_name<T>() + "[" + std::to_string(N) + "]", name);
  }
  void add_line(const std::string& type, std::string_view name) {
    text_ += type + " " + std::string(name) + "\n";
  }

  template <class T>
  void add_part(const T& /*member*/) {
    if constexpr (Message<T>) add<T>();
  }
  template <class T>
  void add_part(const std::vector<T>& /*member*/) {
    if constexpr (Message<T>) add<T>();
  }

  std::vector<std::string_view> known_;
  std::string text_;
};

}  // namespace

template <Message M>
std::string schema_of() {
  Definitions definitions;
  definitions.add<M>();
  return definitions.text();
}
template std::string schema_of<Image>();
template std::string schema_of<CompressedImage>();
template std::string schema_of<CameraInfo>();
template std::string schema_of<PointCloud2>();
template std::string schema_of<DisparityImage>();
template std::string schema_of<Detection3DArray>();
template std::string schema_of<OccupancyGrid>();
template std::string schema_of<TFMessage>();
template std::string schema_of<TransformStamped>();
template std::string schema_of<LaserScan>();
template std::string schema_of<Imu>();
template std::string schema_of<Odometry>();
template std::string schema_of<DiagnosticArray>();
template std::string schema_of<Header>();
template std::string schema_of<String>();

Time time_of(Stamp stamp) {
  // Rounds towards −∞, as the nanoseconds are never negative.
  const std::int64_t rest = (stamp.ns % kSecond + kSecond) % kSecond;
  const std::int64_t seconds = (stamp.ns - rest) / kSecond;
  using Limits = std::numeric_limits<std::int32_t>;
  if (seconds < Limits::min() || seconds > Limits::max()) {
    throw Error("stamp: found " + seconds_text(stamp) +
                " s, expected less than 2147483648 s (the limit of ROS messages)");
  }
  return {static_cast<std::int32_t>(seconds), static_cast<std::uint32_t>(rest)};
}

Stamp stamp_of(Time time) {
  return {std::int64_t{time.sec} * kSecond + std::int64_t{time.nanosec}};
}

}  // namespace cairn::ros
