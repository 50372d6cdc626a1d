// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/io/disparity_files.hpp>
#include <cairn/io/point_cloud.hpp>
#include <cairn/output/overlay.hpp>
#include <cairn/pipeline/segment.hpp>
#include <cairn/stereo/confidence.hpp>
#include <filesystem>
#include <iostream>
#include <utility>

#include "commands.hpp"
#include "common.hpp"
#include "keep_inputs.hpp"
#include "refusals.hpp"
#include "terminal.hpp"

namespace cairn::cli {
namespace {

struct DisparityOptions {
  InputOptions input;
  ExecOptions exec;
  std::string output;
  std::string confidence;
  std::string ply;
  std::string view;
  bool refined = false;
  float min_confidence = kMinRefined;
};

/// Checked first, so that a bad name does not cost the time of matching.
void check_output(const std::string& output, const MatchConfig& config) {
  const std::string extension = std::filesystem::path(output).extension().string();
  if (extension != ".png" && extension != ".pfm") {
    throw Error(output + ": unknown format of a disparity map, expected .png or .pfm");
  }
  if (extension == ".png" && !io::png_can_hold(config.min_disparity, config.num_disparities)) {
    throw Error(output + ": 16-bit PNG holds disparities from 0 to below 256, found the search range " +
                std::to_string(config.min_disparity) + " to " +
                std::to_string(config.min_disparity + config.num_disparities - 1) + "; write a .pfm");
  }
}

void check_png(const std::string& output, const char* what) {
  if (std::filesystem::path(output).extension().string() != ".png") {
    throw Error(output + ": unknown format of " + what + ", expected .png");
  }
}

void check_ply(const std::string& output, const LoadedFrame& frame) {
  if (std::filesystem::path(output).extension().string() != ".ply") {
    throw Error(output + ": unknown format of a point cloud, expected .ply");
  }
  if (!frame.rig) throw Error("--ply: found no calibration, expected --calib (a point cloud is in metres)");
}

std::string describe(const StereoResult& scene, const LoadedFrame& loaded, double milliseconds,
                     const Exec& exec) {
  const Image<Reject>& reject = scene.disparity.reject;
  std::int64_t valid = 0;
  for (int y = 0; y < reject.height(); ++y)
    valid += std::count(reject.row(y), reject.row(y) + reject.width(), Reject::none);
  std::string all = "disparity on " +
                    percent(static_cast<double>(valid) / static_cast<double>(reject.size().area())) +
                    " of the pixels, " + text_of("%.1f ms", milliseconds) + "\n";
  all += refusals_table(
      count_refusals(scene.disparity, loaded.left.gray, reasons_in_force(loaded.config), exec));
  if (const std::string epipolar = cli::describe(scene.epipolar); !epipolar.empty()) all += epipolar + "\n";
  if (scene.ground.plane) {
    const GroundPlane p = *scene.ground.plane;
    all += "ground: d = " + text_of("%.6f", double(p.a)) + " x " + text_of("%+.6f", double(p.b)) + " y " +
           text_of("%+.4f", double(p.c)) + ", support " + percent(double(scene.ground.support)) + "\n";
  } else {
    all += "ground: none, " + choice_name(scene.ground.refusal, kRefusals) + "\n";
  }
  return all;
}

/// The refined disparities in place of the matched ones.
StereoResult refined(Frame frame, float min_confidence, const Exec& exec) {
  frame.disparity = likely_disparities(frame.refined, frame.disparity.reject, min_confidence, exec);
  frame.confidence = without_holes(std::move(frame.refined.confidence), frame.disparity.reject);
  return frame;
}

int estimate(const DisparityOptions& options) {
  const std::vector<io::FrameFiles> frames = frames_of(options.input);
  if (frames.size() != 1) {
    throw Error(options.input.left + ": holds " + std::to_string(frames.size()) +
                " frames; cairn disparity takes one, cairn segment a folder of them");
  }
  (void)resolve(options.input.config);
  Exec exec = make_exec(options.exec);
  const LoadedFrame loaded = load_frame(frames.front(), options.input, exec);
  std::cerr << loaded.calibration_remarks;
  if (!options.output.empty()) check_output(options.output, loaded.config.match);
  if (!options.confidence.empty()) check_png(options.confidence, "the confidence");
  if (!options.view.empty()) check_png(options.view, "the view");
  if (!options.ply.empty()) check_ply(options.ply, loaded);
  keep_inputs({options.output, options.confidence, options.view, options.ply}, frames.front(), options.input);
  if (!(options.min_confidence >= 0 && options.min_confidence <= 1)) {
    throw Error("--min-confidence: found " + text_of("%g", double(options.min_confidence)) +
                ", expected 0 … 1");
  }
  if (options.refined && loaded.config.pipeline.method != Method::region_tree)
    throw Error("--refined: found pipeline.method=paper, expected region_tree");
  const Stopwatch watch(exec);
  const auto pair = StereoPair::from(loaded.left.gray, loaded.right, loaded.left.rgb);
  const StereoResult scene =
      options.refined ? refined(segment(pair, loaded.rig, loaded.config, exec), options.min_confidence, exec)
                      : estimate_disparity(pair, loaded.rig, loaded.config, exec);
  if (!options.output.empty()) io::save_disparity(options.output, scene.disparity.disparity_px);
  if (!options.confidence.empty()) output::save_confidence(options.confidence, scene.confidence);
  if (!options.view.empty()) {
    const Image<Rgb> picture =
        output::draw_disparity(scene.disparity, loaded.rig, reasons_in_force(loaded.config));
    io::save_png(options.view, picture.view());
  }
  if (!options.ply.empty()) {
    io::save_ply(options.ply, loaded.left.gray, loaded.left.rgb, scene.disparity.disparity_px, {},
                 *loaded.rig);
  }
  std::cout << describe(scene, loaded, watch.total_ms(), exec);
  return 0;
}

}  // namespace

Work declare_disparity(CLI::App& app) {
  auto options = std::make_shared<DisparityOptions>();
  add_input_options(app, options->input);
  add_binning_option(app, options->input.binning);
  add_exec_options(app, options->exec);
  add_device_option(app, options->exec);
  app.add_option("-o,--output", options->output,
                 "disparity: file.png (16 bits, disparity x 256, 0 = hole) or file.pfm (float, inf = hole)")
      ->type_name("FILE");
  app.add_option("--confidence", options->confidence,
                 "file.png: confidence of each disparity x 255 (8 bits), 0 = hole")
      ->type_name("FILE");
  app.add_option("--view", options->view,
                 "file.png: disparity in colours, holes coloured by reason, with a legend")
      ->type_name("FILE");
  app.add_option("--ply", options->ply, "file.ply: coloured point cloud in metres; needs a calibration")
      ->type_name("FILE");
  CLI::Option* const refined = app.add_flag(
      "--refined", options->refined,
      "the likeliest disparity of each pixel: gross errors corrected, holes filled; the confidence "
      "is that of these");
  app.add_option("--min-confidence", options->min_confidence,
                 "least confidence of a refined disparity; less likely ones are holes")
      ->capture_default_str()
      ->type_name("0 … 1")
      ->needs(refined);
  return [options] { return estimate(*options); };
}

}  // namespace cairn::cli
