// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/io/atomic_file.hpp>
#include <cairn/io/calibration_files.hpp>
#include <cairn/io/raw_calibration.hpp>
#include <cairn/io/stereo_calibration.hpp>
#include <iostream>

#include "commands.hpp"
#include "common.hpp"
#include "keep_inputs.hpp"
#include "terminal.hpp"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

struct RectifyOptions {
  InputOptions input;
  std::string output;
  double nearest_m = 0;  // 0 = five baselines
};

void save(const fs::path& path, const io::LoadedImage& picture) {
  if (picture.rgb.empty()) {
    io::save_png(path, picture.gray.view());
  } else {
    io::save_png(path, picture.rgb.view());
  }
}

/// The stamps in ascending order, which is that of the frames, if all frames of the folder have one.
void save_stamps(const fs::path& path, const std::vector<std::optional<std::int64_t>>& stamps) {
  std::vector<std::int64_t> known;
  for (const auto& stamp : stamps) {
    if (stamp) known.push_back(*stamp);
  }
  if (known.size() < 2 || known.size() < stamps.size()) return;
  std::sort(known.begin(), known.end());
  std::string text = "# ns\n";
  for (const std::int64_t stamp : known) text += std::to_string(stamp) + "\n";
  io::write_file(path, text);
}

int rectify(const RectifyOptions& options) {
  const std::vector<io::FrameFiles> frames = frames_of(options.input);
  const io::Rectifier rectify_pair(io::load_raw_calibration(
      options.input.calib, [&] { return load_images(frames.front()).left.gray.size(); }));
  const auto folder_of = [&](const io::FrameFiles& files) {
    return frames.size() == 1 ? fs::path(options.output) : options.output / fs::path(files.name);
  };
  for (const io::FrameFiles& files : frames) {
    const fs::path folder = folder_of(files);
    keep_inputs({folder / "left.png", folder / "right.png", folder / "calib.txt"}, files, options.input);
  }
  const Progress progress(frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    progress.at(i, frames[i].name);
    const io::LoadedPair raw = load_images(frames[i]);
    io::LoadedPair rectified;
    try {
      rectified = rectify_pair(raw);
    } catch (const Error& error) {
      throw Error(options.input.calib + ": " + error.what());
    }
    const fs::path folder = folder_of(frames[i]);
    io::make_folder(folder);
    save(folder / "left.png", rectified.left);
    save(folder / "right.png", rectified.right);
    const Size size = rectified.left.gray.size();
    io::save_calibration(folder / "calib.txt", rectify_pair.rig(), size,
                         io::disparities_down_to(options.nearest_m, rectify_pair.rig(), size.width));
  }
  save_stamps(fs::path(options.output) / "stamps.txt", stamps_of(options.input, frames));
  progress.clear();
  std::cout << "rectified " << frames.size() << (frames.size() == 1 ? " pair into " : " pairs into ")
            << options.output << ": left.png, right.png, calib.txt\n";
  return 0;
}

}  // namespace

Work declare_rectify(CLI::App& app) {
  auto options = std::make_shared<RectifyOptions>();
  options->input.cameras = io::Cameras::raw;
  app.add_option("LEFT", options->input.left,
                 "raw left image, or a folder with left.png and right.png, or a folder of such folders")
      ->required()
      ->type_name("");
  app.add_option("RIGHT", options->input.right, "right image; not with a folder")->type_name("");
  add_layout_option(app, options->input.layout);
  app.add_option("--calib", options->input.calib,
                 "output of cairn calibrate; or OpenCV YAML or XML with M1 D1 M2 D2 R T, ROS camera_info, "
                 "EuRoC's cam0/sensor.yaml, or Kalibr's camchain")
      ->required()
      ->type_name("FILE");
  app.add_option("-o,--output", options->output,
                 "folder for left.png, right.png and calib.txt; several pairs: a sub-folder each")
      ->required()
      ->type_name("DIR");
  app.add_option("--nearest", options->nearest_m,
                 "nearest distance of interest, m; determines ndisp in calib.txt (default: 5 baselines)")
      ->check(CLI::Range(0.01, 1e4).name(""))
      ->type_name("M");
  return [options] { return rectify(*options); };
}

}  // namespace cairn::cli
