// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <array>
#include <cairn/core/exec.hpp>
#include <cairn/core/left_image.hpp>
#include <cairn/regions/superpixels.hpp>
#include <cairn/scene/background.hpp>
#include <cairn/scene/ground_plane.hpp>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <vector>

/// The statistics of regions and of their contacts. All sums are integers, so the order of additions does not
/// matter.
namespace cairn {

struct ObjectHint;  // cairn/regions/object_hints.hpp

/// Sums over the hints of a region's pixels, in the units of ObjectHint. Each pixel votes for the centroid of its
/// object, in 1/8 cell from the image centre, and for its size. The weight of a vote is the log-odds for an
/// object + 2, limited to 0 … 4, in 1/16.
struct HintSums {
  std::int64_t object = 0, outline = 0;
  std::int64_t weight = 0, x = 0, y = 0, xx = 0, yy = 0, size = 0;
  /// `pixels`: number of the cell's pixels.
  void add(const ObjectHint& hint, int column, int row, int pixels);
  void add(const HintSums& other);
  friend bool operator==(const HintSums&, const HintSums&) = default;
};

/// The inputs per pixel. Views of one size.
struct Cues {
  LeftImage left;
  View<const float> disparity_px;  // NaN = hole
  View<const float> textured_px;   // the same, NaN where not textured: select_textured()
  const Ground& ground;
  const Background& background;
  View<const ObjectHint> hints = {};  // hint_objects(): of cells, not of pixels; may be empty
};

/// Disparities are in 1/64 px (rounded, halves up), positions in px from the image centre, the pixel
/// (width/2, height/2) rounded down.
inline constexpr int kDisparitySteps = 64;

/// The moments for a least-squares plane of disparity.
struct PlaneMoments {
  std::int64_t n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0, d = 0, xd = 0, yd = 0, dd = 0;
  void add(const PlaneMoments& other);
  friend bool operator==(const PlaneMoments&, const PlaneMoments&) = default;
};

constexpr std::int32_t clamped_height(std::int32_t steps) {
  return std::clamp(steps, -8 * kDisparitySteps, 24 * kDisparitySteps);
}
/// The distances of disparities from a surface, in 1/64 px, clamped to 8 px behind … 24 px in front.
struct Heights {
  std::int64_t n = 0, sum = 0, squares = 0;
  std::int64_t behind = 0, on = 0;  // farther behind than 1 px; within 1 px
  void add(const Heights& other);
  friend bool operator==(const Heights&, const Heights&) = default;
};

/// Number of histogram bins: brightness in steps of 16 grey levels from 0, colour differences in steps of 12
/// from −96; values outside go to the first or last bin.
inline constexpr std::size_t kColourBins = 16;

/// Brightness, (red + 2 green + blue)/4 rounded down, blue − green, red − green.
inline std::array<int, 3> colour_of(const Rgb& p) {
  return {(p.r + 2 * p.g + p.b) / 4, p.b - p.g, p.r - p.g};
}
/// Without colour: grey, 0, 0.
inline std::array<int, 3> colour_of(Gray gray) {
  return {gray, 0, 0};
}
inline std::array<int, 3> colour_at(const Cues& cues, int x, int y) {
  return cues.left.rgb.empty() ? colour_of(cues.left.gray(x, y)) : colour_of(cues.left.rgb(x, y));
}

/// Pixels per bin: of brightness, blue − green, red − green.
using Histogram = std::array<std::int32_t, 3 * kColourBins>;

struct RegionCues {
  std::int64_t area = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  int left = std::numeric_limits<int>::max(), top = std::numeric_limits<int>::max();
  int right = -1, bottom = -1;                             // the last column and row
  std::array<std::int64_t, 4> at_image_border{};           // pixels at the left, right, top, bottom border
  std::array<std::int64_t, 3> colour{}, colour_squares{};  // of colour_at()
  Histogram histogram{};
  std::int64_t texture = 0;                         // sum of the edges inside, in 1/4 grey level
  std::int64_t perimeter = 0;                       // pairs of 4-neighbours with one outside
  PlaneMoments matched{}, textured{};               // all disparities; the textured ones
  Heights above_ground{}, textured_above_ground{};  // where the disparity of the ground is positive
  Heights before_background{}, textured_before_background{};
  HintSums hints{};
  /// `common`: number of neighbour pairs between the two.
  void add(const RegionCues& other, std::int64_t common);
  friend bool operator==(const RegionCues&, const RegionCues&) = default;
};

/// The contact of two regions, a < b among superpixels. Steps are those of a over b. The edge between two
/// pixels is the stronger one of theirs, 0 below 1.5 grey levels + 0.8 noise_sigma.
struct ContactCues {
  std::int32_t a = 0, b = 0;
  std::int64_t length = 0, edge_sum = 0,
               weak = 0;        // pairs of neighbours; 1/4 grey level; pairs without an edge
  std::int64_t x2 = 0, y2 = 0;  // midpoints of the pairs, in half pixels from the image centre
  std::int64_t outline = 0;     // hints: the greater of each pair
  std::int64_t near_n = 0, near_sum = 0, near_abs = 0;  // steps between the two pixels, in 1/64 px
  // Between pixels up to three further away from the contact, within the same superpixels along a straight
  // line:
  std::int64_t far_n = 0, far_sum = 0, far_abs = 0;
  std::int64_t nearer = 0, farther = 0,
               level = 0;  // of the far pairs: steps above 1 px, below −1 px, between
  /// `turned`: a of the other contact is b of this one.
  void add(const ContactCues& other, bool turned);
  friend bool operator==(const ContactCues&, const ContactCues&) = default;
};

struct RegionGraphCues {
  std::vector<RegionCues> regions;
  std::vector<ContactCues> contacts;  // in raster order of occurrence, to the right before down
};

RegionGraphCues gather_cues(const Superpixels& superpixels, const Cues& cues, const Exec& exec);

}  // namespace cairn
