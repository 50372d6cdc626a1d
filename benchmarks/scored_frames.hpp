// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/cairn.hpp>
#include <cairn/core/each_index.hpp>
#include <cairn/evaluation/disparity_error.hpp>
#include <cairn/evaluation/object_error.hpp>
#include <filesystem>
#include <io/dataset.hpp>
#include <io/image_files.hpp>
#include <optional>
#include <string>
#include <vector>

#include <timing/statistics.hpp>

/// Frames with their truth in memory, and how well a configuration does on them.
namespace cairn::report {

struct TrueFrame {
  std::string name;
  io::PicturePair pictures;
  std::optional<StereoRig> rig;
  int num_disparities = 64;
  Image<TruthId> objects;      // empty where not known
  bool partial = false;        // not every object is labelled
  Image<float> truth_px;       // empty where not known
  Image<std::uint8_t> hidden;  // 1 = not seen by the right camera; empty where not known
};

/// Throws Error where a file is missing or damaged.
TrueFrame load_true_frame(const io::FrameFiles& files);
/// One frame per sub-folder, by name.
std::vector<TrueFrame> load_true_frames(const std::filesystem::path& folder);

struct Score {
  FrameObjects objects;
  DisparityErrors disparity;  // where both cameras see
  double milliseconds = 0;    // of one core, for the whole method
};

/// The whole method on one frame, on the calling thread. `grey`: the pictures' colour is withheld.
Frame segment_frame(const TrueFrame& frame, Config config, bool grey, const Exec& exec);
Score score(const TrueFrame& frame, const Config& config, bool grey, const Exec& exec);

/// All frames, in their order, several at a time, each on one thread.
std::vector<Score> score_all(const std::vector<TrueFrame>& frames, const Config& config, bool grey,
                             int threads);

}  // namespace cairn::report
