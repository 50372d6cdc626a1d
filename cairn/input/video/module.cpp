// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/open_parts.hpp>
#include <cairn/input/video/opencv_video.hpp>

cairn::input::Sequence* cairn_open_video(const cairn::input::VideoRequest& request) {
  using namespace cairn::input;
  return (request.right ? opencv_videos(request.left, *request.right, request.options, request.pool)
                        : opencv_video(request.left, request.options, request.pool))
      .release();
}
