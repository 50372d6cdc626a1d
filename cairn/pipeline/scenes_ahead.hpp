// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/pipeline/methods.hpp>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>

namespace cairn {

/// Frames of one camera that overlap: nothing before the choice of its objects depends on an earlier frame, so all of
/// that is computed for the next frame while the one before is finished. Two frames at work share the threads: each
/// has half of them, which wait for each other less than all of them in one frame. Results do not change. Thread-safe.
class ScenesAhead {
 public:
  /// Throws Error like validate(config).
  ScenesAhead(Config config, std::optional<StereoRig> rig, Exec exec);
  ~ScenesAhead();
  ScenesAhead(const ScenesAhead&) = delete;
  ScenesAhead& operator=(const ScenesAhead&) = delete;

  /// Begins the frame of a pair, of which it makes a copy; with a single thread, its matches only, on the device. No
  /// effect without either, and while two frames are at work. Throws Error like validate() of configuration and size.
  void begin(const StereoPair& pair);
  /// The frame of a pair: the one begun with equal images, or a new one. Drops what was begun before it. Of a frame
  /// that was begun, the observer gets the stages up to the choice now, with their times and without results. Throws
  /// Error like segment().
  Frame segment(const StereoPair& pair, const ObjectChoice& choose = {});
  /// The frame of external disparities, of which none is begun: NaN and ±inf are holes, and there may be nothing else.
  /// All sizes are the same.
  Frame segment(const LeftImage& left, View<const float> disparity_px, const ObjectChoice& choose = {});
  /// From the next begin() and segment() on; drops what was begun. Throws Error like validate(config), without any
  /// change.
  void set_config(Config config);

 private:
  struct Begun;
  /// The threads and buffers of one of two frames.
  struct Lane {
    Exec exec;
    std::unique_ptr<Begun> begun;  // null: nothing is begun
    bool is_used = false;          // by segment()
  };
  struct Work;
  Lane* unused_lane();
  /// Of the frames that were begun and are wanted.
  Lane* oldest(const std::function<bool(const Begun&)>& is_wanted);
  void open_lanes();
  void begin_on_device(const StereoPair& pair, const Config& config);

  mutable std::mutex mutex_;
  std::optional<StereoRig> rig_;
  Exec exec_;
  std::shared_ptr<const Config> config_;
  std::array<Lane, 2> lanes_;  // without an Exec before the first begin()
  bool is_open_ = false;
  std::int64_t next_turn_ = 0;
};

}  // namespace cairn
