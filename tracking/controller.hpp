// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include "control.hpp"
#include "follower.hpp"

namespace cairn {

/// An option value that makes objects steadier.
struct ControlEvent {
  Arm arm;
  std::string before;  // the value of the option
  double lead = 0;     // share
};

/// Searches for better options next to a Follower: tries other values of single options on some of the same
/// frames. Counts frames, never time: the same frames give the same choices. (docs/stages/reliability.md)
class Controller {
 public:
  Controller(const FollowConfig& config, std::optional<StereoRig> rig, Exec exec = {});

  /// To be called after `follower.next()` has returned `step` for the frame.
  std::optional<ControlEvent> next(const StereoPair& pair, const Step& step);

 private:
  void begin_search(Size image);
  void begin_block();
  std::optional<ControlEvent> end_block();

  FollowConfig config_;
  std::optional<StereoRig> rig_;
  Exec exec_;
  std::vector<ArmScore> round_;
  std::size_t at_ = 0;  // in round_
  int samples_ = 0;     // frames per block of a round
  std::optional<Follower> candidate_;
  int left_ = 0;       // frames left in the current block
  double credit_ = 0;  // frames that may still be segmented a second time
  int since_report_;
  std::string last_option_;  // the last one that helped
  float step_ = 2;           // factor for numbers
  std::vector<Arm> reported_;
};

}  // namespace cairn
