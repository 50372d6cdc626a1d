// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/mcap_sequence.hpp>

#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>
#include <cairn/io/frame_names.hpp>
#include <cairn/io/raster.hpp>
#include <iterator>
#include <string_view>
#include <type_traits>

#include <cairn/input/frame_list.hpp>
#include <cairn/input/frame_watch.hpp>
#include <cairn/input/mcap_topics.hpp>
#include <cairn/input/ros_depth.hpp>
#include <cairn/input/ros_pictures.hpp>
#include <cairn/input/stamped_images.hpp>
#include <cairn/io/names_and_numbers.hpp>
#include <cairn/ros/from_step.hpp>
#include <cairn/ros/mcap.hpp>
#include <cairn/sequence/stamp_pairing.hpp>

namespace cairn::input {
namespace {

namespace fs = std::filesystem;

// The most images of one camera that wait for the other …
constexpr std::size_t kMaxWaiting = 64;
// … and the most bytes of all of them, beyond one each.
constexpr std::size_t kMaxWaitingBytes = std::size_t{512} << 20;
// The most left images that are read on for the right one that checks a depth.
constexpr std::size_t kMaxAhead = 4;

/// One camera's images.
struct Side {
  ros::McapChannel channel;
  std::size_t seen = 0;
};
/// An image waiting for that of the other camera, or for its depth.
struct WaitingImage {
  std::size_t index = 0;
  std::optional<io::Raster> image;  // nullopt if it cannot be decoded
  std::optional<RosDepth>
      depth;  // instead, where a depth or disparity image takes the place of the right one
  std::string trouble;
  std::string frame_id;
};

class McapSequence : public SourceSequence {
 public:
  McapSequence(const fs::path& file, const SourceOptions& options, Pool pool)
      : SourceSequence(options.max_gap_s),
        file_(file),
        options_(options),
        pool_(std::move(pool)),
        reader_(file),
        pairing_(options.max_skew_ms, [this](std::size_t side, Pairing::WaitingItem&& alone) {
          const char* const what = has_depth_
                                       ? side == 0 ? "image without its depth" : "depth without its image"
                                   : side == 0 ? "left image without a right one"
                                               : "right image without a left one";
          remark(remarks_, {what, 1, io::number_text(alone.value.index), true, false});
        }) {
    if (reader_.channels().empty() && !reader_.is_whole())
      throw Error(file.string() + ": is truncated before the end of its first chunk: nothing can be read");
    const StereoTopics topics = find_stereo_topics(reader_.channels(), options.topics, file.string());
    sides_[0].channel = topics.left;
    sides_[1].channel = topics.right;
    has_depth_ = topics.has_depth || topics.checking || has_depth_by_encoding(topics);
    if (has_depth_ && options.rectify)
      throw Error("--rectify: " + topics.right.topic + " belongs to a rectified image");
    calibrate(topics);
    std::vector<std::uint16_t> wanted{topics.left.id, topics.right.id};
    if (topics.left_grey) wanted.push_back(*topics.left_grey);
    if (topics.checking) wanted.push_back(topics.checking->id);
    checking_ = topics.checking;
    reader_.rewind();
    reader_.only(wanted);
    first_ = McapSequence::advance();
    if (!first_) {
      const auto& [left, right] = first_stamps_;
      if (left && right && !remarks_.empty() && remarks_.front().what.find("without ") != std::string::npos)
        throw Error(file_.string() + ": " +
                    (has_depth_ ? skew_text(*left, *right, options.max_skew_ms, "image and its depth")
                                : skew_text(*left, *right, options.max_skew_ms)));
      if (!remarks_.empty())
        throw Error(file_.string() + ": " + remarks_.front().what + ": " + remarks_.front().first);
      throw Error(file_.string() + (options.frames.first > 0
                                        ? ": has no frame that is in --frames"
                                        : ": contains no images of " + sides_[0].channel.topic + " and " +
                                              sides_[1].channel.topic));
    }
  }

