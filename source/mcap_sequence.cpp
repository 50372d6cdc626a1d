// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "mcap_sequence.hpp"

#include <algorithm>
#include <bit>
#include <cairn/core/error.hpp>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <io/raster.hpp>

#include "../ros/from_step.hpp"
#include "../ros/mcap.hpp"
#include "frame_list.hpp"
#include "frame_watch.hpp"
#include "mcap_topics.hpp"
#include "names_and_numbers.hpp"

namespace cairn::io {
namespace {

namespace fs = std::filesystem;

// So many images of one camera wait for the other's at most.
constexpr std::size_t kMostWaiting = 64;
// And no more of all of them together, but for one of each.
constexpr std::size_t kMostWaitingBytes = std::size_t{512} << 20;

/// How an encoding stores a pixel.
struct Encoding {
  const char* name;
  std::size_t channels;  // in the message
  int bytes_each;
  bool is_reversed;  // blue before red
};
constexpr std::array kEncodings{
    Encoding{"mono8", 1, 1, false}, Encoding{"8UC1", 1, 1, false},   Encoding{"rgb8", 3, 1, false},
    Encoding{"bgr8", 3, 1, true},   Encoding{"8UC3", 3, 1, true},    Encoding{"rgba8", 4, 1, false},
    Encoding{"bgra8", 4, 1, true},  Encoding{"mono16", 1, 2, false}, Encoding{"16UC1", 1, 2, false}};

Raster raster_of(const ros::Image& image) {
  const auto* const encoding =
      std::ranges::find_if(kEncodings, [&](const Encoding& e) { return image.encoding == e.name; });
  if (encoding == kEncodings.end()) {
    throw Error("has the encoding " + image.encoding +
                ", expected mono8, mono16, rgb8, bgr8, rgba8 or bgra8 (debayer others first)");
  }
  check_sides(image.width, image.height);
  const std::size_t pixel = encoding->channels * static_cast<std::size_t>(encoding->bytes_each);
  if (image.step < image.width * pixel || image.data.size() < std::size_t{image.step} * image.height) {
    throw Error("has " + std::to_string(image.data.size()) + " bytes in rows of " +
                std::to_string(image.step) + ", expected those of " + std::to_string(image.width) + "x" +
                std::to_string(image.height) + " pixels of " + std::to_string(pixel));
  }
  Raster raster;
  raster.size = {static_cast<int>(image.width), static_cast<int>(image.height)};
  raster.channels = encoding->channels == 1 ? 1 : 3;
  raster.bytes_each = encoding->bytes_each;
  if (raster.bytes_each == 2) {
    raster.max_value = 65535;
    raster.declared = false;
  }
  const std::size_t out_pixel = static_cast<std::size_t>(raster.channels * raster.bytes_each);
  raster.bytes.resize(std::size_t{image.width} * image.height * out_pixel);
  const bool is_swapped =
      raster.bytes_each == 2 && (image.is_bigendian != 0) != (std::endian::native == std::endian::big);
  for (std::size_t y = 0; y < image.height; ++y) {
    const std::uint8_t* from = image.data.data() + y * image.step;
    std::uint8_t* to = raster.bytes.data() + y * image.width * out_pixel;
    if (pixel == out_pixel && !encoding->is_reversed && !is_swapped) {
      std::memcpy(to, from, image.width * pixel);
      continue;
    }
    for (std::size_t x = 0; x < image.width; ++x, from += pixel, to += out_pixel) {
      std::copy_n(from, out_pixel, to);
      if (encoding->is_reversed) std::swap(to[0], to[2]);
      if (is_swapped) std::swap(to[0], to[1]);
    }
  }
  return raster;
}

/// One camera's images that wait for the other's.
struct Side {
  struct Taken {
    std::size_t index = 0;
    Stamp stamp;
    std::optional<Raster> image;  // none: cannot be read
    std::string trouble;
  };
  ros::McapChannel channel;
  std::size_t seen = 0;
  std::deque<Taken> waiting;
};

class McapSequence : public Sequence {
 public:
  McapSequence(const fs::path& file, const SourceOptions& options, Pool pool)
      : file_(file), options_(options), pool_(std::move(pool)), reader_(file), watch_(options.max_gap_s) {
    const StereoTopics topics = find_stereo_topics(reader_.channels(), options.topics, file.string());
    left_.channel = topics.left;
    right_.channel = topics.right;
    calibrate(topics);
    std::vector<std::uint16_t> wanted{topics.left.id, topics.right.id};
    if (topics.left_grey) wanted.push_back(*topics.left_grey);
    grey_ = topics.left_grey;
    reader_.rewind();
    reader_.only(wanted);
    first_ = advance();
    if (!first_) {
      if (!remarks_.empty())
        throw Error(file_.string() + ": " + remarks_.front().what + ": " + remarks_.front().first);
      throw Error(file_.string() +
                  (options.frames.first > 0
                       ? ": has no frame that is in --frames"
                       : ": contains no images of " + left_.channel.topic + " and " + right_.channel.topic));
    }
    calibration_.suit(watch_.image_size());
  }

