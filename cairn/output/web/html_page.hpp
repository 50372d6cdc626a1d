// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/ids.hpp>
#include <cairn/core/image.hpp>
#include <cairn/evaluation/object_error.hpp>
#include <cairn/objects/obstacles.hpp>
#include <cairn/stereo/reject.hpp>
#include <string>
#include <vector>

/// The results of a run as one self-contained page for the browser: no network, no other file. Style, script
/// and layout are the files next to this one.
namespace cairn::output {

/// The contents of the page for one frame. Any view may be empty: its parts are then left out; the others
/// have one size.
struct PageFrame {
  std::string name;
  View<const Gray> left;
  View<const Rgb> left_rgb;
  View<const Gray> right;
  View<const float> disparity_px;  // NaN = hole
  View<const Reject> reject;
  View<const float> confidence;  // 0 … 1
  View<const RegionId> by_intensity;
  View<const RegionId> by_disparity;
  View<const RegionId> superpixels;
  View<const RegionId> groups;
  View<const ObjectId> objects;
  View<const ObstacleLabel> space;
  View<const TruthId> true_objects;
  View<const float> true_disparity_px;
  std::string objects_json;  // the text of an objects.json file, for the tables; may be empty
};

/// A frame as text, so that its images need not be kept until the page is written. Ids and reasons are
/// lossless, disparities in 1/64 px, confidences in 1/255, images as JPEG.
struct EncodedFrame {
  std::string facts;  // JSON, read when the page is opened
  std::string maps;   // JSON, read when the frame is shown
};
EncodedFrame encode_frame(const PageFrame& frame);

struct PageHead {
  std::string command;     // "segment" or "evaluate"
  std::string title;       // the input
  std::string evaluation;  // text of `cairn evaluate --json`; empty if there is none
};

/// The HTML of the page, with the frames in order.
std::string html_page(const PageHead& head, const std::vector<EncodedFrame>& frames);

}  // namespace cairn::output
