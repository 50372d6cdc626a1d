// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <atomic>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "latencies.hpp"
#include "live_frame.hpp"
#include "newest_slot.hpp"

namespace cairn::live {

struct LiveOptions {
  bool every_frame = false;  // no pair is dropped, however long it takes
  // Pairs that are older than this when their turn comes are dropped; none: never. Not with every_frame.
  std::optional<std::chrono::milliseconds> max_age;
  bool tracks = true;  // off: each frame by itself, as segment() has it
  // Files are played at the pace of their stamps times this; 0 = as fast as they are worked on.
  double pace = 1;
  std::optional<std::chrono::nanoseconds> duration;
  // Asked before each frame, and often while waiting for one: the run ends where it says so.
  std::function<bool()> is_ended;
};

/// What a run came to.
struct LiveSummary {
  std::uint64_t frames = 0;
  Drops drops;
  double seconds = 0;
  double p50_ms = 0;  // from a pair's arrival until all was known of it
  double p99_ms = 0;
  double max_ms = 0;
};

/// Takes pairs from a source, finds and follows what is in them, and offers the frames to the sinks.
class Runner {
 public:
  /// `source` and the sinks must outlive it. Throws Error as SequenceRun does.
  Runner(io::Sequence& source, const std::string& source_name, const io::CompanionFiles& files,
         FollowConfig config, LiveOptions options, const Exec& exec);
  void add(Sink& sink) { sinks_.push_back(&sink); }

  /// Until the source ends, the duration is over, or stop(). Throws Error where a frame does not fit.
  LiveSummary run();

  // From any thread:

  /// run() returns behind the frame at hand.
  void stop() noexcept { is_stopped_ = true; }
  /// Options by name and value, from the next frame on; all or, where one is refused, none (throws Error).
  /// Refused are also those that fit no further frame of this size.
  void set(const std::vector<std::pair<std::string, std::string>>& options);
  /// Those that it began with.
  void reset();
  [[nodiscard]] std::shared_ptr<const FollowConfig> config() const;
  /// Nothing is taken from the source while it is paused; step() lets one pair pass. Of files only.
  void pause(bool on) {
    steps_ = 0;
    is_paused_ = on;
  }
  void step() {
    if (is_paused_) ++steps_;
  }
  [[nodiscard]] bool is_paused() const { return is_paused_; }

 private:
  using PairPtr = std::shared_ptr<io::SequenceFrame>;

  [[nodiscard]] bool is_over() const;
  void read_source(NewestSlot<PairPtr>& slot);
  void wait_for_its_time(const io::SequenceFrame& pair);
  LiveFramePtr work(PairPtr pair);
  void take_config();
  void adopt(FollowConfig config);

  io::Sequence& source_;
  Size image_size_;
  bool has_rig_;
  LiveOptions options_;
  std::vector<Sink*> sinks_;
  std::vector<io::StageTime> stages_;
  Exec exec_;
  io::SequenceRun follow_;
  std::shared_ptr<const FollowConfig> first_config_;
  std::shared_ptr<const FollowConfig> used_config_;
  std::uint64_t used_revision_ = 0;
  mutable std::mutex mutex_;  // of the next two
  std::shared_ptr<const FollowConfig> config_;
  std::uint64_t revision_ = 0;
  std::atomic<bool> is_stopped_ = false;
  std::atomic<bool> is_paused_ = false;
  std::atomic<std::uint64_t> steps_ = 0;
  std::optional<Clock::time_point> deadline_;
  std::optional<std::pair<Stamp, Clock::time_point>> played_;  // the file's frame before, and when it was due
  Drops drops_;
  int frames_ = 0;
  std::deque<Clock::time_point> recent_;
  Latencies latencies_;
};

}  // namespace cairn::live
