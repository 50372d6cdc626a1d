// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/open_video.hpp>
#include <cairn/input/video/opencv_video.hpp>

/// Linked directly, without a module: sanitizers need one program.
namespace cairn::input {

std::unique_ptr<Sequence> open_video(const std::filesystem::path& file, const SourceOptions& options,
                                     const Pool& pool) {
  return opencv_video(file, options, pool);
}

std::unique_ptr<Sequence> open_videos(const std::filesystem::path& left, const std::filesystem::path& right,
                                      const SourceOptions& options, const Pool& pool) {
  return opencv_videos(left, right, options, pool);
}

}  // namespace cairn::input
