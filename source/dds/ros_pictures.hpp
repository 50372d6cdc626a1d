// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <string>

#include "../../io/image_files.hpp"
#include "../../ros/messages.hpp"

namespace cairn::dds {

/// Both images as the rest of cairn wants them: mono8, rgb8, bgr8, mono16 and their names as plain types
/// (8UC1, 8UC3, 16UC1). Deep ones are reduced as io::load_pair() does, by at least `least_bits` − 8; colours
/// of the right image are dropped. Throws Error, which begins with the topic, for other encodings, and where
/// an image says what its bytes are not, or the two differ in size.
io::PicturePair pictures_of(const ros::Image& left, const std::string& left_topic, const ros::Image& right,
                            const std::string& right_topic, int least_bits, const Pool& pool);

}  // namespace cairn::dds
