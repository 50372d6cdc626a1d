// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/objects/measure.hpp>

#include <cairn/sequence/pose.hpp>
#include <cairn/sequence/tracks.hpp>

namespace cairn {

/// The remembered points of the tracks from their last detections, in the map. Nothing else of past images is
/// kept.
struct SeenPoint {
  Point3 in_map_m;
  float disparity_px = 0;
};
struct MaskMemory {
  struct Mask {
    TrackId track = TrackId::none;
    Stamp seen;
    std::vector<SeenPoint> points;  // one for each pixel of its mask with a disparity
  };
  std::vector<Mask> masks;  // by track, ascending
};

/// The predicted appearance of the tracks.
struct MaskPrediction {
  struct Mask {
    TrackId track = TrackId::none;
    float in_view = 0;  // 0 … 1: share of its points inside the image
    int area = 0;       // px covered by them, occluded or not
  };
  std::vector<Mask> masks;    // by track, ascending
  Image<TrackId> ids;         // none = no track expected
  Image<float> disparity_px;  // NaN if ids is none
};

/// Moves the remembered points to the present camera, those of a moving track also by its motion: the nearer
/// point wins, gaps of one pixel are closed. (docs/stages/tracking.md)
MaskPrediction warp(const MaskMemory& remembered, const Tracks& tracks, const Pose& map_from_camera,
                    Stamp now, const StereoRig& rig, Size image, const Exec& exec);

/// Replaces the masks of tracks detected in this frame; removes those of ended tracks.
MaskMemory remember(MaskMemory before, const Tracks& tracks, const Objects& objects,
                    const DisparityMap& disparity, const Pose& map_from_camera, Stamp now,
                    const StereoRig& rig);

/// The overlaps of the objects of the present frame with the predicted tracks.
Overlaps overlaps_of(const MaskPrediction& warped, const Tracks& tracks, const Objects& objects,
                     const DisparityMap& disparity);

}  // namespace cairn
