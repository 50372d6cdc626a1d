// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "controller.hpp"

#include <algorithm>
#include <utility>

namespace cairn {
namespace {

constexpr int kFirstSamples = 2;  // frames of the first round
constexpr float kLeastStep = 2;
constexpr float kMostStep = 8;
constexpr double kObvious = 0.5;  // a lead large enough to skip further rounds

std::string value_of(const Config& config, const std::string& option) {
  const std::vector<OptionInfo> all = options(config);
  return std::ranges::find(all, option, &OptionInfo::name)->value;
}

}  // namespace

Controller::Controller(const FollowConfig& config, std::optional<StereoRig> rig, Exec exec)
    : config_(config), rig_(rig), exec_(std::move(exec)), since_report_(config.control.hold) {}

void Controller::begin_search(Size image) {
  round_.clear();
  for (const Arm& arm : arms_of(config_.segmentation, image, step_)) {
    if (std::ranges::find(reported_, arm) == reported_.end()) round_.push_back({arm, {}, {}});
  }
  // Try first what helped last.
  std::stable_partition(round_.begin(), round_.end(),
                        [&](const ArmScore& s) { return s.arm.option == last_option_; });
  at_ = 0;
  samples_ = kFirstSamples;
}

void Controller::begin_block() {
  FollowConfig config = config_;
  set(config.segmentation, round_[at_].arm.option, round_[at_].arm.value);
  candidate_.emplace(config, rig_, exec_);
  left_ = samples_ + 1;  // one more, as the first frame has no predecessor
  credit_ -= left_;
}

std::optional<ControlEvent> Controller::end_block() {
  candidate_.reset();
  if (lead_of(round_[at_]).mean > kObvious) {
    round_ = {round_[at_]};
  } else if (++at_ < round_.size()) {
    return std::nullopt;
  }
  at_ = 0;
  round_ = halved(std::move(round_), config_.control.lead);
  samples_ = std::min(4 * samples_, config_.control.window);
  if (round_.empty()) step_ = step_ < kMostStep ? 2 * step_ : kLeastStep;  // search farther
  const auto best =
      std::ranges::find_if(round_, [&](const ArmScore& s) { return is_better(s, config_.control); });
  if (best == round_.end() || since_report_ < config_.control.hold) return std::nullopt;
  const ControlEvent event{best->arm, value_of(config_.segmentation, best->arm.option), lead_of(*best).mean};
  round_.clear();
  since_report_ = 0;
  last_option_ = event.arm.option;
  step_ = kLeastStep;
  reported_.push_back(event.arm);
  return event;
}

std::optional<ControlEvent> Controller::next(const StereoPair& pair, const Step& step) {
  if (config_.control.method == ControlMethod::off) return std::nullopt;
  ++since_report_;
  credit_ += double{config_.control.budget};
  if (!candidate_) {
    if (round_.empty()) begin_search(pair.size());
    if (round_.empty() || credit_ < samples_ + 1) return std::nullopt;
    begin_block();
  }
  const bool has_pose = rig_ && !step.is_lost;
  const Step tried = candidate_->next(pair, step.stamp, std::nullopt,
                                      has_pose ? std::optional(step.map_from_camera) : std::nullopt);
  if (tried.index > 0) {
    round_[at_].of_arm.push_back(tried.reliability.steadiness);
    round_[at_].of_present.push_back(step.reliability.steadiness);
  }
  return --left_ == 0 ? end_block() : std::nullopt;
}

}  // namespace cairn
