// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/io/raw_calibration.hpp>
#include <cairn/io/stereo_calibration.hpp>
#include <charconv>
#include <iostream>

#include "commands.hpp"
#include "common.hpp"
#include "terminal.hpp"

namespace cairn::cli {
namespace {

struct CalibrateOptions {
  std::string folder;
  std::string board;
  double square_m = 0;
  std::string layout;  // of files with both images
  std::string output = "calib.yaml";
};

std::vector<io::FrameFiles> pairs_of(const CalibrateOptions& options) {
  if (!options.layout.empty()) return io::find_both(options.folder, io::layout_of(options.layout));
  std::vector<io::FrameFiles> pairs = io::find_pairs(options.folder);
  for (const io::FrameFiles& files : pairs) (void)right_of(files);
  return pairs;
}

/// "9x6"
io::Board board_of(const CalibrateOptions& options) {
  constexpr int kMin = 3;
  constexpr int kMax = 100;
  io::Board board{0, 0, options.square_m};
  const char* end = options.board.data() + options.board.size();
  const auto columns = std::from_chars(options.board.data(), end, board.columns);
  const bool has_mark = columns.ptr != end && *columns.ptr == 'x';
  const auto rows = std::from_chars(has_mark ? columns.ptr + 1 : end, end, board.rows);
  const bool is_read = has_mark && rows.ec == std::errc{} && rows.ptr == end;
  if (!is_read || std::min(board.columns, board.rows) < kMin || std::max(board.columns, board.rows) > kMax) {
    throw Error("--board " + options.board +
                ": expected the inner corners of the board, COLUMNSxROWS, e.g. 9x6, each in 3 ... 100");
  }
  return board;
}

/// Sightings of the board in pairs of one size.
struct Detections {
  Size size;
  std::vector<std::string> names;
  std::vector<io::BoardDetection> list;
  std::vector<std::string> without_board;

  [[nodiscard]] std::size_t pairs() const { return names.size() + without_board.size(); }
};

Detections& of_size(std::vector<Detections>& groups, Size size) {
  const auto found =
      std::find_if(groups.begin(), groups.end(), [&](const Detections& group) { return group.size == size; });
  if (found != groups.end()) return *found;
  groups.push_back({size, {}, {}, {}});
  return groups.back();
}

/// Detects the board in all pairs of the most frequent size; names of pairs of another size go to
/// `of_other_size`.
Detections look_at(const std::vector<io::FrameFiles>& pairs, const io::Board& board,
                   std::vector<std::string>& of_other_size) {
  constexpr std::size_t kSuspicious = 3;
  std::vector<Detections> groups;
  const Progress progress(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const bool found_none =
        std::ranges::all_of(groups, [](const Detections& group) { return group.list.empty(); });
    if (i == kSuspicious && found_none) {
      progress.clear();
      std::cerr << "cairn: no board with " << board.columns << "x" << board.rows
                << " inner corners in the first " << i
                << " pairs; still looking (a board of 10x7 squares has 9x6 inner corners)\n";
    }
    progress.at(i, pairs[i].name);
    const io::LoadedPair images = io::load_pair(pairs[i]);
    Detections& group = of_size(groups, images.left.gray.size());
    auto left = io::find_board(images.left.gray, board);
    auto right = io::find_board(images.right.gray, board);
    if (left && right) {
      group.names.push_back(pairs[i].name);
      group.list.push_back({std::move(*left), std::move(*right)});
    } else {
      group.without_board.push_back(pairs[i].name);
    }
  }
  const auto most =
      std::max_element(groups.begin(), groups.end(),
                       [](const Detections& a, const Detections& b) { return a.pairs() < b.pairs(); });
  for (const Detections& group : groups) {
    if (group.size == most->size) continue;
    of_other_size.insert(of_other_size.end(), group.names.begin(), group.names.end());
    of_other_size.insert(of_other_size.end(), group.without_board.begin(), group.without_board.end());
  }
  return std::move(*most);
}

std::string named(const std::vector<std::string>& names) {
  std::string all;
  for (const std::string& name : names) all += " " + name;
  return all;
}

std::string too_few(const Detections& sightings, const CalibrateOptions& options) {
  return "--board " + options.board + ": all inner corners are visible in " +
         std::to_string(sightings.list.size()) + " of " + std::to_string(sightings.pairs()) +
         " pairs, expected at least " + std::to_string(io::kMinSightings) +
         ", preferably fifteen; a board of 10x7 squares has 9x6 inner corners";
}

/// A warning if the side was probably given in other units; else "".
std::string judge_side(const std::string& text) {
  constexpr double kShortest = 1e-4;
  constexpr double kLongest = 1;
  double side = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), side);
  if (error == std::errc{} && end == text.data() + text.size() && side >= kShortest && side <= kLongest)
    return {};
  std::string words = "found " + text + ", expected metres in 0.0001 ... 1";
  if (side > kLongest && side <= 1000 * kLongest)
    words += "; " + text_of("%g mm are ", side) + text_of("%g", side / 1000);
  return words;
}

