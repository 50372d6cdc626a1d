// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sequence.hpp"

/// Which files a source has, before any image is decoded; internal to source.
namespace cairn::io {

struct ListedFrame {
  std::string name;
  std::size_t index = 0;
  std::filesystem::path left;
  std::filesystem::path right;
  std::optional<std::filesystem::path> calib;  // its own
  Stamp stamp;
};

struct FrameList {
  std::vector<ListedFrame> frames;             // stamps rise
  std::optional<std::filesystem::path> calib;  // of all
  bool grey_cameras = false;                   // KITTI's cameras 0 and 1
  bool is_raw = false;                         // the images want rectifying
  std::string stamps_from;
  std::vector<SourceRemark> remarks;
};

/// The frames of a folder, only those of options.frames. Throws Error.
FrameList list_folder(const std::filesystem::path& folder, const SourceOptions& options);
/// Those of two folders of images, or of two patterns such as left_%04d.png.
FrameList list_two(const std::string& left, const std::string& right, const SourceOptions& options);

/// Whether the name's number is left open: left_%04d.png.
bool is_pattern(const std::string& name);

/// Counts one more frame of which this is to be said.
void remark(std::vector<SourceRemark>& remarks, const SourceRemark& of_one);

/// Whether `index` is one of the range.
bool is_in(const FrameRange& range, std::size_t index);

/// The words for stamps that come from a rate, and the stamp of a frame.
double rate_of(const SourceOptions& options);
std::string rate_text(double rate_hz);
Stamp stamp_at(std::size_t index, double rate_hz);

}  // namespace cairn::io
