// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/evaluation/object_error.hpp>
#include <cairn/io/disparity_files.hpp>
#include <cairn/io/image_files.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace cairn::io {

/// The files of one stereo pair in its folder.
struct FrameFiles {
  std::string name;  // of the folder, or of the left image among others in a folder
  std::filesystem::path folder;
  std::filesystem::path left;
  std::optional<std::filesystem::path> right;  // optional with a given map
  std::optional<std::filesystem::path> calib;  // of the frame, else of ../gt/
  std::filesystem::path expected_right{};      // for messages; empty if no layout determines it
  bool grey_cameras = false;                   // KITTI cameras 0 and 1, with their own projections
  Layout layout = Layout::one;                 // otherwise left and right are one file with both images
  std::optional<GivenMap> given = {};          // disparities or depth, used instead of the right image
};
/// The images of a frame with a right one. Throws Error.
LoadedPair load_pair(const FrameFiles& files, const Pool& pool = {}, int least_bits = 8);

enum class Cameras : std::uint8_t { rectified, raw };

/// Whether this is a file with an image's extension.
bool is_picture(const std::filesystem::path& path);

/// The frames in a folder, sorted by name. A folder with a left image (left.png, .jpg, .jpeg, .pgm, .ppm,
/// .pnm; Middlebury and ETH3D: im0, im2 or view1) is one frame; otherwise each of its
/// sub-folders with one is, else each pair of files whose names differ only in left and right (left01.jpg,
/// right01.jpg; also Left and Right, _L and _R) or that have such names or the same one in the sub-folders left/ and
/// right/, or in KITTI's image_2/ and image_3/, TartanAir's image_left/ and image_right/ and the like; EuRoC's cam0/data/ and cam1/data/ only if raw cameras are requested. `alone`:
/// left images that have no right one, among pairs of files. Where there is no right image, a map takes its
/// place: disparity or depth.png, .pfm or .npy beside left, or depth beside rgb, color or image; or a sub-folder depth/ beside rgb/, color/, image/,
/// infra1/ or left/, with the same names or, as in TUM RGB-D, stamps in s that are at most 20 ms apart. Their unit is
/// mm, in the folders of TUM RGB-D (with rgb.txt or associations.txt) 1/5 mm. Throws Error if there is no frame.
std::vector<FrameFiles> find_frames(const std::filesystem::path& folder, Cameras cameras = Cameras::rectified,
                                    std::vector<std::filesystem::path>* alone = nullptr);

/// Maps to be used instead of matching, as options of a command: a folder of .png, .pfm or .npy with the names of the
/// frames, or of results, or the file of a single frame. At most one of them.
struct MapOptions {
  std::string disparity;
  std::string depth;
  std::optional<double> depth_units_per_m;  // of 16-bit depth images; nullopt: as find_frames() says
  [[nodiscard]] bool any() const { return !disparity.empty() || !depth.empty() || depth_units_per_m; }
};
/// Gives the frames their maps; without such options they keep those that they have. Throws Error, naming the option
/// as on the command line: two kinds, no frame with a map, one file for several frames, units out of range or without
/// a depth image.
void give_maps(std::vector<FrameFiles>& frames, const MapOptions& options);

/// The images of a folder, by their extensions, in the order of the numbers in their names. Throws Error.
std::vector<std::filesystem::path> images_in(const std::filesystem::path& folder);
/// The frames of a folder in which every image holds both images. Throws Error if there is none.
std::vector<FrameFiles> find_both(const std::filesystem::path& folder, Layout layout);

/// The pairs for a calibration: if two or more pairs differ only in their names, all of them, even if one is
/// left.png. Throws Error if there is none.
std::vector<FrameFiles> find_pairs(const std::filesystem::path& folder);

/// The calibration in a folder: the first existing of calib.txt, calib.yaml and the like.
std::optional<std::filesystem::path> calibration_in(const std::filesystem::path& folder);

/// The ground truth of one frame; all parts are optional.
struct TruthFiles {
  std::filesystem::path folder;                       // where it was found
  std::optional<std::filesystem::path> objects;       // objects.png
  std::optional<std::filesystem::path> disparity;     // disp_left.png or .pfm, or the name in a data set
  std::optional<std::filesystem::path> occlusion;     // for load_hidden()
  std::optional<std::filesystem::path> ground;        // ground.png: 255 = floor
  std::optional<std::filesystem::path> ground_plane;  // ground.txt
  std::optional<std::filesystem::path> calib;
  bool partial = false;  // a file `partial`: not every object is labelled
};

/// The truth in `folder`, or else in ../gt. Throws Error if neither has objects.png or a disparity map:
/// disp_left, or disp0GT, disp0, disp1, disp2 of Middlebury and ETH3D.
TruthFiles find_truth(const std::filesystem::path& folder);
/// The truth of a frame: as above, or the KITTI maps (disp_occ_0/, disp_occ/) in its folder under its name.
TruthFiles find_truth(const FrameFiles& frame);
/// The truth of the frame `name` among others: in the sub-folder of this name, or KITTI maps.
TruthFiles find_truth(const std::filesystem::path& folder, const std::string& name);
/// Whether either exists.
bool names_truth(const std::filesystem::path& folder, const std::string& name);

/// The ids of an objects.png: 255 is "don't care" in 8-bit files, an ordinary id in 16-bit files.
Image<TruthId> truth_ids(const Labels& labels);
/// 1 = not seen by the right camera, else 0: from an occlusion.png (255 = hidden), mask0nocc.png of
/// Middlebury and ETH3D (255 = seen) or a KITTI disp_noc map (0 = hidden or unknown).
Image<std::uint8_t> load_hidden(const std::filesystem::path& path);

}  // namespace cairn::io
