// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "controller.hpp"

#include <algorithm>
#include <utility>

namespace cairn {
namespace {

constexpr int kFirstSamples = 2;  // frames of the first round of many arms
constexpr int kMostWindows = 4;   // after as many windows without a certain lead an arm is dropped
constexpr float kLeastStep = 2;
constexpr float kMostStep = 8;
constexpr double kObvious = 0.5;  // a lead large enough to skip further rounds

std::string value_of(const Config& config, const std::string& option) {
  const std::vector<OptionInfo> all = options(config);
  return std::ranges::find(all, option, &OptionInfo::name)->value;
}

}  // namespace

Controller::Controller(const FollowConfig& config)
    : config_(config),
      start_(config.segmentation),
      preset_(nearest_preset(config.segmentation)),
      since_report_(config.control.hold) {}

void Controller::begin_search(Size image) {
  std::vector<Arm> arms = restoring_arms(config_.segmentation, preset_, image);
  const bool restores = restores_ && !arms.empty();
  restores_ = !restores;
  if (!restores) {
    arms = arms_of(config_.segmentation, image, step_);
    for (Arm back : restoring_arms(config_.segmentation, start_, image)) {
      back.restores = false;  // a change that was an improvement is undone only for a clear one
      if (std::ranges::find(arms, back) == arms.end()) arms.push_back(back);
    }
  }
  round_.clear();
  for (const Arm& arm : arms) {
    if (std::ranges::find(reported_, arm) == reported_.end()) round_.push_back({arm, {}, {}});
  }
  // Try first what helped last.
  std::stable_partition(round_.begin(), round_.end(),
                        [&](const ArmScore& s) { return s.arm.option == last_option_; });
  at_ = 0;
  samples_ = restores ? config_.control.window : kFirstSamples;
}

void Controller::begin_block(const Follower& follower) {
  FollowConfig config = config_;
  set(config.segmentation, round_[at_].arm.option, round_[at_].arm.value);
  candidate_.emplace(follower.with(std::move(config)));
  left_ = samples_ + 1;  // one more, as the first frame's predecessor has the present setting
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
  if (best == round_.end()) {
    const auto most = static_cast<std::size_t>(kMostWindows * config_.control.window);
    std::erase_if(round_, [&](const ArmScore& s) { return s.of_arm.size() >= most; });
    return std::nullopt;
  }
  if (since_report_ < config_.control.hold) return std::nullopt;
  const bool tunes = config_.control.method == ControlMethod::tune;
  const ControlEvent event{best->arm, tunes, value_of(config_.segmentation, best->arm.option),
                           lead_of(*best).mean};
  round_.clear();
  since_report_ = 0;
  last_option_ = event.arm.option;
  step_ = kLeastStep;
  restores_ = true;
  if (tunes) {
    set(config_.segmentation, event.arm.option, event.arm.value);
  } else {
    reported_.push_back(event.arm);
  }
  return event;
}

std::optional<ControlEvent> Controller::next(const Step& step, const Follower& follower, const Again& again) {
  ++since_report_;
  credit_ += double{config_.control.budget};
  if (!candidate_) {
    if (round_.empty()) begin_search(step.ids.size());
    if (!round_.empty() && credit_ >= samples_ + 1) begin_block(follower);
    return std::nullopt;
  }
  const Step tried = again(*candidate_);
  if (--left_ < samples_) {
    round_[at_].of_arm.push_back(tried.reliability.steadiness);
    round_[at_].of_present.push_back(step.reliability.steadiness);
  }
  return left_ == 0 ? end_block() : std::nullopt;
}

}  // namespace cairn
