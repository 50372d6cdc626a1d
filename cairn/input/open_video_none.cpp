// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/error.hpp>

#include <cairn/input/open_video.hpp>

namespace cairn::input {
namespace {

[[noreturn]] void not_built_in(const std::filesystem::path& file) {
  throw Error(file.string() +
              ": videos are not built in: they need OpenCV's videoio (libopencv-videoio-dev); a folder of "
              "images can be read");
}

}  // namespace

std::unique_ptr<Sequence> open_video(const std::filesystem::path& file, const SourceOptions&, const Pool&) {
  not_built_in(file);
}
std::unique_ptr<Sequence> open_videos(const std::filesystem::path& left, const std::filesystem::path&,
                                      const SourceOptions&, const Pool&) {
  not_built_in(left);
}

}  // namespace cairn::input