  [[nodiscard]] std::optional<std::size_t> size() const override {
    const auto& counts = reader_.counts();
    const auto left = counts.find(sides_[0].channel.id);
    const auto right = counts.find(sides_[1].channel.id);
    if (left == counts.end() || right == counts.end()) return std::nullopt;
    return options_.frames.count_of(std::min(left->second, right->second));
  }
  [[nodiscard]] std::string name() const override { return file_.filename().string(); }
  [[nodiscard]] std::string stamps_from() const override {
    return options_.rate_hz > 0 ? rate_text(options_.rate_hz) : "the message headers";
  }

 private:
  using Pairing = StampPairing<WaitingImage>;

  /// The first message on a channel.
  template <class M>
  std::optional<M> first_of(std::optional<std::uint16_t> channel) {
    if (!channel) return std::nullopt;
    reader_.rewind();
    reader_.only({*channel});
    const auto message = reader_.next();
    if (!message) return std::nullopt;
    try {
      return ros::decode<M>(message->bytes);
    } catch (const Error& error) {
      throw Error(file_.string() + ": " + error.what());
    }
  }

  /// Of topics that were named: whether the second one is a depth image of the first.
  bool has_depth_by_encoding(const StereoTopics& topics) {
    if (options_.topics.empty() || topics.right.type != ros::Image::kType) return false;
    const auto encoding_of = [this](const ros::McapChannel& channel) {
      const auto image = channel.type == ros::Image::kType ? first_of<ros::Image>(channel.id) : std::nullopt;
      return image ? image->encoding : std::string();
    };
    return is_depth_of(encoding_of(topics.right), encoding_of(topics.left), topics.right.topic,
                       topics.left.topic);
  }

  void calibrate(const StereoTopics& topics) {
    calibration_.scales = options_.scale_calibration;
    calibration_.binning = options_.binning;
    calibration_.has_search_range = options_.has_search_range;
    const auto recorded = ros::attachment_of(reader_, "calib.txt");
    if (!options_.calib.empty() || (options_.rectify && recorded)) {
      calibration_ = open_calibration(options_, std::nullopt, false, false);
      return;
    }
    if (recorded && !topics.is_raw) {
      calibration_.path = file_ / "calib.txt";
      calibration_.says = io::parse_calibration(*recorded, calibration_.path);
      return;
    }
    const auto left = first_of<ros::CameraInfo>(topics.left_info);
    const auto right =
        has_depth_ && !topics.checking ? std::nullopt : first_of<ros::CameraInfo>(topics.right_info);
    if (has_depth_) {
      if (left) calibrate(*left, right ? &*right : nullptr);
      image_info_ = left;
      return;
    }
    if (!left || !right) {
      if (topics.is_raw || options_.rectify) refuse_raw("without camera_info");
      return;
    }
    const auto is_distorted = [](const ros::CameraInfo& info) {
      return std::ranges::any_of(info.d, [](double d) { return d != 0; });
    };
    const bool is_raw = topics.is_raw && (is_distorted(*left) || is_distorted(*right));
    if (is_raw && !options_.rectify) refuse_raw("with distortion");
    if (left->k[0] == 0 && left->p[0] == 0) {  // a driver's convention for an unknown calibration
      remark(remarks_,
             {"camera_info without a calibration: no metres", 0, sides_[0].channel.topic, false, false});
      return;
    }
    calibration_.path = file_ / "camera_info";
    try {
      if (options_.rectify) {
        rectify(*left, *right);
      } else {
        calibration_.says.rig = ros::rig_of(*left, *right);
        if (const Size size = ros::image_size_of(*left); size.area() > 0) calibration_.says.image_size = size;
      }
    } catch (const Error& error) {
      throw Error(file_.string() + ": " + error.what());
    }
  }
  /// Of an image with depth. `right`: of a right image that checks it, nullptr if unknown.
  void calibrate(const ros::CameraInfo& info, const ros::CameraInfo* right) {
    calibration_.path = file_ / "camera_info";
    try {
      set_cameras(calibration_.says, info, right, sides_[0].channel.topic);
      if (const Size size = ros::image_size_of(info); size.area() > 0) calibration_.says.image_size = size;
    } catch (const Error& error) {
      throw Error(file_.string() + ": " + error.what());
    }
  }
  void rectify(const ros::CameraInfo& left, const ros::CameraInfo& right) {
    const auto camera = [](const ros::CameraInfo& of_sensor) {
      const ros::CameraInfo info = ros::as_published(of_sensor);
      const bool is_fisheye = info.distortion_model == "equidistant" || info.distortion_model == "fisheye";
      if (info.distortion_model != "plumb_bob" && info.distortion_model != "rational_polynomial" &&
          !is_fisheye) {
        throw Error("camera_info: found the distortion model " + info.distortion_model +
                    ", expected plumb_bob, rational_polynomial or equidistant");
      }
      return io::RawCamera{info.k, info.d, info.r, info.p, is_fisheye};
    };
    (void)ros::rig_of(left, right);
    io::RawCalibration raw;
    raw.image_size = ros::image_size_of(left);
    raw.left = camera(left);
    raw.right = camera(right);
    calibration_.rectifier = std::make_shared<io::Rectifier>(raw);
    calibration_.says.rig = calibration_.rectifier->rig();
  }
  [[noreturn]] void refuse_raw(const std::string& how) const {
    throw Error(
        file_.string() + ": " + sides_[0].channel.topic + " are raw images " + how +
        ", expected rectified ones, or --rectify with camera_info or --calib FILE of the raw cameras");
  }

