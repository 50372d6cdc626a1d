// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <filesystem>
#include <memory>

#include <cairn/input/sequence.hpp>

/// Videos through OpenCV's videoio.
namespace cairn::input {

/// See open_video() and open_videos().
std::unique_ptr<Sequence> opencv_video(const std::filesystem::path& file, const SourceOptions& options,
                                       const Pool& pool);
std::unique_ptr<Sequence> opencv_videos(const std::filesystem::path& left, const std::filesystem::path& right,
                                        const SourceOptions& options, const Pool& pool);

}  // namespace cairn::input
