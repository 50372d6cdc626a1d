// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "tuning_frames.hpp"

#include <cairn/core/error.hpp>
#include <cairn/io/disparity_files.hpp>

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

template <class T>
void require_size(const Image<T>& truth, const fs::path& file, const LoadedFrame& frame) {
  if (truth.size() != frame.left.gray.size()) {
    throw Error(file.string() + ": the truth is " + text(truth.size()) + ", the images are " +
                text(frame.left.gray.size()));
  }
}

void load_truth(const io::TruthFiles& files, TuningFiles& frame) {
  frame.partial = files.partial;
  if (files.objects) {
    frame.objects = io::truth_ids(io::load_labels(*files.objects));
    require_size(frame.objects, *files.objects, frame.loaded);
  }
  if (files.disparity) {
    frame.truth_px = io::load_disparity(*files.disparity);
    require_size(frame.truth_px, *files.disparity, frame.loaded);
  }
  if (files.occlusion) {
    frame.hidden = io::load_hidden(*files.occlusion);
    require_size(frame.hidden, *files.occlusion, frame.loaded);
  }
}

TuningFiles load_one(const io::FrameFiles& files, const InputOptions& input, bool with_truth) {
  try {
    TuningFiles frame{files.name, load_frame(files, input, {})};
    validate(frame.loaded.config, frame.loaded.left.gray.size(), frame.loaded.rig.has_value());
    if (with_truth) load_truth(io::find_truth(files), frame);
    return frame;
  } catch (const Error& error) {
    throw Error("frame " + files.name + ": " + error.what());
  }
}

}  // namespace

TuningFrame TuningFiles::frame() const {
  return {name,       StereoPair::from(loaded.left.gray, loaded.right, loaded.left.rgb),
          loaded.rig, loaded.config,
          follows,    objects,
          partial,    truth_px,
          hidden};
}

std::vector<TuningFiles> load_tuning_files(const std::vector<std::string>& folders, InputOptions input,
                                           bool with_truth) {
  std::vector<TuningFiles> frames;
  for (const std::string& folder : folders) {
    std::error_code ignored;
    if (!fs::is_directory(folder, ignored)) {
      throw Error(folder +
                  ": no such folder, expected one with left.png and right.png, or a folder of such folders");
    }
    input.left = folder;
    bool first = true;
    for (const io::FrameFiles& files : frames_of(input)) {
      frames.push_back(load_one(files, input, with_truth));
      TuningFiles& last = frames.back();
      last.follows =
          !first && shows_the_same(frames[frames.size() - 2].loaded.left.gray, last.loaded.left.gray);
      first = false;
    }
  }
  return frames;
}

}  // namespace cairn::cli
