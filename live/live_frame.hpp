// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "../io/results.hpp"
#include "../source/sequence.hpp"
#include "../source/sequence_run.hpp"

/// A robot's loop: pairs come from a camera, what is found in the newest one goes to whoever wants to know.
namespace cairn::live {

using Clock = std::chrono::steady_clock;

/// Pairs that were not worked on, since the beginning, by reason.
struct Drops {
  std::uint64_t at_source = 0;  // as SourceStatus::dropped and unpaired
  std::uint64_t replaced = 0;   // a newer pair was there before this one's turn came
  std::uint64_t too_old = 0;    // older than LiveOptions::max_age when its turn came
};

/// All that is known of one pair. Shared by everybody who looks at it, so nobody changes it.
struct LiveFrame {
  std::shared_ptr<const io::SequenceFrame> pair;
  Step step;
  std::vector<LandmarkOfTrack> landmarks;
  std::vector<LandmarkEvent> events;
  Clock::time_point arrived;  // of the pair
  Clock::time_point started;
  Clock::time_point done;
  std::vector<io::StageTime> stages;
  Drops drops;
  io::SourceStatus source;
  double rate_hz = 0;  // of frames done, over the last second or so
  // What it was computed with; the revision counts the changes.
  std::shared_ptr<const FollowConfig> config;
  std::uint64_t revision = 0;
};
using LiveFramePtr = std::shared_ptr<const LiveFrame>;

/// Who is told of every frame. offer() must return at once: a sink has a thread of its own for what takes
/// long, and a NewestSlot (or a bounded queue) before it.
class Sink {
 public:
  Sink() = default;
  virtual ~Sink() = default;
  Sink(const Sink&) = delete;
  Sink& operator=(const Sink&) = delete;
  virtual void offer(const LiveFramePtr& frame) = 0;
  /// The run has ended: what is still to be written is written.
  virtual void finish() {}
  /// A line for the end: how many frames went where; empty for none.
  [[nodiscard]] virtual std::string summary() const { return {}; }
};

}  // namespace cairn::live
