// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <cairn/input/sequence.hpp>
#include <cairn/io/dataset.hpp>

/// Lists the files of a source before any image is decoded; internal to source.
namespace cairn::input {

struct ListedFrame {
  std::string name;
  std::size_t index = 0;
  std::filesystem::path left;
  std::filesystem::path right;                 // may be empty where a map is given
  std::optional<std::filesystem::path> calib;  // of this frame
  Stamp stamp;
  io::Layout layout = io::Layout::one;  // otherwise left and right are one file with both images
  std::optional<io::GivenMap> given = {};
};

struct FrameList {
  std::vector<ListedFrame> frames;             // in order; where the stamps do not ascend, see clock_step()
  std::optional<std::filesystem::path> calib;  // of all frames
  bool grey_cameras = false;                   // KITTI's cameras 0 and 1
  bool is_raw = false;                         // the images need rectification
  std::string stamps_from;
  std::vector<SourceRemark> remarks;
};

/// Why no images are paired, with what would pair the first of them. The stamps are those of the first on either side.
std::string skew_text(Stamp left, Stamp right, double max_skew_ms,
                      const std::string& what = "left and right image");

/// The frames of a folder within options.frames. Throws Error.
FrameList list_folder(const std::filesystem::path& folder, const SourceOptions& options);
/// The frames of two folders of images, or of two patterns such as left_%04d.png.
FrameList list_two(const std::string& left, const std::string& right, const SourceOptions& options);

/// The stamps of the frames of a folder, by the path of the left image: from files as for list_folder(), or
/// from the frames' names; empty if there are none. Throws Error if a file of stamps does not fit the frames,
/// or as check_unit().
std::map<std::filesystem::path, Stamp> stamps_in(const std::filesystem::path& folder,
                                                 std::vector<io::FrameFiles> frames);

/// Whether the name is a pattern: left_%04d.png.
bool is_pattern(const std::string& name);

/// Counts one more frame with this remark.
void remark(std::vector<SourceRemark>& remarks, const SourceRemark& of_one);

/// The description of stamps from a rate, and the stamp of a frame.
double rate_of(const SourceOptions& options);
std::string rate_text(double rate_hz);
Stamp stamp_at(std::size_t index, double rate_hz);

}  // namespace cairn::input