  /// Reads until the side has that many waiting; false at the end.
  bool has(std::size_t side, std::size_t count) {
    while (pairing_.waiting(side).size() < count) {
      if (!read_on()) return false;
    }
    return true;
  }
  /// Takes the next message; false at the end.
  bool read_on() {
    const auto message = reader_.next();
    if (!message) return false;
    if (message->channel == sides_[0].channel.id) {
      take(0, *message);
    } else if (message->channel == sides_[1].channel.id) {
      take(1, *message);
    } else {
      take_accompanying(*message);
    }
    for (const std::size_t full : {std::size_t{0}, std::size_t{1}}) {
      while (pairing_.waiting(full).size() > kMaxWaiting ||
             (pairing_.waiting(full).size() > 1 && bytes_of(full) > kMaxWaitingBytes))
        pairing_.leave(full);
    }
    return true;
  }

  [[nodiscard]] std::size_t bytes_of(std::size_t side) const {
    std::size_t bytes = 0;
    for (const auto& waiting : pairing_.waiting(side))
      bytes += waiting.value.image ? waiting.value.image->bytes.size()
               : waiting.value.depth
                   ? sizeof(float) * static_cast<std::size_t>(waiting.value.depth->values.size().area())
                   : 0;
    return bytes;
  }

  void take(std::size_t side, const ros::McapMessage& message) {
    WaitingImage waiting;
    waiting.index = sides_[side].seen++;
    Stamp stamp = message.logged;
    try {
      if (side == 1 && has_depth_) {
        waiting.depth = depth_in(message, stamp, waiting.frame_id);
      } else {
        waiting.image = raster_in(message, sides_[side].channel.type, stamp, waiting.frame_id);
      }
    } catch (const Error& error) {
      waiting.trouble = error.what();
    }
    if (!first_stamps_[side]) first_stamps_[side] = stamp;
    pairing_.push(side, stamp, std::move(waiting));
  }
  static io::Raster raster_in(const ros::McapMessage& message, std::string_view type, Stamp& stamp,
                              std::string& frame_id) {
    if (type == ros::CompressedImage::kType) {
      const auto image = ros::decode<ros::CompressedImage>(message.bytes);
      stamp = stamp_of(image.header, message);
      frame_id = ros::camera_of(image.header);
      return io::decode_raster({reinterpret_cast<const char*>(image.data.data()), image.data.size()},
                               io::Palette::colours);
    }
    const auto image = ros::decode<ros::Image>(message.bytes);
    stamp = stamp_of(image.header, message);
    frame_id = ros::camera_of(image.header);
    return raster_of(image);
  }
  RosDepth depth_in(const ros::McapMessage& message, Stamp& stamp, std::string& frame_id) {
    const auto decoded = [&]<class M>(std::type_identity<M>) {
      const auto image = ros::decode<M>(message.bytes);
      stamp = stamp_of(image.header, message);
      frame_id = ros::camera_of(image.header);
      return depth_of(image, pool_);
    };
    const std::string& type = sides_[1].channel.type;
    if (type == ros::DisparityImage::kType) return decoded(std::type_identity<ros::DisparityImage>{});
    if (type == ros::CompressedImage::kType) return decoded(std::type_identity<ros::CompressedImage>{});
    return decoded(std::type_identity<ros::Image>{});
  }
  void take_accompanying(const ros::McapMessage& message) {
    const bool is_right = checking_ && message.channel == checking_->id;
    try {
      Stamp stamp;
      std::string unused;
      const std::string_view type = is_right ? std::string_view(checking_->type) : ros::Image::kType;
      io::Raster image = raster_in(message, type, stamp, unused);
      (is_right ? rights_ : greys_).push(stamp, std::move(image));
    } catch (const Error& error) {
      // Colour contains grey, up to rounding.
      if (is_right) {
        remark(remarks_, {"image that cannot be read", 1,
                          "on " + checking_->topic + " (" + error.what() + ")", false, true});
      }
    }
  }
  static Stamp stamp_of(const ros::Header& header, const ros::McapMessage& message) {
    const Stamp stamp = ros::stamp_of(header.stamp);
    return stamp.ns == 0 ? message.logged : stamp;
  }

