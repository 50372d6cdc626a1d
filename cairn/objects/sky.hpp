// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/core/ids.hpp>
#include <cairn/core/image.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/scene/ground_plane.hpp>
#include <cairn/stereo/disparity_map.hpp>
#include <optional>

/// The sky: free, and infinitely far. (docs/stages/sky.md, beyond the paper)
namespace cairn {

/// The inputs of reject_sky(); all images have one size. Borrows everything.
struct SkyCues {
  View<const Gray> left;
  View<const float> confidence;  // of the disparities; empty: all are trusted
  const Ground& ground;
  View<const RegionId> superpixels;
  View<const ObjectId> objects;
};

/// What sky is told by, of one superpixel.
struct SkyFeatures {
  float brightness = 0;        // mean grey level, 0 … 1
  float image_brightness = 0;  // that of the whole image
  float above_horizon = 0;     // share of its pixels
  float near = 0;  // share with a trusted disparity (confidence of 0.7 or more) 2 px above that of infinity
  bool touches_the_top = false;  // it has a pixel in the first row
};

/// The probability that a superpixel is sky: a logistic function of its features, fitted by lab/outdoors.py; 0 if `near`
/// exceeds 0.9.
float sky_probability(const SkyFeatures& of);

/// Rejects the disparities of superpixels that are sky with a probability above 0.6, with Reject::sky; holes there get
/// the reason, too. Pixels of objects stay as they are, and so do those that differ from the mean grey level of their
/// superpixel by more than 24, for example leaves. Without a ground there is no horizon, and nothing is sky.
DisparityMap reject_sky(DisparityMap disparity, const SkyCues& cues, const std::optional<StereoRig>& rig,
                        const Exec& exec);

}  // namespace cairn