int calibrate(const CalibrateOptions& options) {
  const io::Board board = board_of(options);
  std::vector<std::string> of_other_size;
  const Detections sightings = look_at(pairs_of(options), board, of_other_size);
  if (sightings.list.size() < io::kMinSightings) throw Error(too_few(sightings, options));
  const io::StereoCalibration found = io::calibrate_stereo(sightings.list, board, sightings.size);
  const StereoRig rig = io::Rectifier(found.raw).rig();
  const std::string error = text_of("%.3f px", found.error_px);
  io::save_raw_calibration(
      options.output, found.raw,
      {"two raw cameras in OpenCV's model, lengths in metres; P1, P2: once rectified",
       "board " + options.board + ", squares of " + text_of("%g m", board.square_m) + ", " +
           std::to_string(sightings.list.size()) + " pairs, reprojection error " + error});
  const auto worst = std::max_element(found.pair_error_px.begin(), found.pair_error_px.end());
  std::cout << "pairs used          " << sightings.list.size() << " of "
            << sightings.pairs() + of_other_size.size() << "\n";
  if (!sightings.without_board.empty())
    std::cout << "whole board unseen " << named(sightings.without_board) << "\n";
  if (!of_other_size.empty()) std::cout << "of another size    " << named(of_other_size) << "\n";
  std::cout << "reprojection error  " << error << " (left alone " << text_of("%.3f", found.left_error_px)
            << ", right alone " << text_of("%.3f", found.right_error_px) << ")\n"
            << "worst pair          "
            << sightings.names[static_cast<std::size_t>(worst - found.pair_error_px.begin())] << ", "
            << text_of("%.3f px", *worst) << "\n"
            << "rows, rectified     " << text_of("%.3f px", found.rows_error_px) << " apart\n"
            << "rectified pair      focal length " << text_of("%.2f px", static_cast<double>(rig.focal_px))
            << ", baseline " << text_of("%.4f m", static_cast<double>(rig.baseline_m)) << ", "
            << text(sightings.size) << "\n"
            << "written             " << options.output << "\n";
  return 0;
}

}  // namespace

Work declare_calibrate(CLI::App& app) {
  auto options = std::make_shared<CalibrateOptions>();
  app.add_option("FOLDER", options->folder,
                 "image pairs of a checkerboard: left01.jpg and right01.jpg ..., left/ and right/, or one "
                 "folder per pair")
      ->required()
      ->type_name("");
  add_layout_option(app, options->layout);
  app.add_option("--board", options->board, "inner corners of the board, columns x rows, e.g. 9x6")
      ->required()
      ->type_name("CxR");
  app.add_option("--square", options->square_m, "side of a square in metres")
      ->required()
      ->check(CLI::Validator(judge_side, ""))
      ->type_name("METRES");
  app.add_option("-o,--output", options->output,
                 "OpenCV YAML with both cameras (M1 D1 M2 D2 R T) and their rectification (R1 R2 P1 P2)")
      ->type_name("FILE")
      ->capture_default_str();
  app.footer("docs/use_your_own_camera.md describes the way from here to objects.");
  return [options] { return calibrate(*options); };
}

}  // namespace cairn::cli
