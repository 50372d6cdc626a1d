// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/dds/ros2_sequence.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cairn/core/error.hpp>
#include <cairn/io/frame_names.hpp>
#include <cstdio>
#include <mutex>

#include <cairn/input/frame_list.hpp>
#include <cairn/input/frame_watch.hpp>
#include <cairn/input/ros_pictures.hpp>
#include <cairn/io/names_and_numbers.hpp>
#include <cairn/ros/dds/participant.hpp>
#include <cairn/ros/from_step.hpp>
#include <cairn/sequence/stamp_pairing.hpp>

namespace cairn::input {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr std::string_view kPrefix = "ros2:";
/// Polling interval for stop(), which may run in a signal handler.
constexpr auto kNotice = 50ms;
/// How long the first pair waits for the cameras' camera_info.
constexpr auto kInfoWait = 2s;
/// Time without a pair after which the cameras count as lost.
constexpr auto kSilence = 3s;
constexpr std::array kSides{"left", "right"};

std::string seconds_of(double seconds) {
  std::array<char, 32> words{};
  std::snprintf(words.data(), words.size(), "%g s", seconds);
  return words.data();
}

class Ros2Sequence : public SourceSequence {
 public:
  Ros2Sequence(std::string source, const SourceOptions& options, Pool pool)
      : SourceSequence(options.max_gap_s),
        source_(std::move(source)),
        prefix_(prefix_of(source_)),
        options_(options),
        pool_(std::move(pool)),
        topics_{topic("left"), topic("right")},
        images_{ros::Reader<ros::Image>(participant_, topics_[0]),
                ros::Reader<ros::Image>(participant_, topics_[1])},
        infos_{ros::Reader<ros::CameraInfo>(participant_, prefix_ + "/left/camera_info"),
               ros::Reader<ros::CameraInfo>(participant_, prefix_ + "/right/camera_info")},
        wait_(participant_, {&images_[0], &images_[1]}),
        pairing_(options.max_skew_ms, [this](std::size_t, auto&&) { ++unpaired_; }) {
    calibration_ = open_calibration(options, std::nullopt, false, false);
    first_ = opened();
  }

  std::optional<SequenceFrame> next() override {
    std::optional<SequenceFrame> frame = SourceSequence::next();
    note_losses(frame ? frame->name : io::number_text(count_));
    if (is_stopped_) return std::nullopt;
    return frame;
  }

  [[nodiscard]] std::optional<std::size_t> size() const override {
    const FrameRange& range = options_.frames;
    if (!range.last_excluded) return std::nullopt;
    return range.count_of(*range.last_excluded);
  }
  [[nodiscard]] std::string name() const override { return prefix_.empty() ? "/" : prefix_; }
  [[nodiscard]] std::string stamps_from() const override { return "header.stamp of " + topics_[0]; }

  /// next() polls every 50 ms, so this calls no DDS function and is safe in a signal handler.
  void stop() override { is_stopped_ = true; }

  [[nodiscard]] SourceStatus status() const override {
    SourceStatus status;
    status.is_live = true;
    status.clock = "source";
    status.dropped = lost();
    status.unpaired = unpaired_;
    if (Clock::now() - last_pair_.load() > kSilence) {
      status.is_connected = false;
      status.trouble = "no pair on " + topics_[0] + " and " + topics_[1] + " for more than 3 s";
    }
    return status;
  }

 private:
  struct ReceivedImage {
    ros::Image image;
    Clock::time_point arrived;
  };
  using Pairing = StampPairing<ReceivedImage>;
  using Pair = Pairing::Pair;

  static constexpr std::size_t kMaxWaiting = 4;  // images of one side waiting for the other

  static std::string prefix_of(const std::string& source) {
    const std::string name = source.substr(kPrefix.size());
    return name.empty() || name == "/" ? "" : ros::checked_name(name, "SOURCE " + source);
  }
  [[nodiscard]] std::string topic(const char* side) const {
    return prefix_ + "/" + side + (options_.rectify ? "/image_raw" : "/image_rect");
  }
  [[nodiscard]] std::uint64_t lost() const { return images_[0].lost() + images_[1].lost(); }

  std::optional<SequenceFrame> advance() override {
    std::optional<SequenceFrame> frame;
    while (!is_stopped_ && !frame && !options_.frames.is_past(count_)) {
      if (const auto pair = taken()) {
        frame = frame_of(*pair);
      } else {
        wait_.wait(kNotice);
      }
    }
    return frame;
  }

  /// The pair completed by the next image; nullopt without an image. Invalid messages are skipped, since any
  /// node may publish on a topic.
  std::optional<Pair> taken() {
    while (true) {
      bool is_idle = true;
      for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
        try {
          std::optional<ros::Image> image = images_[side].take();
          if (!image) continue;
          is_idle = false;
          has_come_[side] = true;
          const Stamp stamp = ros::stamp_of(image->header.stamp);
          pairing_.push_live(side, stamp, {std::move(*image), Clock::now()}, kMaxWaiting);
          std::optional<Pair> pair = pairing_.next();
          if (!pair) continue;
          last_pair_ = Clock::now();
          return pair;
        } catch (const Error& error) {
          is_idle = false;
          remark(remarks_, {"message that is not an image", 1,
                            "on " + topics_[side] + " (" + error.what() + ")", true, false});
        }
      }
      if (is_idle) return std::nullopt;
    }
  }

