// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/sequence/controller.hpp>

#include <algorithm>
#include <exception>
#include <utility>

namespace cairn {
namespace {

constexpr int kFirstSamples = 2;  // frames of the first round of many candidates
constexpr int kMaxWindows = 4;    // after as many windows without a certain gain a candidate is dropped
constexpr float kMinStep = 2;
constexpr float kMaxStep = 8;
constexpr double kObvious = 0.5;  // a gain large enough to skip further rounds

}  // namespace

Controller::Controller(const FollowConfig& start)
    : control_(start.control),
      start_(start.segmentation),
      preset_(nearest_preset(start.segmentation)),
      since_report_(start.control.cooldown) {}

void Controller::begin_search(const Config& config, Size image) {
  std::vector<OptionCandidate> candidates = restoring_candidates(config, preset_, image);
  is_restoring_ = !is_restoring_ && !candidates.empty();
  if (!is_restoring_) {
    candidates = option_candidates(config, image, step_);
    // A change that was an improvement is undone only for a clear one.
    for (const OptionCandidate& back : differences(config, start_)) {
      if (std::ranges::find(candidates, back) == candidates.end()) candidates.push_back(back);
    }
  }
  round_.clear();
  for (const OptionCandidate& candidate : candidates) {
    const auto is_it = [&](const OptionCandidate& r) {
      return r.option == candidate.option && r.value == candidate.value;
    };
    if (std::ranges::none_of(reported_, is_it)) round_.push_back({candidate, {}, {}});
  }
  // Try first what helped last.
  std::stable_partition(round_.begin(), round_.end(),
                        [&](const CandidateScore& s) { return s.candidate.option == last_option_; });
  at_ = 0;
  samples_ = is_restoring_ ? control_.window : kFirstSamples;
}

void Controller::begin_block(const Follower& follower) {
  FollowConfig config = follower.config();
  set(config.segmentation, round_[at_].candidate.option, round_[at_].candidate.value);
  candidate_.emplace(follower.with(std::move(config)));
  left_ = samples_ + 1;  // one more, as the first frame's predecessor has the present setting
  credit_ -= left_;
}

std::optional<ControlEvent> Controller::end_block(const Config& config) {
  candidate_.reset();
  if (gain_of(round_[at_]).mean > kObvious) {
    round_ = {round_[at_]};
  } else if (++at_ < round_.size()) {
    return std::nullopt;
  }
  at_ = 0;
  const bool has_seen_objects =
      std::ranges::any_of(round_, [](const CandidateScore& s) { return !s.of_candidate.empty(); });
  if (!has_seen_objects) return std::nullopt;  // compare again
  round_ = halved(std::move(round_), control_.min_gain);
  samples_ = std::min(4 * samples_, control_.window);
  const auto best =
      std::ranges::find_if(round_, [&](const CandidateScore& s) { return is_better(s, control_); });
  if (best == round_.end()) {
    const auto most = static_cast<std::size_t>(kMaxWindows * control_.window);
    std::erase_if(round_, [&](const CandidateScore& s) { return s.of_candidate.size() >= most; });
    if (round_.empty() && !is_restoring_) step_ = step_ < kMaxStep ? 2 * step_ : kMinStep;
    return std::nullopt;
  }
  if (since_report_ < control_.cooldown) return std::nullopt;
  const bool tunes = control_.method == ControlMethod::tune;
  const ControlEvent event{best->candidate, tunes, value_of(config, best->candidate.option),
                           gain_of(*best).mean};
  round_.clear();
  since_report_ = 0;
  last_option_ = event.candidate.option;
  step_ = kMinStep;
  is_restoring_ = false;  // the next search is
  if (!tunes) reported_.push_back(event.candidate);
  return event;
}

void Controller::forget() {
  if (candidate_) candidate_->forget();
}

std::optional<ControlEvent> Controller::next(const TrackedFrame& step, const Follower& follower,
                                             const Again& again) {
  ++since_report_;
  credit_ += double{control_.budget};
  const Config& config = follower.config().segmentation;
  try {
    if (!candidate_) {
      if (round_.empty()) begin_search(config, step.ids.size());
      if (!round_.empty() && credit_ >= samples_ + 1) begin_block(follower);
      return std::nullopt;
    }
    const TrackedFrame tried = again(*candidate_);
    const bool has_objects = tried.reliability.steadiness > 0 || step.reliability.steadiness > 0;
    if (--left_ < samples_ && has_objects) {
      round_[at_].of_candidate.push_back(tried.reliability.steadiness);
      round_[at_].of_present.push_back(step.reliability.steadiness);
    }
  } catch (const std::exception&) {  // such as no memory: the candidate loses, the frame's results do not
    if (round_.empty()) return std::nullopt;
    round_[at_].of_candidate.assign(2, 0);
    round_[at_].of_present.assign(2, 1);
    left_ = 0;
  }
  return left_ == 0 ? end_block(config) : std::nullopt;
}

}  // namespace cairn
