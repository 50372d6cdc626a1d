// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "source_options.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cairn/core/error.hpp>
#include <cairn/input/frame_list.hpp>
#include <cstdlib>
#include <iostream>

#include "common.hpp"
#include "interrupt.hpp"

namespace cairn::cli {
namespace {

std::atomic<input::Sequence*> open_camera = nullptr;

void stop_camera() {
  if (input::Sequence* camera = open_camera) camera->stop();
}

}  // namespace

EndsBySignal::EndsBySignal(input::Sequence& sequence) {
  if (!sequence.status().is_live) return;
  open_camera = &sequence;
  on_interrupt_also(stop_camera);
  catch_interrupts();
}

EndsBySignal::~EndsBySignal() {
  on_interrupt_also(nullptr);
  open_camera = nullptr;
}

void add_source_options(CLI::App& app, SourceInput& input) {
  app.add_option("SOURCE", input.source,
                 "folder of frames, or of KITTI or EuRoC; video; recording (MCAP); LEFT,RIGHT: two "
                 "folders, two videos, or two patterns such as left_%04d.png,right_%04d.png; camera: "
                 "v4l2:/dev/video0, gst:'PIPELINE', rtsp://... (docs/cameras.md), ros2:/NAME "
                 "(docs/ros2.md)")
      ->required()
      ->type_name("");
  app.add_option("--calib", input.options.calib,
                 "calibration; default: of the first frame, else of the folder, else none: no metres")
      ->type_name("FILE");
  app.add_flag("--rectify", input.options.rectify,
               "rectification of raw images by the --calib of the raw cameras (EuRoC: always)");
  app.add_flag("--scale-calibration", input.options.scale_calibration,
               "scaling of a calibration for images of another size of the same shape");
  add_binning_option(app, input.options.binning);
  app.add_option("--layout", input.options.layout,
                 "layout of a video, a camera or images with both images: side_by_side or top_bottom")
      ->type_name("NAME");
  app.add_option("--topics", input.options.topics,
                 "topics: left and right image, an image and its depth or disparities, or all three")
      ->type_name("A,B[,C]");
  add_map_options(app, input.options.maps);
  app.add_option("--rate", input.options.rate_hz,
                 "frames per second, overriding a video's and replacing missing stamps (default: of the "
                 "source, else 10)")
      ->type_name("HZ");
  app.add_option("--frames", input.frames,
                 "frames to read: FIRST:END, FIRST:END:STEP, or the number of first frames")
      ->type_name("A:B:STEP");
  app.add_option("--max-gap", input.options.max_gap_s, "longest pause within a sequence")
      ->type_name("S")
      ->capture_default_str();
  app.add_option("--max-skew", input.options.max_skew_ms,
                 "largest stamp difference of a pair if each camera has its own stamps")
      ->type_name("MS")
      ->capture_default_str();
  app.add_option("--open-timeout", input.options.open_timeout_s,
                 "longest wait for the first pair of a camera")
      ->type_name("S")
      ->capture_default_str();
}

std::unique_ptr<input::Sequence> open_source(const SourceInput& input, const Pool& pool,
                                             const ConfigOptions& config) {
  // Silences FFmpeg, which prints to stderr; "-8" is its quiet level.
  ::setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
  input::SourceOptions options = input.options;
  options.has_search_range = sets_search_range(config);
  if (!input.frames.empty()) options.frames = input::parse_frame_range(input.frames);
  return input::open_sequence(input.source, options, pool);
}

void refuse_two_priors(const std::string& odometry, const std::string& imu) {
  if (!odometry.empty() && !imu.empty())
    throw Error("--imu: found --odometry as well, expected one of the two");
}

std::string remarks_text(const input::Sequence& sequence) {
  std::string text;
  for (const input::SourceRemark& remark : sequence.remarks()) {
    text += "cairn: " + sequence.name() + ": " + remark.what;
    if (remark.count > 0) {
      text += ": " + std::to_string(remark.count) + (remark.count == 1 ? " frame" : " frames") +
              (remark.is_left_out ? " skipped" : "") + ", the first is " + remark.first;
    }
    text += "\n";
  }
  if (!sequence.ended_early().empty()) text += "cairn: " + sequence.ended_early() + "\n";
  return text;
}

int exit_code_of(const input::Sequence& sequence) {
  if (!sequence.ended_early().empty()) return 3;
  const auto& remarks = sequence.remarks();
  return std::any_of(remarks.begin(), remarks.end(),
                     [](const input::SourceRemark& remark) { return remark.is_unusable; })
             ? 2
             : 0;
}

}  // namespace cairn::cli
