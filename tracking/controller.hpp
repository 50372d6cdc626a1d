// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include "control.hpp"
#include "follower.hpp"

namespace cairn {

/// A value with which objects are steadier.
struct ControlEvent {
  Arm arm;
  std::string before;  // the option's value
  double lead = 0;     // a share
};

/// Looks for better options while a Follower works: beside it, single options' other values are tried on some
/// of the same frames. Counts frames, never time: the same frames make the same choices.
/// (docs/stages/reliability.md)
class Controller {
 public:
  Controller(const FollowConfig& config, std::optional<StereoRig> rig, Exec exec = {});

  /// To be called with each frame after `follower.next()` has made `step` of it.
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
  int samples_ = 0;     // frames of a block, by which a round compares
  std::optional<Follower> candidate_;
  int left_ = 0;       // frames of the block at hand
  double credit_ = 0;  // frames that may be segmented a second time
  int since_report_;
  std::string last_option_;  // that helped
  float step_ = 2;           // of numbers
  std::vector<Arm> reported_;
};

}  // namespace cairn
