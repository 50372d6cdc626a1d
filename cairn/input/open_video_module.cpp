// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/open_video.hpp>
#include <cairn/input/video/module.hpp>
#include <cairn/io/load_module.hpp>

/// FFmpeg and the dependencies of OpenCV's video module are 200 libraries, which take a quarter of a second
/// to load. So they are loaded with the first video only.
namespace cairn::input {
namespace {

namespace fs = std::filesystem;

VideoEntry video_entry(const fs::path& video) {
  return reinterpret_cast<VideoEntry>(
      io::module_entry({"cairn-video.so", kVideoEntry, "videos need", "OpenCV's videoio (libopencv-videoio)",
                        "package cairn-video; it is built where libopencv-videoio-dev is"},
                       video.string()));
}

}  // namespace

std::unique_ptr<Sequence> open_video(const fs::path& file, const SourceOptions& options, const Pool& pool) {
  return std::unique_ptr<Sequence>(video_entry(file)({file, {}, options, pool}));
}

std::unique_ptr<Sequence> open_videos(const fs::path& left, const fs::path& right,
                                      const SourceOptions& options, const Pool& pool) {
  return std::unique_ptr<Sequence>(video_entry(left)({left, right, options, pool}));
}

}  // namespace cairn::input
