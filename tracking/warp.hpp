// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/objects/measure.hpp>

#include "pose.hpp"
#include "tracks.hpp"

namespace cairn {

/// What was seen of the tracks when each was seen last: where its pixels are in the map. Nothing else of past
/// pictures is remembered.
struct SeenPoint {
  Point3 in_map_m;
  float disparity_px = 0;
};
struct Remembered {
  struct Mask {
    TrackId track = TrackId::none;
    Stamp seen;
    std::vector<SeenPoint> points;  // one for each pixel of its mask that has a disparity
  };
  std::vector<Mask> masks;  // by track, rising
};

/// The tracks as they should show now.
struct Warped {
  struct Mask {
    TrackId track = TrackId::none;
    float in_view = 0;  // 0 … 1: share of its points that lie in the picture
    int area = 0;       // px that they cover there, hidden or not
  };
  std::vector<Mask> masks;    // by track, rising
  Image<TrackId> ids;         // none = no track is expected here
  Image<float> disparity_px;  // NaN where ids is none
};

/// What is remembered, moved to where the camera is now, and each moving track by its own motion: the nearer
/// one wins, gaps of one pixel are closed. (docs/stages/tracking.md)
Warped warp(const Remembered& remembered, const Tracks& tracks, const Pose& map_from_camera, Stamp now,
            const StereoRig& rig, Size image, const Exec& exec);

/// The masks of this frame's tracks in place of older ones of the same tracks; those of tracks that are no
/// more go.
Remembered remember(Remembered before, const Tracks& tracks, const Objects& objects,
                    const DisparityMap& disparity, const Pose& map_from_camera, Stamp now,
                    const StereoRig& rig);

/// What the present frame shows where tracks are expected.
Overlaps overlaps_of(const Warped& warped, const Tracks& tracks, const Objects& objects,
                     const DisparityMap& disparity);

}  // namespace cairn
