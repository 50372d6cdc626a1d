// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <cairn/diagnosis/rig_watch.hpp>
#include <cairn/input/sequence.hpp>
#include <cairn/live/sequence_run.hpp>
#include <cairn/output/results.hpp>
#include <cairn/stereo/match_device.hpp>

/// The loop of a robot: pairs arrive from a camera, the results of the newest go to sinks.
namespace cairn::live {

using Clock = std::chrono::steady_clock;

/// The time from the earlier to the later point, in ms.
inline double ms_between(Clock::time_point earlier, Clock::time_point later) {
  return std::chrono::duration<double, std::milli>(later - earlier).count();
}

/// Pairs dropped since the start, by reason.
struct Drops {
  std::uint64_t at_source = 0;  // SourceStatus::dropped and unpaired
  std::uint64_t replaced = 0;   // replaced by a newer pair before processing
  std::uint64_t too_old = 0;    // older than LiveOptions::max_age before processing
};

/// What the sinks make of a frame: the first that asks for it makes it, the others share it. From any thread.
class Products {
 public:
  /// If `make` throws, the next that asks tries again. A key always has the same type.
  template <class Make>
  auto get(const std::string& key, const Make& make) const {
    using Product = decltype(make());
    Entry& entry = entry_of(key);
    const std::lock_guard lock(entry.mutex);
    if (!entry.product) entry.product = std::make_shared<const Product>(make());
    return std::static_pointer_cast<const Product>(entry.product);
  }

 private:
  struct Entry {
    std::mutex mutex;
    std::shared_ptr<const void> product;
  };
  Entry& entry_of(const std::string& key) const {
    const std::lock_guard lock(mutex_);
    return entries_[key];
  }

  mutable std::mutex mutex_;
  mutable std::map<std::string, Entry> entries_;
};

/// The results of one pair, shared by all sinks, hence immutable.
struct LiveFrame {
  std::shared_ptr<const input::SequenceFrame> pair;
  TrackedFrame step;
  std::vector<LandmarkOfTrack> landmarks;
  std::vector<LandmarkEvent> events;
  std::optional<Pose> map_from_odom;   // nullopt if unknown
  Covariance6 camera_covariance{};     // of the camera's pose in the map, see camera_covariance()
  std::vector<Finding> findings;       // what is wrong with the rig, as far as known
  std::vector<FindingChange> changes;  // of these, with this frame
  Clock::time_point arrived;           // of the pair
  Clock::time_point started;
  Clock::time_point done;
  std::vector<output::StageTime> stages;
  Drops drops;
  input::SourceStatus source;
  std::optional<DeviceReport> device;  // so far; nullopt without one
  double rate_hz = 0;                  // of processed frames, over about a second
  // The configuration used; the revision counts the changes.
  std::shared_ptr<const FollowConfig> config;
  std::uint64_t revision = 0;
  Products products;
};
using LiveFramePtr = std::shared_ptr<const LiveFrame>;

/// A receiver of every frame. offer() must return at once: slow work belongs on a thread of the sink, behind
/// a NewestSlot (or a bounded queue).
class Sink {
 public:
  Sink() = default;
  virtual ~Sink() = default;
  Sink(const Sink&) = delete;
  Sink& operator=(const Sink&) = delete;
  virtual void offer(const LiveFramePtr& frame) = 0;
  /// The loop is alive: called after each stage of a frame, and every 50 ms or so while it waits for a pair, but for one of
  /// a source whose every frame counts; by several threads.
  virtual void note_alive() {}
  /// For a sink that wants the map: about once a second, and at the end of the run. `run`: see LandmarksState.
  [[nodiscard]] virtual bool wants_map() const { return false; }
  virtual void offer_map(const std::shared_ptr<const LandmarkMap>& /*map*/, std::int64_t /*run*/) {}
  /// The run has ended: writes what is left.
  virtual void finish() {}
  /// A line for the end: number of frames by outcome; empty for none.
  [[nodiscard]] virtual std::string summary() const { return {}; }
};

}  // namespace cairn::live
