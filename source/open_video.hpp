// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <filesystem>
#include <memory>

#include "sequence.hpp"

/// Videos, by a module that has OpenCV's videoio (video/); built without it (CAIRN_VIDEO=OFF) both throw an
/// Error that says so. Internal to source.
namespace cairn::io {

/// One video with both images in every frame, as options.layout says.
std::unique_ptr<Sequence> open_video(const std::filesystem::path& file, const SourceOptions& options,
                                     const Pool& pool);
/// A video for each camera, paired by stamps; by order where options.rate_hz is given.
std::unique_ptr<Sequence> open_videos(const std::filesystem::path& left, const std::filesystem::path& right,
                                      const SourceOptions& options, const Pool& pool);

}  // namespace cairn::io
