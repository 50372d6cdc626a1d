// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <string>

#include "../../io/image_files.hpp"
#include "../../ros/messages.hpp"

namespace cairn::dds {

/// Decodes both images: mono8, rgb8, bgr8, mono16 and their names as plain types (8UC1, 8UC3, 16UC1). Deep
/// ones are reduced like in io::load_pair(), by at least `least_bits` − 8; colours of the right image are
/// dropped. Throws Error beginning with the topic for other encodings, for inconsistent image sizes, and if
/// the two differ in size.
io::PicturePair pictures_of(const ros::Image& left, const std::string& left_topic, const ros::Image& right,
                            const std::string& right_topic, int least_bits, const Pool& pool);

}  // namespace cairn::dds
