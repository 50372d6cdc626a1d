// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <filesystem>
#include <memory>

#include <cairn/input/sequence.hpp>

/// Videos, through a module with OpenCV's videoio (video/); in a build without it (CAIRN_VIDEO=OFF) both
/// functions throw Error. Internal to source.
namespace cairn::input {

/// One video with both images in every frame, according to options.layout.
std::unique_ptr<Sequence> open_video(const std::filesystem::path& file, const SourceOptions& options,
                                     const Pool& pool);
/// One video per camera, paired by stamps; by order if options.rate_hz is given.
std::unique_ptr<Sequence> open_videos(const std::filesystem::path& left, const std::filesystem::path& right,
                                      const SourceOptions& options, const Pool& pool);

}  // namespace cairn::input
