// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/evaluation/object_error.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>
#include "image_files.hpp"

namespace cairn::io {

/// The files of one stereo pair in its folder.
struct FrameFiles {
  std::string name;  // the folder's, or the left picture's among others in a folder
  std::filesystem::path folder;
  std::filesystem::path left;
  std::optional<std::filesystem::path> right;  // may be missing where a disparity map comes from elsewhere
  std::optional<std::filesystem::path> calib;  // the frame's own, else ../gt/'s
};

/// A folder with a left picture (left.png, .jpg, .jpeg, .pgm, .ppm, .pnm, .tif, .tiff) is one frame;
/// otherwise each of its sub-folders with one is, else each pair of files whose names differ in the words
/// left and right alone (left01.jpg, right01.jpg) or that have one name in the sub-folders left/ and right/.
/// Sorted by name. Throws Error where there is none.
std::vector<FrameFiles> find_frames(const std::filesystem::path& folder);

/// The same for a calibration, which takes many pairs: where two or more differ in their names alone, they
/// are all taken, though one of them be left.png. Throws Error where there is none.
std::vector<FrameFiles> find_pairs(const std::filesystem::path& folder);

/// What is known to be true of one frame; every part may be missing.
struct TruthFiles {
  std::filesystem::path folder;                       // where it was found
  std::optional<std::filesystem::path> objects;       // objects.png
  std::optional<std::filesystem::path> disparity;     // disp_left.png or disp_left.pfm
  std::optional<std::filesystem::path> occlusion;     // occlusion.png: 255 = not seen in the right image
  std::optional<std::filesystem::path> ground;        // ground.png: 255 = floor
  std::optional<std::filesystem::path> ground_plane;  // ground.txt
  std::optional<std::filesystem::path> calib;
  bool partial = false;  // a file `partial`: not every object is labelled
};

/// The truth in `folder`, or else in ../gt beside it. Throws Error where neither has objects.png or
/// disp_left.
TruthFiles find_truth(const std::filesystem::path& folder);

/// The ids of an objects.png: 255 means "don't care" in a file of 8 bits, with 16 it is an id like others.
Image<TruthId> truth_ids(const Labels& labels);
/// Of an occlusion.png: 1 = not seen by the right camera, else 0.
Image<std::uint8_t> hidden_pixels(const Labels& labels);

}  // namespace cairn::io
