// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <array>
#include <cairn/core/exec.hpp>
#include <cairn/grouping/superpixels.hpp>
#include <cairn/scene/background.hpp>
#include <cairn/scene/ground_plane.hpp>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <vector>

/// What regions and the contacts between them are judged by. All sums are of whole numbers, so that it does
/// not matter in which order pixels and regions were added.
namespace cairn {

/// What is known of each pixel. Views of the same size; `rgb` may be empty.
struct Cues {
  View<const Gray> gray;
  View<const Rgb> rgb;
  View<const float> disparity_px;  // NaN = hole
  View<const float> evidence_px;   // of these, what texture vouches for: find_evidence()
  const Ground& ground;
  const Background& background;
  float noise_sigma = 0;  // grey levels
};

/// Disparities are counted in 1/64 px (rounded, halves up), positions in px from the image's centre, which is
/// the pixel (width/2, height/2) rounded down.
inline constexpr int kDisparitySteps = 64;

/// Sums that a plane of disparity is fitted to.
struct PlaneMoments {
  std::int64_t n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0, d = 0, xd = 0, yd = 0, dd = 0;
  void add(const PlaneMoments& other);
  friend bool operator==(const PlaneMoments&, const PlaneMoments&) = default;
};

/// How far disparities lie before a surface, in 1/64 px, which count from 8 px behind to 24 px before it.
struct Heights {
  std::int64_t n = 0, sum = 0, squares = 0;
  std::int64_t behind = 0, on = 0;  // farther behind than 1 px; within 1 px
  void add(int height) {
    const std::int64_t h = std::clamp(height, -8 * kDisparitySteps, 24 * kDisparitySteps);
    ++n;
    sum += h;
    squares += h * h;
    behind += h < -kDisparitySteps ? 1 : 0;
    on += std::abs(h) <= kDisparitySteps ? 1 : 0;
  }
  void add(const Heights& other);
  friend bool operator==(const Heights&, const Heights&) = default;
};

/// Steps of a histogram: brightness by 16 grey levels from 0 on, the differences of colour by 12 from −96 on,
/// what lies outside in the first or the last.
inline constexpr std::size_t kColourBins = 16;

/// So many pixels of each step: of brightness, blue − green, red − green.
using Histogram = std::array<std::int32_t, 3 * kColourBins>;

struct RegionCues {
  std::int64_t area = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  int left = std::numeric_limits<int>::max(), top = std::numeric_limits<int>::max();
  int right = -1, bottom = -1;                    // the last column and row
  std::array<std::int64_t, 4> at_image_border{};  // pixels at its left, right, top, bottom
  // Brightness, (red + 2 green + blue)/4 rounded down, blue − green, red − green; without colours grey, 0, 0.
  std::array<std::int64_t, 3> colour{}, colour_squares{};
  Histogram histogram{};
  std::int64_t texture = 0;                         // sum of the edges inside, in 1/4 grey level
  std::int64_t perimeter = 0;                       // pairs of 4-neighbours of which one lies outside
  PlaneMoments matched{}, textured{};               // all disparities; those of the evidence
  Heights above_ground{}, textured_above_ground{};  // where the ground's disparity is positive
  Heights before_background{}, textured_before_background{};
  /// `common`: pairs of neighbours between the two.
  void add(const RegionCues& other, std::int64_t common);
  friend bool operator==(const RegionCues&, const RegionCues&) = default;
};

/// Where two regions touch, a < b among superpixels. Steps are those of a over b. The edge between two pixels
/// is the stronger one of theirs, and none below 1.5 grey levels + 0.8 noise_sigma.
struct ContactCues {
  std::int32_t a = 0, b = 0;
  std::int64_t length = 0, edge_sum = 0,
               weak = 0;        // pairs of neighbours; 1/4 grey level; pairs without an edge
  std::int64_t x2 = 0, y2 = 0;  // of the pairs' midpoints, in half pixels from the image's centre
  std::int64_t near_n = 0, near_sum = 0, near_abs = 0;  // steps between the two pixels, in 1/64 px
  // Between pixels up to three further away from the contact, as far as their superpixels go straight on:
  std::int64_t far_n = 0, far_sum = 0, far_abs = 0;
  std::int64_t nearer = 0, farther = 0, level = 0;  // of the far ones: more than 1 px, less than −1, between
  /// `turned`: the other's a is this one's b.
  void add(const ContactCues& other, bool turned);
  friend bool operator==(const ContactCues&, const ContactCues&) = default;
};

struct RegionGraphCues {
  std::vector<RegionCues> regions;
  std::vector<ContactCues> contacts;  // as the picture's rows show them first, to the right before down
};

RegionGraphCues gather_cues(const Superpixels& superpixels, const Cues& cues, const Exec& exec);

}  // namespace cairn
