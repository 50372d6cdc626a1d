// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>

#include <memory>
#include <string>

#include <cairn/ros/cdr.hpp>

/// A Cyclone DDS type whose values are CDR bytes: cairn/ros/cdr.hpp is the only encoder, and its output is sent
/// without another copy. Keyless, like all ROS 2 messages.
namespace cairn::ros {

/// `name` as in DDS: "sensor_msgs::msg::dds_::Image_". The caller owns one reference, which
/// dds_create_topic_sertype() takes over.
ddsi_sertype* make_cdr_type(const std::string& name);

/// A value of that type with one reference, which dds_writecdr() takes over.
ddsi_serdata* make_cdr_data(const ddsi_sertype* type, Bytes bytes);

/// The bytes of a value from dds_takecdr(), header included; valid as long as the value.
std::span<const std::uint8_t> bytes_of(const ddsi_serdata* data);

}  // namespace cairn::ros
