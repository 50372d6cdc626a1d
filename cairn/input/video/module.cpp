// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/video/module.hpp>

#include <cairn/input/video/opencv_video.hpp>

extern "C" {

__attribute__((visibility("default"))) const char* cairn_module_version() {
  return CAIRN_VERSION;
}

__attribute__((visibility("default"))) cairn::input::Sequence* cairn_open_video(
    const cairn::input::VideoRequest& request) {
  return (request.right
              ? cairn::input::opencv_videos(request.left, *request.right, request.options, request.pool)
              : cairn::input::opencv_video(request.left, request.options, request.pool))
      .release();
}

}  // extern "C"
