// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/dds/ros2_sequence.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cairn/core/error.hpp>
#include <cairn/io/frame_names.hpp>
#include <cairn/io/raster.hpp>
#include <cstdio>
#include <iterator>
#include <memory>
#include <mutex>
#include <thread>
#include <variant>

#include <cairn/input/frame_list.hpp>
#include <cairn/input/frame_watch.hpp>
#include <cairn/input/ros_depth.hpp>
#include <cairn/input/ros_pictures.hpp>
#include <cairn/input/stamped_images.hpp>
#include <cairn/io/names_and_numbers.hpp>
#include <cairn/ros/dds/participant.hpp>
#include <cairn/ros/from_step.hpp>
#include <cairn/sequence/stamp_pairing.hpp>

namespace cairn::input {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr std::string_view kPrefix = "ros2:";
/// How long the first pair waits for the cameras' camera_info.
constexpr auto kInfoWait = 2s;
/// How long a frame with depth waits for the right image that checks it.
constexpr auto kRightWait = 50ms;
/// Time without a pair after which the cameras count as lost.
constexpr auto kSilence = 3s;

std::string seconds_of(double seconds) {
  std::array<char, 32> words{};
  std::snprintf(words.data(), words.size(), "%g s", seconds);
  return words.data();
}

class Ros2Sequence : public LiveSequence {
 public:
  Ros2Sequence(std::string source, const SourceOptions& options, Pool pool)
      : LiveSequence(options, std::move(pool)),
        source_(std::move(source)),
        prefix_(prefix_of(source_)),
        topics_(topics_of(options)),
        left_(participant_, topics_[0]),
        right_(second_reader(participant_, topics_[1], options.topics)),
        rights_reader_(is_checked() ? std::make_unique<ros::Reader<ros::Image>>(participant_, topics_[2])
                                    : nullptr),
        infos_{ros::Reader<ros::CameraInfo>(participant_, info_topic(topics_[0])),
               ros::Reader<ros::CameraInfo>(participant_, info_topic(topics_.back()))},
        wait_(participant_, readers()),
        pairing_(options.max_skew_ms, [this](std::size_t, auto&&) { ++unpaired_; }) {
    calibration_ = open_calibration(options, std::nullopt, false, false);
    first_ = opened();
  }

  [[nodiscard]] std::string name() const override { return prefix_.empty() ? "/" : prefix_; }
  [[nodiscard]] std::string stamps_from() const override { return "header.stamp of " + topics_[0]; }

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
    std::variant<ros::Image, ros::DisparityImage> message;
    Clock::time_point arrived;
    [[nodiscard]] const ros::Image& image() const { return std::get<ros::Image>(message); }
  };
  using SecondReader = std::variant<ros::Reader<ros::Image>, ros::Reader<ros::DisparityImage>>;
  using Pairing = StampPairing<ReceivedImage>;
  using Pair = Pairing::Pair;

  static constexpr std::size_t kMaxWaiting = 4;  // images of one side waiting for the other

  static std::string prefix_of(const std::string& source) {
    const std::string name = source.substr(kPrefix.size());
    return name.empty() || name == "/" ? "" : ros::checked_name(name, "SOURCE " + source);
  }
  /// The left images, the second ones, and the right images if these check depths of the second.
  [[nodiscard]] std::vector<std::string> topics_of(const SourceOptions& options) const {
    const auto of_side = [&](const char* side) {
      return prefix_ + "/" + side + (options.rectify ? "/image_raw" : "/image_rect");
    };
    if (options.topics.empty()) return {of_side("left"), of_side("right")};
    std::vector<std::string> topics;
    // Below the name of the source, unless they begin with a slash.
    for (const std::string& name : split_topics(options.topics))
      topics.push_back(ros::checked_name(name.starts_with('/') ? name : prefix_ + "/" + name, "--topics"));
    if (topics.size() == 3) std::swap(topics[1], topics[2]);
    return topics;
  }
  static std::string info_topic(const std::string& image) {
    return image.substr(0, image.rfind('/')) + "/camera_info";
  }
  [[nodiscard]] bool is_checked() const { return topics_.size() == 3; }
  /// DDS has to know the type before the first message.
  static SecondReader second_reader(const ros::Participant& participant, const std::string& topic,
                                    const std::string& named) {
    if (named.find("disparity", std::min(named.rfind(','), named.size())) != std::string::npos)
      return ros::Reader<ros::DisparityImage>(participant, topic);
    return ros::Reader<ros::Image>(participant, topic);
  }
  [[nodiscard]] const ros::BytesReader& reader(std::size_t side) const {
    if (side == 0) return left_;
    return std::visit([](const auto& reader) -> const ros::BytesReader& { return reader; }, right_);
  }
  [[nodiscard]] std::vector<const ros::BytesReader*> readers() const {
    std::vector<const ros::BytesReader*> all{&left_, &reader(1)};
    if (rights_reader_) all.push_back(rights_reader_.get());
    return all;
  }
  [[nodiscard]] std::uint64_t lost() const {
    std::uint64_t sum = 0;
    for (const ros::BytesReader* each : readers()) sum += each->lost();
    return sum;
  }

