// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <string>

#include <cairn/io/image_files.hpp>
#include <cairn/ros/messages.hpp>

namespace cairn::io {
struct Raster;
}

/// Images of ROS messages, for recordings, topics and ROS nodes.
namespace cairn::input {

/// The pixels of a message: mono8, mono16, rgb8, bgr8, rgba8, bgra8 and the equivalent plain types (8UC1,
/// 8UC3, 16UC1), without alpha; Bayer patterns of 8 and 16 bits and YUV, which OpenCV converts. Throws Error for other
/// encodings, and if the data contradict the message's description.
io::Raster raster_of(const ros::Image& image);

/// Both images, as load_pair() reads them from files; the colours of the right image are dropped. Throws
/// Error, prefixed with the topic.
io::LoadedPair pictures_of(const ros::Image& left, const std::string& left_topic, const ros::Image& right,
                           const std::string& right_topic, int least_bits, const Pool& pool);
/// The same of a right image whose pixels are known.
io::LoadedPair pictures_of(const ros::Image& left, const std::string& left_topic, const io::Raster& right,
                           const std::string& right_topic, int least_bits, const Pool& pool);

}  // namespace cairn::input
