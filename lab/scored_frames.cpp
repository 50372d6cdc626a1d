// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "scored_frames.hpp"

#include <cairn/io/calibration_files.hpp>
#include <cairn/io/disparity_files.hpp>

#include <cairn/timing/clock.hpp>

namespace cairn::lab {
namespace {

template <class T>
void require_size(const Image<T>& truth, const TrueFrame& frame) {
  const Size size = frame.images.left.gray.size();
  if (!truth.empty() && truth.size() != size)
    throw Error(frame.name + ": the truth is " + text(truth.size()) + ", the images are " + text(size));
}

}  // namespace

TrueFrame load_true_frame(const io::FrameFiles& files) {
  if (!files.right) throw Error(files.left.string() + ": no right image");
  const io::TruthFiles truth = io::find_truth(files);
  TrueFrame frame;
  frame.name = files.name;
  frame.images = io::load_pair(files.left, *files.right);
  if (files.calib) {
    const io::Calibration calibration = io::load_calibration(*files.calib, files.grey_cameras);
    frame.rig = calibration.rig;
    frame.num_disparities = calibration.num_disparities.value_or(frame.num_disparities);
  }
  frame.partial = truth.partial;
  if (truth.objects) frame.objects = io::truth_ids(io::load_labels(*truth.objects));
  if (truth.disparity) frame.truth_px = io::load_disparity(*truth.disparity);
  if (truth.ground) frame.ground = io::load_picture(*truth.ground).gray;
  if (truth.occlusion) frame.hidden = io::load_hidden(*truth.occlusion);
  require_size(frame.objects, frame);
  require_size(frame.truth_px, frame);
  require_size(frame.ground, frame);
  require_size(frame.hidden, frame);
  return frame;
}

std::vector<TrueFrame> load_true_frames(const std::filesystem::path& folder) {
  std::vector<TrueFrame> frames;
  for (const io::FrameFiles& files : io::find_frames(folder)) frames.push_back(load_true_frame(files));
  return frames;
}

Frame segment_frame(const TrueFrame& frame, Config config, bool grey, const Exec& exec) {
  config.match.num_disparities = frame.num_disparities;
  const io::LoadedImage& left = frame.images.left;
  const View<const Rgb> colour = grey ? View<const Rgb>{} : left.rgb.view();
  return segment(StereoPair::from(left.gray, frame.images.right.gray, colour), frame.rig, config, exec);
}

Score score(const TrueFrame& frame, const Config& config, bool grey, const Exec& exec) {
  const double start = timing::now_ms(CLOCK_THREAD_CPUTIME_ID);
  const Frame found = segment_frame(frame, config, grey, exec);
  Score result;
  result.milliseconds = timing::now_ms(CLOCK_THREAD_CPUTIME_ID) - start;
  if (!frame.objects.empty())
    result.objects = {object_errors(found.objects.labels, frame.objects, {}), frame.partial};
  if (!frame.truth_px.empty())
    result.disparity = disparity_errors(found.disparity.disparity_px, frame.truth_px, frame.hidden, 0);
  return result;
}

std::vector<Score> score_all(const std::vector<TrueFrame>& frames, const Config& config, bool grey,
                             int threads) {
  std::vector<Score> scores(frames.size());
  for_each_index(frames.size(), threads,
                 [&](std::size_t i, const Exec& exec) { scores[i] = score(frames[i], config, grey, exec); });
  return scores;
}

}  // namespace cairn::lab