  /// The next pair of the range, and its index among all pairs.
  std::optional<std::pair<std::size_t, Pairing::Pair>> next_pair() {
    const auto reading_on = [this](std::size_t side, std::size_t count) { return has(side, count); };
    while (auto both = pairing_.next(reading_on)) {
      const std::size_t index = pairs_++;
      if (options_.frames.is_past(index)) {
        is_past_range_ = true;
        return std::nullopt;
      }
      if (options_.frames.contains(index)) return std::pair(index, std::move(*both));
    }
    pairing_.leave_all(reading_on);
    return std::nullopt;
  }

  std::optional<SequenceFrame> advance() override {
    while (auto found = next_pair()) {
      const std::size_t index = found->first;
      Pairing::Pair& both = found->second;
      const std::string name = io::number_text(index);
      const WaitingImage& left = both.left.value;
      const WaitingImage& right = both.right.value;
      if (!left.image || !(right.image || right.depth)) {
        const bool is_left = !left.image;
        remark(remarks_, {"frame that cannot be read", 1,
                          name + " (" + sides_[is_left ? 0 : 1].channel.topic + " " +
                              (is_left ? left : right).trouble + ")",
                          true, true});
        continue;
      }
      const Stamp stamp = options_.rate_hz > 0 ? stamp_at(index, options_.rate_hz) : both.left.stamp;
      if (!watch_.continues(stamp, name, remarks_)) continue;
      SequenceFrame frame{name, index, stamp, {}, {}};
      frame.frame_id = left.frame_id;
      try {
        const std::optional<io::Raster> checking = right_at(both.left.stamp, name);
        const bool has_right = !right.depth || checking;
        const io::Raster& other = checking ? *checking : right.depth ? *left.image : *right.image;
        io::LoadedPair pair = io::pair_of(*left.image, other, pool_, bits_);
        bits_ = pair.bits;
        const std::optional<io::Raster> grey = greys_.take(both.left.stamp);
        if (grey && grey->size == pair.left.gray.size())
          pair.left.gray = std::move(io::pair_of(*grey, *grey, pool_).left.gray);
        pair = calibration_.rectified(std::move(pair), pool_);
        frame.left = std::move(pair.left);
        if (has_right) frame.right = std::move(pair.right.gray);
      } catch (const Error& error) {
        throw Error(file_.string() + ": frame " + name + ": " + error.what());
      }
      if (watch_.image_size().area() == 0) {
        calibration_.suit(frame.left.gray.size());
        if (right.depth) {
          if (checking_) check_baseline(calibration_.says, *right.depth, file_.string());
          complete(calibration_.says, *right.depth);
          std::ranges::move(
              remarks_on({sides_[0].channel.topic, left.frame_id, sides_[1].channel.topic, right.frame_id},
                         image_info_ ? &*image_info_ : nullptr),
              std::back_inserter(remarks_));
        }
      }
      if (right.depth) {
        try {
          frame.disparity_px =
              disparity_of(*right.depth, frame.left.gray.size(), calibration_.says.rig, pool_);
        } catch (const Error& error) {
          throw Error(file_.string() + ": frame " + name + ": " + sides_[1].channel.topic + ": " +
                      error.what());
        }
      }
      watch_.see(frame, file_.string(), remarks_);
      return frame;
    }
    end();
    return std::nullopt;
  }
  /// The right image that checks the depth of a frame.
  std::optional<io::Raster> right_at(Stamp stamp, const std::string& frame) {
    if (!checking_) return std::nullopt;
    const std::size_t most = std::min(pairing_.waiting(0).size() + kMaxAhead, kMaxWaiting);
    while (!rights_.reaches(stamp) && pairing_.waiting(0).size() < most && read_on()) {
    }
    std::optional<io::Raster> right = rights_.take(stamp);
    if (!right) remark(remarks_, {unchecked_on(checking_->topic), 1, frame, false, false});
    return right;
  }
  void end() {
    if (is_ended_) return;
    is_ended_ = true;
    if (reader_.damaged_chunks() > 0) {
      remarks_.push_back({std::to_string(reader_.damaged_chunks()) +
                              " damaged parts of the recording skipped, the first: " + reader_.first_damage(),
                          0,
                          {},
                          true,
                          true});
    }
    if (!reader_.is_whole() && !is_past_range_)
      ended_early_ = file_.string() + ": is truncated: read up to the last complete record";
  }