  std::optional<SequenceFrame> next() override {
    if (first_) {
      SequenceFrame frame = std::move(*first_);
      first_.reset();
      return frame;
    }
    return advance();
  }
  [[nodiscard]] std::optional<std::size_t> size() const override {
    const auto& counts = reader_.counts();
    const auto left = counts.find(left_.channel.id);
    const auto right = counts.find(right_.channel.id);
    if (left == counts.end() || right == counts.end()) return std::nullopt;
    const FrameRange& range = options_.frames;
    const std::size_t count = std::min(left->second, right->second);
    const std::size_t end = std::min(count, range.last_excluded.value_or(count));
    return end <= range.first ? 0 : (end - range.first + range.step - 1) / range.step;
  }
  [[nodiscard]] std::string name() const override { return file_.filename().string(); }
  [[nodiscard]] Size image_size() const override { return watch_.image_size(); }
  [[nodiscard]] const std::optional<StereoRig>& rig() const override { return calibration_.says.rig; }
  [[nodiscard]] std::optional<int> disparities() const override { return calibration_.says.num_disparities; }
  [[nodiscard]] const KnownGround& ground() const override { return calibration_.says.ground; }
  [[nodiscard]] const Rectifier* rectifier() const override { return calibration_.rectifier.get(); }
  [[nodiscard]] std::string stamps_from() const override {
    return options_.rate_hz > 0 ? rate_text(options_.rate_hz) : "the message headers";
  }
  [[nodiscard]] const std::vector<SourceRemark>& remarks() const override { return remarks_; }
  [[nodiscard]] const std::string& ended_early() const override { return ended_early_; }

 private:
  /// The first message of a channel.
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

  void calibrate(const StereoTopics& topics) {
    const auto recorded = ros::attachment_of(reader_, "calib.txt");
    if (!options_.calib.empty() || (options_.rectify && recorded)) {
      calibration_ = open_calibration(options_, std::nullopt, false, false);
      return;
    }
    if (recorded && !topics.is_raw) {
      calibration_.path = file_ / "calib.txt";
      calibration_.says = parse_calibration(*recorded, calibration_.path);
      return;
    }
    const auto left = first_of<ros::CameraInfo>(topics.left_info);
    const auto right = first_of<ros::CameraInfo>(topics.right_info);
    if (!left || !right) {
      if (topics.is_raw || options_.rectify) refuse_raw("without camera_info");
      return;
    }
    const auto is_distorted = [](const ros::CameraInfo& info) {
      return std::ranges::any_of(info.d, [](double d) { return d != 0; });
    };
    const bool is_raw = topics.is_raw && (is_distorted(*left) || is_distorted(*right));
    if (is_raw && !options_.rectify) refuse_raw("with distortion");
    if (left->k[0] == 0 && left->p[0] == 0) {  // a driver's way to say that it does not know
      remark(remarks_,
             {"camera_info without a calibration: no metres", 0, left_.channel.topic, false, false});
      return;
    }
    calibration_.path = file_ / "camera_info";
    try {
      if (options_.rectify)
        rectify(*left, *right);
      else
        calibration_.says.rig = ros::rig_of(*left, *right);
    } catch (const Error& error) {
      throw Error(file_.string() + ": " + error.what());
    }
  }
  void rectify(const ros::CameraInfo& left, const ros::CameraInfo& right) {
    const auto camera = [](const ros::CameraInfo& info) {
      if (info.distortion_model != "plumb_bob" && info.distortion_model != "rational_polynomial") {
        throw Error("camera_info: found the distortion model " + info.distortion_model +
                    ", expected plumb_bob or rational_polynomial");
      }
      return RawCamera{info.k, info.d, info.r, info.p};
    };
    RawCalibration raw;
    check_sides(left.width, left.height);
    raw.image_size = {static_cast<int>(left.width), static_cast<int>(left.height)};
    raw.left = camera(left);
    raw.right = camera(right);
    calibration_.rectifier = std::make_shared<Rectifier>(raw);
    calibration_.says.rig = calibration_.rectifier->rig();
  }
  [[noreturn]] void refuse_raw(const std::string& how) const {
    throw Error(
        file_.string() + ": " + left_.channel.topic + " are raw images " + how +
        ", expected rectified ones, or --rectify with camera_info or --calib FILE of the raw cameras");
  }