  /// Whether the second one is a depth or disparity image.
  [[nodiscard]] bool has_depth(const Pair& pair) const {
    const auto* const second = std::get_if<ros::Image>(&pair.right.value.message);
    if (second == nullptr || is_checked()) return true;
    return !options_.topics.empty() &&
           is_depth_of(second->encoding, pair.left.value.image().encoding, topics_[1], topics_[0]);
  }

  /// The next message of a side, with its stamp.
  std::optional<std::pair<Stamp, ReceivedImage>> take(std::size_t side) {
    const auto received = [](auto& reader) -> std::optional<std::pair<Stamp, ReceivedImage>> {
      auto message = reader.take();
      if (!message) return std::nullopt;
      const Stamp stamp = ros::stamp_of(message->header.stamp);
      return std::pair(stamp, ReceivedImage{std::move(*message), Clock::now()});
    };
    return side == 0 ? received(left_) : std::visit(received, right_);
  }

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
      take_rights();
      for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
        try {
          auto image = take(side);
          if (!image) continue;
          is_idle = false;
          has_come_[side] = true;
          pairing_.push_live(side, image->first, std::move(image->second), kMaxWaiting);
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

  void take_rights() {
    while (rights_reader_) {
      try {
        const std::optional<ros::Image> right = rights_reader_->take();
        if (!right) return;
        rights_.push(ros::stamp_of(right->header.stamp), raster_of(*right));
        has_right_ = true;
      } catch (const Error& error) {
        remark(remarks_, {"message that is not an image", 1, "on " + topics_[2] + " (" + error.what() + ")",
                          true, false});
      }
    }
  }
  /// The right image that checks the depth of a frame; waits for it for a moment.
  std::optional<io::Raster> right_at(Stamp stamp, const std::string& frame) {
    if (!is_checked()) return std::nullopt;
    const Clock::time_point until = Clock::now() + kRightWait;
    take_rights();
    // Nobody waits for a camera that has never sent an image.
    while (has_right_ && !rights_.reaches(stamp) && !is_stopped_ && Clock::now() < until) {
      std::this_thread::sleep_for(kRightWait / 20);
      take_rights();
    }
    std::optional<io::Raster> right = rights_.take(stamp);
    if (!right) remark(remarks_, {unchecked_on(topics_[2]), 1, frame, false, false});
    return right;
  }

  /// Reads the cameras' parameters that have arrived; true if those of both, or of an image with depth, are known.
  bool take_infos(const std::optional<Pair>& pair) {
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}})
      while (std::optional<ros::CameraInfo> info = infos_[side].take()) last_infos_[side] = std::move(info);
    return last_infos_[0] && (last_infos_[1] || (!is_checked() && pair && has_depth(*pair)));
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
      const bool has_infos = !needs_infos || take_infos(pair);
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
      if (!reader(side).has_writer()) unknown += (unknown.empty() ? "" : " nor ") + topics_[side];
    }
    return "received nothing on " + silent + within + ", expected " +
           (std::holds_alternative<ros::Reader<ros::DisparityImage>>(right_)
                ? "sensor_msgs/msg/Image and stereo_msgs/msg/DisparityImage"
                : "sensor_msgs/msg/Image") +
           (unknown.empty() ? "; there is a publisher: are messages lost (docs/ros2.md, \"Buffers\")?"
                            : "; no publisher on " + unknown +
                                  " (check ROS_DOMAIN_ID, ROS_LOCALHOST_ONLY and the topic names)");
  }

  void calibrate(const Pair& pair, bool needs_infos) {
    const Size size{static_cast<int>(pair.left.value.image().width),
                    static_cast<int>(pair.left.value.image().height)};
    if (has_depth(pair)) {
      if (options_.rectify) throw Error("--rectify: " + topics_[1] + " belongs to a rectified image");
      calibrate_depth(pair, size, needs_infos);
    } else if (calibration_.rectifier || !needs_infos) {
      calibration_.suit(size);
    } else if (last_infos_[0] && last_infos_[1]) {
      calibration_.says.rig = rig_of_infos(size);
    } else {
      remark_without(last_infos_[0] ? 1 : 0);
    }
  }
  void calibrate_depth(const Pair& pair, Size size, bool needs_infos) {
    if (!needs_infos) {
      calibration_.suit(size);
    } else if (last_infos_[0]) {
      try {
        const bool has_right = is_checked() && last_infos_[1];
        set_cameras(calibration_.says, *last_infos_[0], has_right ? &*last_infos_[1] : nullptr, topics_[0],
                    size);
      } catch (const Error& error) {
        throw Error(source_ + ": " + error.what());
      }
    } else {
      remark_without(0);
    }
    const RosDepth depth = depth_of(pair);
    if (is_checked()) check_baseline(calibration_.says, depth, source_);
    complete(calibration_.says, depth);
    const auto header_of = [](const auto& message) -> const ros::Header& { return message.header; };
    std::ranges::move(remarks_on({topics_[0], pair.left.value.image().header.frame_id, topics_[1],
                                  std::visit(header_of, pair.right.value.message).frame_id},
                                 last_infos_[0] ? &*last_infos_[0] : nullptr),
                      std::back_inserter(remarks_));
  }
  void remark_without(std::size_t info) {
    const std::string& image = info == 0 ? topics_.front() : topics_.back();
    remarks_.push_back({"received nothing on " + info_topic(image) + ": no metres (--calib FILE instead)", 0,
                        "", false, false});
  }
  [[nodiscard]] RosDepth depth_of(const Pair& pair) const {
    try {
      return std::visit([&](const auto& message) { return input::depth_of(message, pool_); },
                        pair.right.value.message);
    } catch (const Error& error) {
      throw Error(topics_[1] + ": " + error.what());
    }
  }

  [[nodiscard]] StereoRig rig_of_infos(Size size) const {
    try {
      return ros::rig_of(*last_infos_[0], *last_infos_[1], size);
    } catch (const Error& error) {
      throw Error(source_ + ": " + error.what());
    }
  }

  /// nullopt without an index, see index_of().
  std::optional<SequenceFrame> frame_of(const Pair& pair) {
    const ros::Header& header = pair.left.value.image().header;
    const Stamp stamp = ros::stamp_of(header.stamp);
    const std::optional<std::size_t> index = index_of(stamp);
    if (!index) return std::nullopt;
    const bool is_depth = has_depth(pair);
    const ros::Image& left = pair.left.value.image();
    const std::optional<io::Raster> checking = right_at(stamp, io::number_text(*index));
    const bool has_right = !is_depth || checking;
    io::LoadedPair images = checking
                                ? pictures_of(left, topics_[0], *checking, topics_[2], bits_, pool_)
                                : pictures_of(left, topics_[0], is_depth ? left : pair.right.value.image(),
                                              topics_[is_depth ? 0 : 1], bits_, pool_);
    bits_ = images.bits;
    images = calibration_.rectified(std::move(images), pool_);
    SequenceFrame frame{
        io::number_text(*index),
        *index,
        stamp,
        std::move(images.left),
        has_right ? std::move(images.right.gray) : Image<Gray>(),
        false,
        std::max(pair.left.value.arrived, pair.right.value.arrived),
        ros::camera_of(header),
    };
    if (is_depth) {
      try {
        frame.disparity_px =
            disparity_of(depth_of(pair), frame.left.gray.size(), calibration_.says.rig, pool_);
      } catch (const Error& error) {
        throw Error(topics_[1] + ": " + error.what());
      }
    }
    watch_.see(frame, source_, remarks_);
    return frame;
  }

  void note_losses(const std::string& before) override {
    note("image without its other half within --max-skew", unpaired_, before);
    note("image that was sent but not received", lost(), before);
  }

  std::string source_;
  std::string prefix_;
  std::vector<std::string> topics_;
  ros::Participant participant_;
  ros::Reader<ros::Image> left_;
  SecondReader right_;
  std::unique_ptr<ros::Reader<ros::Image>> rights_reader_;  // of those that check depths
  StampedImages rights_{options_.max_skew_ms, kMaxWaiting};
  bool has_right_ = false;
  std::array<ros::Reader<ros::CameraInfo>, 2> infos_;
  ros::ReaderWait wait_;
  Pairing pairing_;
  std::array<std::optional<ros::CameraInfo>, 2> last_infos_;
  std::array<bool, 2> has_come_{};
  int bits_ = 8;
  std::atomic<std::uint64_t> unpaired_ = 0;
  std::atomic<Clock::time_point> last_pair_ = Clock::now();
};

}  // namespace

std::unique_ptr<Sequence> ros2_sequence(const std::string& source, const SourceOptions& options,
                                        const Pool& pool) {
  return std::make_unique<Ros2Sequence>(source, options, pool);
}

}  // namespace cairn::input
