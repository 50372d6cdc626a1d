// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>

#include <memory>
#include <string>

#include "../../ros/cdr.hpp"

/// A type of Cyclone DDS whose values are bytes in CDR: ros/cdr.hpp is the one encoder, and what it made goes
/// out without another copy. Keyless, as all messages of ROS 2 are.
namespace cairn::dds {

/// `name` as DDS has it: "sensor_msgs::msg::dds_::Image_". The caller owns one reference, which
/// dds_create_topic_sertype() takes over.
ddsi_sertype* make_cdr_type(const std::string& name);

/// A value of that type with one reference, which dds_writecdr() takes over.
ddsi_serdata* make_cdr_data(const ddsi_sertype* type, ros::Bytes bytes);

/// The bytes of a value that dds_takecdr() gave, header included; valid as long as it.
std::span<const std::uint8_t> bytes_of(const ddsi_serdata* data);

}  // namespace cairn::dds