  /// Reads on until the side has so many that wait; false at the end.
  bool has(Side& side, std::size_t count) {
    while (side.waiting.size() < count) {
      const auto message = reader_.next();
      if (!message) return false;
      if (message->channel == left_.channel.id)
        take(left_, *message);
      else if (message->channel == right_.channel.id)
        take(right_, *message);
      else
        take_grey(*message);
      for (Side* full : {&left_, &right_}) {
        while (full->waiting.size() > kMostWaiting ||
               (full->waiting.size() > 1 && bytes_of(*full) > kMostWaitingBytes))
          leave(*full);
      }
    }
    return true;
  }

  static std::size_t bytes_of(const Side& side) {
    std::size_t bytes = 0;
    for (const Side::Taken& taken : side.waiting) bytes += taken.image ? taken.image->bytes.size() : 0;
    return bytes;
  }

  void take(Side& side, const ros::McapMessage& message) {
    Side::Taken taken{side.seen++, message.logged, std::nullopt, {}};
    try {
      if (side.channel.type == ros::CompressedImage::kType) {
        const auto image = ros::decode<ros::CompressedImage>(message.bytes);
        taken.stamp = stamp_of(image.header, message);
        taken.image = decode_raster({reinterpret_cast<const char*>(image.data.data()), image.data.size()},
                                    Palette::colours);
      } else {
        const auto image = ros::decode<ros::Image>(message.bytes);
        taken.stamp = stamp_of(image.header, message);
        taken.image = raster_of(image);
      }
    } catch (const Error& error) {
      taken.trouble = error.what();
    }
    side.waiting.push_back(std::move(taken));
  }
  void take_grey(const ros::McapMessage& message) {
    try {
      const auto image = ros::decode<ros::Image>(message.bytes);
      greys_.emplace_back(stamp_of(image.header, message), raster_of(image));
      std::size_t bytes = 0;
      for (const auto& [stamp, grey] : greys_) bytes += grey.bytes.size();
      while (greys_.size() > kMostWaiting || (greys_.size() > 1 && bytes > kMostWaitingBytes)) {
        bytes -= greys_.front().second.bytes.size();
        greys_.pop_front();
      }
    } catch (const Error&) {  // the colours say it, too, but for rounding
    }
  }
  static Stamp stamp_of(const ros::Header& header, const ros::McapMessage& message) {
    const Stamp stamp = ros::stamp_of(header.stamp);
    return stamp.ns == 0 ? message.logged : stamp;
  }