  fs::path file_;
  SourceOptions options_;
  Pool pool_;
  ros::McapReader reader_;
  std::array<Side, 2> sides_;
  Pairing pairing_;
  std::array<std::optional<Stamp>, 2> first_stamps_;
  std::optional<ros::McapChannel> checking_;  // the right images that check depths
  bool has_depth_ = false;
  std::optional<ros::CameraInfo> image_info_;  // of an image with depth
  StampedImages greys_{0, kMaxWaiting, kMaxWaitingBytes};
  StampedImages rights_{options_.max_skew_ms, kMaxWaiting, kMaxWaitingBytes};
  std::size_t pairs_ = 0;
  int bits_ = 8;
  bool is_past_range_ = false;
  bool is_ended_ = false;
};

}  // namespace

std::unique_ptr<Sequence> open_mcap(const fs::path& file, const SourceOptions& options, const Pool& pool) {
  return std::make_unique<McapSequence>(file, options, pool);
}

std::optional<fs::path> recording_of(const std::string& source) {
  if (io::is_folder(source)) return recording_in(source);
  return ros::is_mcap(source) ? std::optional<fs::path>(source) : std::nullopt;
}

std::optional<fs::path> recording_in(const fs::path& folder) {
  std::error_code unknown;
  if (!fs::is_regular_file(folder / "metadata.yaml", unknown)) return std::nullopt;
  std::vector<fs::path> parts;
  bool has_other = false;
  for (const auto& entry : fs::directory_iterator(folder, unknown)) {
    const std::string ending = entry.path().extension().string();
    if (ending == ".mcap") parts.push_back(entry.path());
    has_other = has_other || ending == ".db3" || ending == ".zstd";
  }
  if (parts.size() == 1) return parts.front();
  if (parts.size() > 1) {
    std::ranges::sort(parts);
    throw Error(folder.string() + ": is a recording in " + std::to_string(parts.size()) +
                " parts, expected one of them: " + parts.front().string());
  }
  if (!has_other) return std::nullopt;
  throw Error(folder.string() +
              ": is a ros2 bag that is not in MCAP, expected MCAP (ros2 bag convert makes it)");
}

}  // namespace cairn::input
