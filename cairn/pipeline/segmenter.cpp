// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/pipeline/scenes_ahead.hpp>
#include <cairn/pipeline/segmenter.hpp>
#include <utility>

namespace cairn {

Segmenter::Segmenter(Config config, std::optional<StereoRig> rig, Exec exec)
    : config_(std::move(config)), rig_(rig), exec_(std::move(exec)) {
  validate(config_);
  if (rig_) rig_->validate();
  exec_.pool = Pool::make();
  ahead_ = std::make_shared<ScenesAhead>(config_, rig_, exec_);
}

Frame Segmenter::segment(const StereoPair& pair) const {
  return ahead_->segment(pair);
}

void Segmenter::prefetch(const StereoPair& pair) const {
  ahead_->begin(pair);
}

}  // namespace cairn
