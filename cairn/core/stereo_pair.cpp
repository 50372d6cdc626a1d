// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/error.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cmath>
#include <string>

namespace cairn {

StereoPair StereoPair::from(View<const Gray> left, View<const Gray> right, View<const Rgb> left_rgb) {
  if (left.empty()) throw Error("left image: found an empty image, expected at least 1x1 pixels");
  if (left.size() != right.size()) {
    throw Error("stereo pair: left image is " + text(left.size()) + ", right image is " + text(right.size()) +
                "; a rectified pair has equal sizes");
  }
  if (!left_rgb.empty() && left_rgb.size() != left.size()) {
    throw Error("stereo pair: the colour of the left image is " + text(left_rgb.size()) + ", its grey " +
                text(left.size()));
  }
  return {left, right, left_rgb};
}

void StereoRig::validate(const char* source) const {
  const auto check = [source](const char* name, float value, bool positive) {
    if (!std::isfinite(value) || (positive && value <= 0)) {
      throw Error(std::string(source) + ": " + name + " is " + std::to_string(value) + ", expected a " +
                  (positive ? "positive" : "finite") + " number");
    }
  };
  check("focal length", focal_px, true);
  check("baseline", baseline_m, true);
  check("cx", cx_px, false);
  check("cy", cy_px, false);
  check("doffs", doffs_px, false);
}

std::optional<Vec3> StereoRig::point_in_camera_m(float x, float y, float disparity_px) const {
  const float shift = disparity_px + doffs_px;
  if (!(shift > 0)) return std::nullopt;
  const float z = focal_px * baseline_m / shift;
  if (!std::isfinite(z)) return std::nullopt;
  return Vec3{(x - cx_px) * z / focal_px, (y - cy_px) * z / focal_px, z};
}

}  // namespace cairn
