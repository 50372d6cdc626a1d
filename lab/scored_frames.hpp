// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/cairn.hpp>
#include <cairn/core/each_index.hpp>
#include <cairn/evaluation/disparity_error.hpp>
#include <cairn/evaluation/object_error.hpp>
#include <cairn/io/dataset.hpp>
#include <cairn/io/image_files.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <cairn/core/statistics.hpp>

/// Frames with ground truth in memory, and the scores of a configuration on them.
namespace cairn::lab {

struct TrueFrame {
  std::string name;
  io::LoadedPair images;
  std::optional<StereoRig> rig;
  int num_disparities = 64;
  Image<TruthId> objects;      // empty if unknown
  bool partial = false;        // not every object is labelled
  Image<float> truth_px;       // empty if unknown
  Image<Gray> ground;          // 255 = floor; empty if unknown
  Image<std::uint8_t> hidden;  // 1 = not visible to the right camera; empty if unknown
};

/// Throws Error if a file is missing or damaged.
TrueFrame load_true_frame(const io::FrameFiles& files);
/// One frame per subfolder, by name.
std::vector<TrueFrame> load_true_frames(const std::filesystem::path& folder);

struct Score {
  FrameObjects objects;
  DisparityErrors disparity;  // over the pixels visible to both cameras
  double milliseconds = 0;    // of one core, for the whole method
};

/// Runs the whole method on one frame, on the calling thread. `grey`: without the image's colour.
Frame segment_frame(const TrueFrame& frame, Config config, bool grey, const Exec& exec);
Score score(const TrueFrame& frame, const Config& config, bool grey, const Exec& exec);

/// All frames in order, several in parallel, each on one thread.
std::vector<Score> score_all(const std::vector<TrueFrame>& frames, const Config& config, bool grey,
                             int threads);

}  // namespace cairn::lab
