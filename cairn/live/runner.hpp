// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <atomic>
#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <cairn/live/latencies.hpp>
#include <cairn/live/live_frame.hpp>
#include <cairn/live/newest_slot.hpp>

namespace cairn {
class ScenesAhead;  // private to the library
}

namespace cairn::live {

struct LiveOptions {
  bool every_frame = false;  // no pair is dropped
  // Pairs older than this before processing are dropped; nullopt: never. Not with every_frame.
  std::optional<std::chrono::milliseconds> max_age;
  bool tracks = true;  // false: single frames, as by segment()
  // Instead of both: another way to process a pair, e.g. odometry alone.
  std::function<TrackedFrame(const input::SequenceFrame&, const FollowConfig&, const Exec&)> step;
  // Playback speed of files relative to their stamps; 0 = as fast as possible.
  double pace = 1;
  std::optional<std::chrono::nanoseconds> duration;
  // Called before each frame and often while waiting for one, by two threads at once: true ends the run.
  std::function<bool()> is_ended;
  RunState when_ended = RunState::done;  // state in the map of a run that is_ended has ended

  /// Every frame, as fast as possible.
  static LiveOptions unpaced() {
    LiveOptions options;
    options.every_frame = true;
    options.pace = 0;
    return options;
  }
};

/// The summary of a run.
struct LiveSummary {
  std::uint64_t frames = 0;
  Drops drops;
  double seconds = 0;
  double p50_ms = 0;  // from the arrival of a pair to its results
  double p99_ms = 0;
  double max_ms = 0;
};

/// The frame loop of all commands on sequences: reads pairs from a source, processes and follows them, and offers
/// the frames to the sinks; or gives them one by one with next().
class Runner {
 public:
  /// `source` and the sinks must outlive it. Throws Error like SequenceRun.
  Runner(input::Sequence& source, const std::string& source_name, const SensorFiles& files,
         FollowConfig config, LiveOptions options, const Exec& exec);
  ~Runner();
  Runner(const Runner&) = delete;
  Runner& operator=(const Runner&) = delete;
  void add(Sink& sink) { sinks_.push_back(&sink); }

  /// Runs until the source ends, the duration is over, or stop(). Throws Error for a frame that does not fit.
  LiveSummary run();
  /// Instead of run(), without sinks, for LiveOptions::every_frame: the next frame; null at the end. Throws Error
  /// like run().
  std::shared_ptr<LiveFrame> next();
  /// After the last next(): ends the run in the map. No effect the second time.
  void close(RunState state) { follow_.close(state); }

  /// For sinks in finish(): whether an error has ended the run, or LiveOptions::is_ended.
  [[nodiscard]] bool has_failed() const { return has_failed_; }
  [[nodiscard]] bool was_ended() const { return was_ended_; }
  /// The landmarks after the last frame; by the thread of run().
  [[nodiscard]] const LandmarkUpdate& marked() const { return follow_.marked(); }
  /// See SequenceRun::map_id().
  [[nodiscard]] const std::string& map_id() const { return follow_.map_id(); }
  /// See SequenceRun::assumptions().
  [[nodiscard]] std::vector<std::string> assumptions() const { return follow_.assumptions(); }

  // From any thread:

  /// run() returns after the current frame.
  void stop() noexcept { is_stopped_ = true; }
  /// Sets options by name and value from the next frame on; all, or none if one is refused (throws Error).
  /// Also refuses options that do not suit the size of the frames.
  void set(const std::vector<std::pair<std::string, std::string>>& options);
  /// Restores the initial options.
  void reset();
  [[nodiscard]] std::shared_ptr<const FollowConfig> config() const;
  /// While paused, no pair is read from the source; step() lets one pass. For files only.
  void pause(bool on) {
    steps_ = 0;
    is_paused_ = on;
  }
  void step() {
    if (is_paused_) ++steps_;
  }
  [[nodiscard]] bool is_paused() const { return is_paused_; }

 private:
  using PairPtr = std::shared_ptr<input::SequenceFrame>;

  [[nodiscard]] bool is_over() const;
  /// A pair that is read, with the status of its source then; or why none could be.
  struct ReadPair {
    PairPtr pair;
    input::SourceStatus status;
    std::exception_ptr trouble;
  };
  void read_source(NewestSlot<PairPtr>& slot);
  void wait_for_its_time(const input::SequenceFrame& pair);
  ReadPair read_next();
  PairPtr newest(NewestSlot<PairPtr>& slot);
  bool begins_early(input::SequenceFrame& pair);
  [[nodiscard]] bool overlaps_frames() const;
  /// Begins a pair while the frame before it is at work.
  void prefetch(const input::SequenceFrame& pair);
  TrackedFrame step_of(const input::SequenceFrame& pair);
  std::shared_ptr<LiveFrame> work(PairPtr pair, const input::SourceStatus& status);
  void note_alive() const;
  void offer_map();
  void judge(LiveFrame& frame, const input::SequenceFrame& pair);
  void take_config();
  void take_over(const std::optional<ControlEvent>& control);

  input::Sequence& source_;
  Size image_size_;
  bool has_rig_;
  LiveOptions options_;
  std::vector<Sink*> sinks_;
  std::vector<output::StageTime> stages_;
  Exec exec_;
  SequenceRun follow_;
  std::unique_ptr<ScenesAhead> single_;  // without tracks
  std::optional<ReadPair> read_ahead_;   // by next(), of a file that is not played at its pace
  std::mutex prefetched_mutex_;          // of the next two
  PairPtr prefetched_;                   // by run(): not to be replaced by a newer one
  bool is_working_ = false;
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
  Clock::time_point map_offered_;
  std::optional<std::pair<Stamp, Clock::time_point>>
      played_;  // the previous frame of the file, and when it was due
  Drops drops_;
  bool is_after_gap_ = false;  // a pair after a gap was dropped
  bool has_failed_ = false;
  bool was_ended_ = false;
  int frames_ = 0;
  RigWatch watch_;
  std::deque<Clock::time_point> recent_;
  Latencies latencies_;
};

}  // namespace cairn::live
