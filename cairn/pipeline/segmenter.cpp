// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/pipeline/segmenter.hpp>
#include <utility>

namespace cairn {

Segmenter::Segmenter(Config config, std::optional<StereoRig> rig, Exec exec)
    : config_(std::move(config)), rig_(rig), exec_(std::move(exec)) {
  validate(config_);
  if (rig_) rig_->validate();
  exec_.pool = Pool::make();
}

Frame Segmenter::segment(const StereoPair& pair) const {
  return cairn::segment(pair, rig_, config_, exec_);
}

}  // namespace cairn
