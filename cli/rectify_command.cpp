// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/error.hpp>
#include <cmath>
#include <io/atomic_file.hpp>
#include <io/calibration_files.hpp>
#include <io/raw_calibration.hpp>
#include <io/stereo_calibration.hpp>
#include <iostream>

#include "commands.hpp"
#include "common.hpp"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

struct RectifyOptions {
  InputOptions input;
  std::string output;
  double nearest_m = 0;  // 0 = kNearestBaselines
};

constexpr double kNearestBaselines = 5;  // a fifth of the focal length, in disparities

void save(const fs::path& path, const io::Picture& picture) {
  if (picture.rgb.empty()) {
    io::save_png(path, picture.gray.view());
  } else {
    io::save_png(path, picture.rgb.view());
  }
}

/// The disparities down to the nearest distance, a multiple of 16 that fits the pictures.
int disparities_to(double nearest_m, const StereoRig& rig, int width) {
  constexpr int kStep = 16;
  constexpr int kMost = 1024;
  const auto baseline = static_cast<double>(rig.baseline_m);
  if (nearest_m == 0) nearest_m = kNearestBaselines * baseline;
  const double last =
      static_cast<double>(rig.focal_px) * baseline / nearest_m - static_cast<double>(rig.doffs_px);
  const double steps = std::floor(std::max(last, 0.0) / kStep) + 1;
  return std::min(static_cast<int>(std::min(steps * kStep, double{kMost})), width);
}

int rectify(const RectifyOptions& options) {
  const std::vector<io::FrameFiles> frames = frames_of(options.input);
  const io::Rectifier rectify_pair(io::load_raw_calibration(options.input.calib));
  const Progress progress(frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    progress.at(i, frames[i].name);
    const io::PicturePair raw = io::load_pair(frames[i].left, right_of(frames[i]));
    io::PicturePair rectified;
    try {
      rectified = rectify_pair(raw);
    } catch (const Error& error) {
      throw Error(options.input.calib + ": " + error.what());
    }
    const fs::path folder =
        frames.size() == 1 ? fs::path(options.output) : options.output / fs::path(frames[i].name);
    io::make_folder(folder);
    save(folder / "left.png", rectified.left);
    save(folder / "right.png", rectified.right);
    const Size size = rectified.left.gray.size();
    io::save_calibration(folder / "calib.txt", rectify_pair.rig(), size,
                         disparities_to(options.nearest_m, rectify_pair.rig(), size.width));
  }
  progress.clear();
  std::cout << "rectified " << frames.size() << (frames.size() == 1 ? " pair into " : " pairs into ")
            << options.output << ": left.png, right.png, calib.txt\n";
  return 0;
}

}  // namespace

Work declare_rectify(CLI::App& app) {
  auto options = std::make_shared<RectifyOptions>();
  options->input.cameras = io::Cameras::raw;
  app.add_option(
         "LEFT", options->input.left,
         "left picture as the camera took it, or a folder with left.png and right.png, or a folder of "
         "such folders")
      ->required()
      ->type_name("");
  app.add_option("RIGHT", options->input.right, "right picture; not with a folder")->type_name("");
  app.add_option(
         "--calib", options->input.calib,
         "what cairn calibrate wrote; or OpenCV YAML or XML with M1 D1 M2 D2 R T, ROS camera_info, or "
         "EuRoC's cam0/sensor.yaml")
      ->required()
      ->type_name("FILE");
  app.add_option("-o,--output", options->output,
                 "folder for left.png, right.png and calib.txt; several pairs get a folder each in it")
      ->required()
      ->type_name("DIR");
  app.add_option("--nearest", options->nearest_m,
                 "nearest distance of interest, m; with focal length and baseline it gives the ndisp in "
                 "calib.txt (default: 5 baselines)")
      ->check(CLI::Range(0.01, 1e4).name(""))
      ->type_name("M");
  return [options] { return rectify(*options); };
}

}  // namespace cairn::cli
