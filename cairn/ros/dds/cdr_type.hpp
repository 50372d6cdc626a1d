// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>

#include <memory>
#include <string>
#include <vector>

#include <cairn/ros/cdr.hpp>

/// A Cyclone DDS type whose values are CDR bytes: cairn/ros/cdr.hpp is the only encoder, and its output is sent
/// without another copy. ROS 2 messages have no key; rows of agents have one (key_sizes()).
namespace cairn::ros {

/// `name` as in DDS: "sensor_msgs::msg::dds_::Image_"; `key`: key_sizes() of the message. The caller owns one reference,
/// which dds_create_topic_sertype() takes over.
ddsi_sertype* make_cdr_type(const std::string& name, std::vector<std::uint8_t> key = {});

/// A value of that type with one reference, which dds_writecdr() takes over; nullptr if it is too short for its key.
ddsi_serdata* make_cdr_data(const ddsi_sertype* type, Bytes bytes);

/// The bytes of a value from dds_takecdr(), header included; valid as long as the value. Of one without valid data: the
/// key.
std::span<const std::uint8_t> bytes_of(const ddsi_serdata* data);

}  // namespace cairn::ros