  struct Both {
    std::size_t index = 0;
    Side::Taken left;
    Side::Taken right;
  };
  /// As pair_by_stamps() does it.
  std::optional<Both> next_pair() {
    const auto apart = [&](std::size_t l, std::size_t r) {
      return std::abs(left_.waiting[l].stamp.ns - right_.waiting[r].stamp.ns);
    };
    const double most_ns = options_.max_skew_ms * 1e6;
    while (has(left_, 1) && has(right_, 1)) {
      // Reading on for the one may have let go of the other.
      if (left_.waiting.empty() || right_.waiting.empty()) continue;
      const auto gap = apart(0, 0);
      if (gap > 0 && has(right_, 2) && !left_.waiting.empty() && apart(0, 1) < apart(0, 0)) {
        leave(right_);
      } else if (gap > 0 && has(left_, 2) && !right_.waiting.empty() && apart(1, 0) < apart(0, 0)) {
        leave(left_);
      } else if (static_cast<double>(apart(0, 0)) > most_ns) {
        leave(left_.waiting[0].stamp < right_.waiting[0].stamp ? left_ : right_);
      } else {
        Both both{pairs_++, std::move(left_.waiting.front()), std::move(right_.waiting.front())};
        left_.waiting.pop_front();
        right_.waiting.pop_front();
        const FrameRange& range = options_.frames;
        if (range.last_excluded && both.index >= *range.last_excluded) {
          is_past_range_ = true;
          return std::nullopt;
        }
        if (is_in(range, both.index)) return both;
      }
    }
    for (Side* side : {&left_, &right_}) {
      while (has(*side, 1)) leave(*side);
    }
    return std::nullopt;
  }
  void leave(Side& side) {
    remark(remarks_, {&side == &left_ ? "left image without a right one" : "right image without a left one",
                      1, number_text(side.waiting.front().index), true, false});
    side.waiting.pop_front();
  }

  std::optional<SequenceFrame> advance() {
    while (std::optional<Both> both = next_pair()) {
      const std::string name = number_text(both->index);
      if (!both->left.image || !both->right.image) {
        const bool is_left = !both->left.image;
        remark(remarks_, {"frame that cannot be read", 1,
                          name + " (" + (is_left ? left_ : right_).channel.topic + " " +
                              (is_left ? both->left : both->right).trouble + ")",
                          true, true});
        continue;
      }
      const Stamp stamp = options_.rate_hz > 0 ? stamp_at(both->index, options_.rate_hz) : both->left.stamp;
      SequenceFrame frame{name, both->index, stamp, {}, {}, false};
      try {
        PicturePair pair = pair_of(*both->left.image, *both->right.image, pool_, bits_);
        bits_ = pair.bits;
        if (std::optional<Raster> grey = grey_at(both->left.stamp, pair.left.gray.size()))
          pair.left.gray = std::move(pair_of(*grey, *grey, pool_).left.gray);
        pair = calibration_.rectified(std::move(pair), pool_);
        frame.left = std::move(pair.left);
        frame.right = std::move(pair.right.gray);
      } catch (const Error& error) {
        throw Error(file_.string() + ": frame " + name + ": " + error.what());
      }
      watch_.see(frame, file_.string(), remarks_);
      return frame;
    }
    end();
    return std::nullopt;
  }
  std::optional<Raster> grey_at(Stamp stamp, Size size) {
    while (!greys_.empty() && greys_.front().first < stamp) greys_.pop_front();
    if (greys_.empty() || greys_.front().first != stamp || greys_.front().second.size != size)
      return std::nullopt;
    return greys_.front().second;
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
  FrameWatch watch_;
  SourceCalibration calibration_;
  std::vector<SourceRemark> remarks_;
  std::string ended_early_;
  Side left_;
  Side right_;
  std::optional<std::uint16_t> grey_;
  std::deque<std::pair<Stamp, Raster>> greys_;
  std::size_t pairs_ = 0;
  int bits_ = 8;
  bool is_past_range_ = false;
  bool is_ended_ = false;
  std::optional<SequenceFrame> first_;
};

}  // namespace

std::unique_ptr<Sequence> open_mcap(const fs::path& file, const SourceOptions& options, const Pool& pool) {
  return std::make_unique<McapSequence>(file, options, pool);
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

}  // namespace cairn::io
