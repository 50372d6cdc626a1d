// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <functional>

#include <cairn/sequence/control.hpp>
#include <cairn/sequence/follower.hpp>

namespace cairn {

/// Searches for better options inside a Follower: tries other values of single options on some of the same
/// frames. Counts frames, never time: the same frames give the same choices. (docs/stages/reliability.md)
class Controller {
 public:
  /// `start`: the configuration of the first frame.
  explicit Controller(const FollowConfig& start);

  /// Processes the present frame with another follower.
  using Again = std::function<TrackedFrame(Follower& candidate)>;

  /// `step`: the results of `follower` for the frame. The caller sets what the event says.
  std::optional<ControlEvent> next(const TrackedFrame& step, const Follower& follower, const Again& again);
  /// See Follower::forget().
  void forget();

 private:
  void begin_search(const Config& config, Size image);
  void begin_block(const Follower& follower);
  std::optional<ControlEvent> end_block(const Config& config);

  ControlConfig control_;
  Config start_;   // of the segmentation
  Config preset_;  // nearest to it
  std::vector<CandidateScore> round_;
  std::size_t at_ = 0;  // in round_
  int samples_ = 0;     // frames per block of a round
  std::optional<Follower> candidate_;
  int left_ = 0;       // frames left in the current block
  double credit_ = 0;  // frames that may still be segmented a second time
  int since_report_;
  std::string last_option_;    // the last one that helped
  float step_ = 2;             // factor for numbers
  bool is_restoring_ = false;  // whether the search is among the preset's values
  std::vector<OptionCandidate> reported_;
};

}  // namespace cairn
