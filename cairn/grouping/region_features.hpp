// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/grouping/region_cues.hpp>
#include <span>
#include <string_view>

/// The numbers that the fitted trees look at. None depends on the image's size, the focal length or the
/// baseline but through px of disparity, which is what a matcher's errors are measured in.
namespace cairn {

/// In a feature's place where nothing is known.
inline constexpr float kUnknown = -999.0F;

/// A least-squares plane of disparity, px; level where a region is small.
struct FittedPlane {
  bool any = false;
  double a = 0, b = 0;         // px a px
  double d = 0, x = 0, y = 0;  // through this point; x and y from the image's centre
  double squares = 0;          // sum of the squared distances from it, and what its levelling costs
  [[nodiscard]] double at(double px, double py) const { return d + a * (px - x) + b * (py - y); }
};
/// `width`: of the image.
FittedPlane fit_plane(const PlaneMoments& moments, int width);

/// Of a region: the two planes through all its disparities and through its evidence, and how far its colours
/// are from those of the floor and of the background.
struct RegionFits {
  FittedPlane matched, textured;
  double to_floor = kUnknown, to_background = kUnknown;  // χ², 0 … 6
};

/// The colours of the superpixels that lie on the ground, or in the background, for the most part.
struct SceneColours {
  std::int64_t area = 0;  // px
  Histogram histogram{};
  void add(const RegionCues& region);
};

/// What all regions of a frame share.
struct FrameCues {
  int width = 0;
  int height = 0;
  bool has_colour = false;
  bool has_ground = false;
  int walls_and_floor = 0;
  float noise_sigma = 0;
  float matched_share = 0;
  float evidence_share = 0;
  double nearest_px = 1;  // the greatest mean disparity of a superpixel, at least 1
  SceneColours floor, background;
};
FrameCues frame_cues(const RegionGraphCues& graph, const Cues& cues);
RegionFits fit_region(const RegionCues& region, const FrameCues& frame);

inline constexpr std::size_t kMergeFeatures = 48;
inline constexpr std::size_t kObjectFeatures = 76;
using MergeFeatures = std::array<float, kMergeFeatures>;
using ObjectFeatures = std::array<float, kObjectFeatures>;

/// One end of a contact.
struct RegionSide {
  const RegionCues& cues;
  const RegionFits& fits;
};

/// Of two regions that touch: what tells whether they show one thing. `a`, `b`: those of the contact.
MergeFeatures merge_features(const RegionSide& a, const RegionSide& b, const ContactCues& contact,
                             const FrameCues& frame);

/// A neighbour as a region sees it.
struct Neighbour {
  RegionSide side;
  const ContactCues& contact;
  bool turned;       // the contact's a is the neighbour
  float same_thing;  // kSameThing of the two
};

/// How a region came to be; of a superpixel: {20, 20, 1}.
struct Origin {
  float same_thing = 0;        // kSameThing of its two parts, when they fused
  float least_same_thing = 0;  // … and the least of all fusions in it
  float larger_part = 1;       // share of its area
};

/// Of a region: what tells whether it is a whole object. The last two, which only the fusion that ends the
/// region tells, are unknown: see tell_end().
ObjectFeatures object_features(const RegionSide& region, std::span<const Neighbour> neighbours,
                               const Origin& origin, const FrameCues& frame);
/// Fills them in: the region's share of what it became a part of, and kSameThing of that fusion.
void tell_end(ObjectFeatures& features, float share, float same_thing);

/// The names of the features, in their order.
std::vector<std::string_view> merge_feature_names();
std::vector<std::string_view> object_feature_names();

}  // namespace cairn
