// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/camera/camera_sequence.hpp>

#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>
#include <cairn/io/frame_names.hpp>
#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <utility>

#include <cairn/input/camera/stamp_pairer.hpp>
#include <cairn/input/frame_list.hpp>
#include <cairn/input/frame_watch.hpp>
#include <cairn/io/names_and_numbers.hpp>

namespace cairn::input {
namespace {

using Clock = std::chrono::steady_clock;

/// From the steady clock, by which cameras stamp, to the time since 1970, by which ROS does.
std::int64_t ns_of_steady_zero() {
  const auto ns = [](auto now) {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(now.time_since_epoch()).count();
  };
  // In this order: if time passes between them, stamps are early, never in the future.
  const auto since_1970 = ns(std::chrono::system_clock::now());
  return since_1970 - ns(Clock::now());
}

template <class... Values>
std::string formatted(const char* form, Values... values) {
  std::array<char, 200> words{};
  std::snprintf(words.data(), words.size(), form, values...);
  return words.data();
}

class CameraSequence : public LiveSequence {
 public:
  CameraSequence(CameraNames names, std::vector<CameraMaker> makers, const SourceOptions& options, Pool pool,
                 CameraTimes times)
      : LiveSequence(options, std::move(pool)), names_(std::move(names)), pairer_(options.max_skew_ms) {
    calibration_ = open_calibration(options, std::nullopt, false, false);
    const bool has_two = makers.size() > 1;
    for (std::size_t side = 0; side < makers.size(); ++side) {
      cameras_.push_back(std::make_unique<KeptCamera>(std::move(makers[side]), times,
                                                      [this, has_two, side](CameraImage&& image) {
                                                        if (has_two) {
                                                          pair_up(side, std::move(image));
                                                        } else {
                                                          offer(std::move(image));
                                                        }
                                                      }));
    }
    first_ = opened();
  }
  ~CameraSequence() override {
    CameraSequence::stop();
    cameras_.clear();  // before the members that their threads use
  }

  [[nodiscard]] std::string name() const override { return names_.name; }
  [[nodiscard]] std::string stamps_from() const override { return names_.stamps_from; }

  void stop() override {
    LiveSequence::stop();
    for (const auto& camera : cameras_) camera->stop();
  }

  [[nodiscard]] SourceStatus status() const override {
    SourceStatus status;
    status.is_live = true;
    status.clock = "system";
    for (const auto& camera : cameras_) {
      const KeptCamera::State state = camera->state();
      status.is_connected = status.is_connected && state.is_connected;
      status.dropped += state.dropped;
      status.reconnects += state.reconnects;
      if (status.trouble.empty()) status.trouble = trouble_of(*camera, state);
    }
    const std::lock_guard lock(mutex_);
    status.dropped += replaced_;
    status.unpaired = pairer_.unpaired(0) + pairer_.unpaired(1);
    return status;
  }

 private:
  // ---- called on the cameras' threads ----

  void offer(CameraImage&& image) {
    {
      const std::lock_guard lock(mutex_);
      put(std::move(image));
    }
    changed_.notify_one();
  }

  void pair_up(std::size_t side, CameraImage&& image) {
    {
      const std::lock_guard lock(mutex_);
      std::optional<StampPairer::Pair> pair = pairer_.push(side, std::move(image));
      if (!pair) return;
      CameraImage both = std::move(pair->left);
      both.right = std::move(pair->right.left.gray);
      both.arrived = std::max(both.arrived, pair->right.arrived);
      both.is_after_gap = both.is_after_gap || pair->right.is_after_gap;
      put(std::move(both));
    }
    changed_.notify_one();
  }

  void put(CameraImage&& image) {
    if (newest_) {
      ++replaced_;
      image.is_after_gap = image.is_after_gap || newest_->is_after_gap;
    }
    newest_ = std::move(image);
  }

  // ---- called on the consumer's thread ----

  std::optional<SequenceFrame> advance() override {
    std::optional<SequenceFrame> frame;
    while (!is_stopped_ && !frame && !options_.frames.is_past(count_)) {
      if (std::optional<CameraImage> image = taken()) {
        frame = frame_of(std::move(*image));
      } else if (has_ended()) {
        break;
      }
    }
    return frame;
  }

  std::optional<CameraImage> taken() {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, kNotice, [&] { return newest_.has_value(); });
    return std::exchange(newest_, std::nullopt);
  }

  [[nodiscard]] std::string trouble_of(const KeptCamera& camera, const KeptCamera::State& state) const {
    if (cameras_.size() < 2 || state.trouble.empty()) return state.trouble;
    return (&camera == cameras_.front().get() ? "the left camera: " : "the right camera: ") + state.trouble;
  }

  /// The sequence ends when either camera does.
  bool has_ended() {
    for (const auto& camera : cameras_) {
      if (!camera->state().has_ended) continue;
      const std::lock_guard lock(mutex_);
      if (newest_) return false;
      has_ended_ = true;
      return true;
    }
    return false;
  }

