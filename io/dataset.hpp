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
  std::filesystem::path expected_right{};      // for messages; empty where no layout names it
  bool grey_cameras = false;                   // KITTI's cameras 0 and 1, which have projections of their own
};

enum class Cameras : std::uint8_t { rectified, raw };

/// A folder with a left picture (left.png, .jpg, .jpeg, .pgm, .ppm, .pnm, .tif, .tiff; in Middlebury's and
/// ETH3D's names im0, im2 or view1) is one frame; otherwise each of its sub-folders with one is, else each
/// pair of files whose names differ in the words left and right alone (left01.jpg, right01.jpg) or that have
/// one name in the sub-folders left/ and right/, or in KITTI's image_2/ and image_3/ and the like; EuRoC's
/// cam0/data/ and cam1/data/ only where raw cameras are asked for. Sorted by name. Throws Error where there
/// is none.
std::vector<FrameFiles> find_frames(const std::filesystem::path& folder,
                                    Cameras cameras = Cameras::rectified);

/// The same for a calibration, which takes many pairs of raw cameras: where two or more differ in their names
/// alone, they are all taken, though one of them be left.png. Throws Error where there is none.
std::vector<FrameFiles> find_pairs(const std::filesystem::path& folder);

/// The calibration in a folder: calib.txt, calib.yaml and the like, the first that is there.
std::optional<std::filesystem::path> calibration_in(const std::filesystem::path& folder);

/// What is known to be true of one frame; every part may be missing.
struct TruthFiles {
  std::filesystem::path folder;                       // where it was found
  std::optional<std::filesystem::path> objects;       // objects.png
  std::optional<std::filesystem::path> disparity;     // disp_left.png or .pfm, or in a data set's own name
  std::optional<std::filesystem::path> occlusion;     // what load_hidden() reads
  std::optional<std::filesystem::path> ground;        // ground.png: 255 = floor
  std::optional<std::filesystem::path> ground_plane;  // ground.txt
  std::optional<std::filesystem::path> calib;
  bool partial = false;  // a file `partial`: not every object is labelled
};

/// The truth in `folder`, or else in ../gt beside it. Throws Error where neither has objects.png or a
/// disparity map: disp_left, or Middlebury's and ETH3D's disp0GT, disp0, disp1, disp2.
TruthFiles find_truth(const std::filesystem::path& folder);
/// A frame's: as above, or KITTI's maps (disp_occ_0/, disp_occ/) in its folder under its name.
TruthFiles find_truth(const FrameFiles& frame);
/// That of the frame `name` among others: in the sub-folder of this name, or KITTI's maps.
TruthFiles find_truth(const std::filesystem::path& folder, const std::string& name);
/// Whether one of the two is there.
bool names_truth(const std::filesystem::path& folder, const std::string& name);

/// The ids of an objects.png: 255 means "don't care" in a file of 8 bits, with 16 it is an id like others.
Image<TruthId> truth_ids(const Labels& labels);
/// 1 = not seen by the right camera, else 0: from an occlusion.png (255 = hidden), Middlebury's and ETH3D's
/// mask0nocc.png (255 = seen) or a map of KITTI's disp_noc (0 = hidden or not known).
Image<std::uint8_t> load_hidden(const std::filesystem::path& path);

}  // namespace cairn::io
