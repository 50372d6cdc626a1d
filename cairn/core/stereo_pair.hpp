// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/image.hpp>
#include <optional>
#include <vector>

namespace cairn {

/// A rectified pair: the left pixel (x, y) corresponds to the right pixel (x − d, y). Borrows its images.
class StereoPair {
 public:
  /// Throws Error if the sizes differ or an image is empty. `left_rgb` (optional) is the colour of the left
  /// image.
  static StereoPair from(View<const Gray> left, View<const Gray> right, View<const Rgb> left_rgb = {});

  [[nodiscard]] View<const Gray> left() const { return left_; }
  [[nodiscard]] View<const Gray> right() const { return right_; }
  /// Empty if the input had no colour.
  [[nodiscard]] View<const Rgb> left_rgb() const { return left_rgb_; }
  [[nodiscard]] Size size() const { return left_.size(); }

 private:
  StereoPair(View<const Gray> left, View<const Gray> right, View<const Rgb> left_rgb)
      : left_(left), right_(right), left_rgb_(left_rgb) {}
  View<const Gray> left_;
  View<const Gray> right_;
  View<const Rgb> left_rgb_;
};

/// The calibration of a rectified pair. Depth: Z = focal_px · baseline_m / (d + doffs_px).
struct StereoRig {
  float focal_px = 0;
  float cx_px = 0;
  float cy_px = 0;
  float baseline_m = 0;
  float doffs_px = 0;

  /// Throws Error (naming `source`) unless every number is finite and focal length and baseline are positive.
  void validate(const char* source = "rig") const;
  /// The scene point at pixel (x, y) with this disparity, in the left camera's frame (x right, y down, z
  /// forward); nullopt at or beyond infinity: d + doffs ≤ 0, or z exceeds the range of float.
  [[nodiscard]] std::optional<Vec3> point_in_camera_m(float x, float y, float disparity_px) const;
};

/// A scene point seen in both images, in px.
struct PointPair {
  float x_left = 0;
  float y_left = 0;
  float x_right = 0;
  float y_right = 0;
  friend bool operator==(const PointPair&, const PointPair&) = default;
};

/// Prior knowledge of the floor from the mounting of the rig. Part of the calibration file.
struct KnownGround {
  std::vector<PointPair> points;         // on the floor: empty, or at least four, not collinear
  std::optional<float> camera_height_m;  // of the left camera above the floor
  float camera_pitch_deg = 0;            // positive looks down
  float camera_roll_deg = 0;             // positive lowers the camera's right side
  friend bool operator==(const KnownGround&, const KnownGround&) = default;
};

}  // namespace cairn