  /// The first frame. Throws Error.
  std::optional<SequenceFrame> opened() {
    const Clock::time_point deadline =
        Clock::now() +
        std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options_.open_timeout_s));
    while (true) {
      if (std::optional<CameraImage> image = taken()) {
        if (std::optional<SequenceFrame> frame = frame_of(std::move(*image))) {
          check_calibration();
          note_openings();
          return frame;
        }
      }
      for (const auto& camera : cameras_) {
        const KeptCamera::State state = camera->state();
        if (state.has_failed) throw Error(names_.source + ": " + trouble_of(*camera, state));
      }
      if (has_ended()) throw Error(names_.source + ": ended before its first frame");
      if (count_ == 0 && Clock::now() > deadline) throw Error(names_.source + ": " + why_none());
    }
  }

  [[nodiscard]] std::string why_none() const {
    const std::string within = formatted(" within %g s (--open-timeout)", options_.open_timeout_s);
    for (const auto& camera : cameras_) {
      const KeptCamera::State state = camera->state();
      if (!state.trouble.empty()) return "no frame" + within + ": " + trouble_of(*camera, state);
    }
    const std::lock_guard lock(mutex_);
    if (const std::optional<double> nearest = pairer_.nearest_unpaired_ms()) {
      return "no pair" + within +
             formatted(
                 ": left and right images are %.1f ms apart at least, expected at most %g ms "
                 "(--max-skew)",
                 *nearest, options_.max_skew_ms);
    }
    if (cameras_.size() > 1) {
      for (std::size_t side = 0; side < cameras_.size(); ++side) {
        if (!cameras_[side]->state().is_connected)
          return std::string("no frame of the ") + (side == 0 ? "left" : "right") + " camera" + within;
      }
    }
    return "no frame" + within;
  }

  void check_calibration() {
    calibration_.suit(watch_.image_size());
    std::ranges::move(calibration_.remarks(""), std::back_inserter(remarks_));
  }

  void note_openings() {
    for (const auto& camera : cameras_) {
      for (const std::string& note : camera->state().notes) remarks_.push_back({note, 0, "", false, false});
    }
  }

  /// nullopt without an index, see index_of().
  std::optional<SequenceFrame> frame_of(CameraImage&& image) {
    if (image.right.size() != image.left.gray.size()) {
      throw Error(names_.source + ": the right camera gives " + text(image.right.size()) + ", expected " +
                  text(image.left.gray.size()) + " as the left one");
    }
    is_after_gap_ = is_after_gap_ || image.is_after_gap;
    const Stamp stamp{image.stamp.ns + steady_zero_ns_};
    const std::optional<std::size_t> index = index_of(stamp);
    if (!index) return std::nullopt;
    io::LoadedPair pair =
        calibration_.rectified({std::move(image.left), {std::move(image.right), {}}, 8}, pool_);
    SequenceFrame frame{io::number_text(*index),    *index, stamp,        std::move(pair.left),
                        std::move(pair.right.gray), false,  image.arrived};
    watch_.see(frame, names_.source, remarks_);
    frame.after_gap = frame.after_gap || std::exchange(is_after_gap_, false);
    return frame;
  }

  void note_losses(const std::string& before) override {
    const SourceStatus now = status();
    note("frame dropped unread, or lost by the camera", now.dropped, before);
    std::array<std::uint64_t, 2> unpaired{};
    StampPairer::Skew skew;
    std::uint64_t pairs = 0;
    {
      const std::lock_guard lock(mutex_);
      unpaired = {pairer_.unpaired(0), pairer_.unpaired(1)};
      skew = pairer_.skew();
      pairs = pairer_.pairs();
    }
    note("left image without a right one", unpaired[0], before);
    note("right image without a left one", unpaired[1], before);
    if (now.reconnects > 0) note_once("was lost and came back", text_of_times(now.reconnects));
    if (pairs > 0) note_once("the two cameras are not synchronised", text_of(skew));
    if (has_ended_) note_once("the pipeline ended", "after " + std::to_string(count_) + " frames");
  }

  /// Adds or updates a remark with changing text.
  void note_once(const std::string& head, const std::string& words) {
    const std::string what = head + ": " + words;
    const auto known = std::find_if(remarks_.begin(), remarks_.end(), [&](const SourceRemark& other) {
      return other.what.starts_with(head + ": ");
    });
    if (known == remarks_.end()) {
      remarks_.push_back({what, 0, "", false, false});
    } else {
      known->what = what;
    }
  }

  static std::string text_of_times(std::uint64_t times) {
    return times == 1 ? "once" : std::to_string(times) + " times";
  }

  static std::string text_of(const StampPairer::Skew& skew) {
    std::string words =
        formatted("right images are %.1f to %.1f ms later than left ones", skew.least_ms, skew.most_ms);
    if (skew.drift_over_s >= kMinDriftSeconds) words += formatted(", drift %.0f ppm", skew.drift_ppm);
    return words + "; moving objects get wrong disparities (a common trigger helps)";
  }

  static constexpr double kMinDriftSeconds = 10;

  CameraNames names_;
  // Read once: the stamps do not jump when the system's clock is set.
  std::int64_t steady_zero_ns_ = ns_of_steady_zero();
  bool is_after_gap_ = false;
  bool has_ended_ = false;

  mutable std::mutex mutex_;  // guards the next four
  std::condition_variable changed_;
  std::optional<CameraImage> newest_;
  std::uint64_t replaced_ = 0;
  StampPairer pairer_;

  std::vector<std::unique_ptr<KeptCamera>> cameras_;
};

}  // namespace

std::unique_ptr<Sequence> camera_sequence(CameraNames names, std::vector<CameraMaker> cameras,
                                          const SourceOptions& options, const Pool& pool, CameraTimes times) {
  return std::make_unique<CameraSequence>(std::move(names), std::move(cameras), options, pool, times);
}

}  // namespace cairn::input