  /// Reads the cameras' parameters that have arrived; true if both are known.
  bool take_infos() {
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}})
      while (std::optional<ros::CameraInfo> info = infos_[side].take()) last_infos_[side] = std::move(info);
    return last_infos_[0] && last_infos_[1];
  }

  /// The first frame. Throws Error.
  SequenceFrame opened() {
    const Clock::time_point deadline =
        Clock::now() +
        std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options_.open_timeout_s));
    const bool needs_infos = calibration_.path.empty();
    std::optional<Pair> pair;
    std::optional<Clock::time_point> since;
    while (true) {
      if (std::optional<Pair> newer = taken()) {
        pair = std::move(newer);
        if (!since) since = Clock::now();
      }
      const bool has_infos = !needs_infos || take_infos();
      if (pair && (has_infos || Clock::now() - *since > kInfoWait)) {
        calibrate(*pair, needs_infos);
        if (std::optional<SequenceFrame> frame = frame_of(*pair)) return std::move(*frame);
        pair.reset();
      }
      if (!pair && Clock::now() > deadline) throw Error(source_ + ": " + why_none());
      wait_.wait(kNotice);
    }
  }

  [[nodiscard]] std::string why_none() const {
    const std::string within = " within " + seconds_of(options_.open_timeout_s) + " in domain " +
                               std::to_string(participant_.domain());
    if (has_come_[0] && has_come_[1]) {
      return "no pair" + within + ": stamps on " + topics_[0] + " and " + topics_[1] +
             " differ by more than " + seconds_of(options_.max_skew_ms * 1e-3) + " (--max-skew)";
    }
    std::string silent;
    std::string unknown;
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
      if (has_come_[side]) continue;
      silent += (silent.empty() ? "" : " and ") + topics_[side];
      if (!images_[side].has_writer()) unknown += (unknown.empty() ? "" : " nor ") + topics_[side];
    }
    return "received nothing on " + silent + within + ", expected sensor_msgs/msg/Image" +
           (unknown.empty() ? "; there is a publisher: are messages lost (docs/ros2.md, \"Buffers\")?"
                            : "; no publisher on " + unknown +
                                  " (check ROS_DOMAIN_ID, ROS_LOCALHOST_ONLY and the topic names)");
  }

  void calibrate(const Pair& pair, bool needs_infos) {
    const Size size{static_cast<int>(pair.left.value.image.width),
                    static_cast<int>(pair.left.value.image.height)};
    if (calibration_.rectifier || !needs_infos) {
      calibration_.suit(size);
    } else if (last_infos_[0] && last_infos_[1]) {
      calibration_.says.rig = rig_of_infos(size);
    } else {
      const char* const side = kSides[last_infos_[0] ? 1 : 0];
      remarks_.push_back(
          {"received nothing on " + prefix_ + "/" + side + "/camera_info: no metres (--calib FILE instead)",
           0, "", false, false});
    }
  }

  [[nodiscard]] StereoRig rig_of_infos(Size size) const {
    try {
      return ros::rig_of(*last_infos_[0], *last_infos_[1], size);
    } catch (const Error& error) {
      throw Error(source_ + ": " + error.what());
    }
  }

  /// nullopt if it is outside the range, or not later than the previous one.
  std::optional<SequenceFrame> frame_of(const Pair& pair) {
    const Stamp stamp = ros::stamp_of(pair.left.value.image.header.stamp);
    if (!watch_.continues(stamp, io::number_text(count_), remarks_)) return std::nullopt;
    const std::size_t index = count_++;
    if (!options_.frames.contains(index)) return std::nullopt;
    io::LoadedPair images =
        pictures_of(pair.left.value.image, topics_[0], pair.right.value.image, topics_[1], bits_, pool_);
    bits_ = images.bits;
    images = calibration_.rectified(std::move(images), pool_);
    SequenceFrame frame{
        io::number_text(index),
        index,
        stamp,
        std::move(images.left),
        std::move(images.right.gray),
        false,
        std::max(pair.left.value.arrived, pair.right.value.arrived),
        ros::camera_of(pair.left.value.image.header),
    };
    watch_.see(frame, source_, remarks_);
    return frame;
  }

  void note_losses(const std::string& before) {
    note("image without its other half within --max-skew", unpaired_, before);
    note("image that was sent but not received", lost(), before);
  }
  /// Adds or updates a remark with a count.
  void note(const char* what, std::uint64_t count, const std::string& before) {
    if (count == 0) return;
    const auto known = std::find_if(remarks_.begin(), remarks_.end(),
                                    [&](const SourceRemark& other) { return other.what == what; });
    if (known == remarks_.end()) {
      remarks_.push_back({what, count, "before " + before, true, false});
    } else {
      known->count = count;
    }
  }

  std::string source_;
  std::string prefix_;
  SourceOptions options_;
  Pool pool_;
  std::array<std::string, 2> topics_;
  ros::Participant participant_;
  std::array<ros::Reader<ros::Image>, 2> images_;
  std::array<ros::Reader<ros::CameraInfo>, 2> infos_;
  ros::ReaderWait wait_;
  Pairing pairing_;
  std::array<std::optional<ros::CameraInfo>, 2> last_infos_;
  std::array<bool, 2> has_come_{};
  std::size_t count_ = 0;
  int bits_ = 8;
  std::atomic<bool> is_stopped_ = false;
  std::atomic<std::uint64_t> unpaired_ = 0;
  std::atomic<Clock::time_point> last_pair_ = Clock::now();
};

}  // namespace

std::unique_ptr<Sequence> ros2_sequence(const std::string& source, const SourceOptions& options,
                                        const Pool& pool) {
  return std::make_unique<Ros2Sequence>(source, options, pool);
}

}  // namespace cairn::input
