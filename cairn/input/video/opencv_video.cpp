// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/video/opencv_video.hpp>

#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>
#include <cairn/input/frame_list.hpp>
#include <cairn/input/frame_watch.hpp>
#include <cairn/io/dataset.hpp>
#include <cairn/io/frame_names.hpp>
#include <cairn/io/names_and_numbers.hpp>
#include <cairn/sequence/stamp_pairing.hpp>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <opencv2/videoio.hpp>
#include <opencv2/videoio/registry.hpp>
#include <system_error>

namespace cairn::input {
namespace {

namespace fs = std::filesystem;

/// One video file, frame by frame.
class VideoFile {
 public:
  VideoFile(fs::path path, double rate_hz) : path_(std::move(path)), rate_hz_(rate_hz) {
    std::error_code unknown;
    if (!fs::is_regular_file(path_, unknown))
      throw Error(path_.string() + ": is not a file, expected a video");
    if (!cv::videoio_registry::hasBackend(cv::CAP_FFMPEG)) {
      throw Error(
          path_.string() +
          ": cannot be read: this OpenCV was built without FFmpeg (Debian's libopencv-videoio has it)");
    }
    try {
      capture_.open(path_.string(), cv::CAP_FFMPEG);
    } catch (const cv::Exception& exception) {
      throw Error(path_.string() + ": cannot be opened as a video: OpenCV says: " + exception.err);
    }
    if (!capture_.isOpened())
      throw Error(path_.string() + ": cannot be opened as a video: unknown format, truncated, or no codec");
    const double fps = capture_.get(cv::CAP_PROP_FPS);
    if (fps > 0 && std::isfinite(fps)) fps_ = fps;
    const double count = capture_.get(cv::CAP_PROP_FRAME_COUNT);
    if (count >= 1 && count < 1e12) count_ = static_cast<std::size_t>(count);
  }

  /// Advances to the next frame; false after the last.
  bool advance() {
    if (!capture_.grab()) return false;
    const double ms = capture_.get(cv::CAP_PROP_POS_MSEC);
    const Stamp stamp = rate_hz_ > 0 ? stamp_at(grabbed_, rate_hz_) : Stamp{std::llround(ms * 1e6)};
    if (grabbed_ > 0) longest_step_s_ = std::max(longest_step_s_, seconds_between(stamp_, stamp));
    stamp_ = stamp;
    last_ms_ = ms;
    ++grabbed_;
    return true;
  }
  /// Stamp of the current frame.
  [[nodiscard]] Stamp stamp() const { return stamp_; }
  [[nodiscard]] std::size_t index() const { return grabbed_ - 1; }
  /// The current image; nullopt if it cannot be decoded.
  std::optional<cv::Mat> image() {
    cv::Mat image;
    if (!capture_.retrieve(image) || image.empty() || image.depth() != CV_8U ||
        (image.channels() != 1 && image.channels() != 3))
      return std::nullopt;
    return image;
  }

  [[nodiscard]] const fs::path& path() const { return path_; }
  [[nodiscard]] const std::optional<std::size_t>& count() const { return count_; }
  [[nodiscard]] bool is_grey() {
    constexpr std::array kGreyFormats = {"Y800", "GREY", "Y8  "};
    std::array<char, 4> code{};
    const auto number = static_cast<std::uint32_t>(capture_.get(cv::CAP_PROP_CODEC_PIXEL_FORMAT));
    std::memcpy(code.data(), &number, code.size());
    return std::any_of(kGreyFormats.begin(), kGreyFormats.end(), [&](const char* known) {
      return std::string_view(code.data(), code.size()) == known;
    });
  }

  /// A message if the file ends earlier than its header states; else "".
  [[nodiscard]] std::string cut_off() const {
    if (!count_) return {};
    const double length_s = static_cast<double>(*count_) / fps_;
    const double step_s = std::max(1 / fps_, rate_hz_ > 0 ? 0 : longest_step_s_);
    const double end_s = last_ms_ * 1e-3 + step_s;
    if (end_s > length_s - std::max(1.5 * step_s, 0.005 * length_s)) return {};
    std::array<char, 160> words{};
    std::snprintf(words.data(), words.size(),
                  ": is truncated: ends after %zu frames, %.2f s; its header says %.2f s", grabbed_, end_s,
                  length_s);
    return path_.string() + words.data();
  }

 private:
  static constexpr double kUsualFps = 10;
  fs::path path_;
  double rate_hz_;
  cv::VideoCapture capture_;
  double fps_ = kUsualFps;
  std::optional<std::size_t> count_;
  std::size_t grabbed_ = 0;
  Stamp stamp_;
  double last_ms_ = 0;
  double longest_step_s_ = 0;
};

io::LoadedImage picture_of(const cv::Mat& image, bool is_grey, const Pool& pool) {
  const Size size{image.cols, image.rows};
  io::LoadedImage picture;
  if (is_grey || image.channels() == 1) {
    picture.gray = Image<Gray>(size, pool);
    const int step = image.channels();
    for (int y = 0; y < size.height; ++y) {
      const std::uint8_t* from = image.ptr(y);
      Gray* to = picture.gray.row(y);
      for (int x = 0; x < size.width; ++x) to[x] = from[x * step];
    }
    return picture;
  }
  picture.rgb = Image<Rgb>(size, pool);
  for (int y = 0; y < size.height; ++y) {
    const std::uint8_t* from = image.ptr(y);
    Rgb* to = picture.rgb.row(y);
    for (int x = 0; x < size.width; ++x) to[x] = {from[3 * x + 2], from[3 * x + 1], from[3 * x]};
  }
  picture.gray = io::grey_of(picture.rgb.view(), pool);
  return picture;
}

/// Base of sequences from one and from two videos.
class VideoSequence : public SourceSequence {
 public:
  VideoSequence(std::string name, const fs::path& beside, const SourceOptions& options, Pool pool)
      : SourceSequence(options.max_gap_s), name_(std::move(name)), options_(options), pool_(std::move(pool)) {
    const std::optional<fs::path> found =
        io::calibration_in(beside.parent_path().empty() ? "." : beside.parent_path());
    calibration_ = open_calibration(options, found, false, false);
  }

  [[nodiscard]] std::string name() const override { return name_; }
  [[nodiscard]] std::string stamps_from() const override {
    return options_.rate_hz > 0 ? rate_text(options_.rate_hz) : "the video";
  }

 protected:
  /// Both images of the next frame of the range.
  struct NextFrame {
    std::size_t index = 0;
    Stamp stamp;
    std::optional<io::LoadedPair> pair;  // nullopt if it cannot be decoded
  };
  virtual std::optional<NextFrame> next_pair() = 0;

  /// Must be called once by derived classes.
  void begin(const fs::path& file) {
    file_ = file;
    first_ = advance();
    if (!first_) {
      const bool is_ranged = options_.frames.first > 0;
      throw Error(file_.string() +
                  (is_ranged ? ": has no frame that is in --frames" : ": contains no frames"));
    }
    calibration_.suit(watch_.image_size());
  }
  [[nodiscard]] const SourceOptions& options() const { return options_; }
  [[nodiscard]] const Pool& pool() const { return pool_; }
  void remark_on(const SourceRemark& of_one) { remark(remarks_, of_one); }
  void end_early(std::string why) { ended_early_ = std::move(why); }

 private:
  std::optional<SequenceFrame> advance() override {
    while (std::optional<NextFrame> both = next_pair()) {
      const std::string name = io::number_text(both->index);
      if (!watch_.continues(both->stamp, name, remarks_)) continue;
      if (!both->pair) {
        remark_on({"frame that cannot be read", 1, name, true, true});
        continue;
      }
      io::LoadedPair pair = calibration_.rectified(std::move(*both->pair), pool_);
      SequenceFrame frame{name, both->index, both->stamp, std::move(pair.left), std::move(pair.right.gray),
                          false};
      watch_.see(frame, file_.string(), remarks_);
      return frame;
    }
    return std::nullopt;
  }

  std::string name_;
  SourceOptions options_;
  Pool pool_;
  fs::path file_;
};

class OneVideo : public VideoSequence {
 public:
  OneVideo(const fs::path& file, const SourceOptions& options, const Pool& pool)
      : VideoSequence(file.filename().string(), file, options, pool), video_(file, options.rate_hz) {
    begin(file);
  }
  [[nodiscard]] std::optional<std::size_t> size() const override {
    if (!video_.count()) return std::nullopt;
    return options().frames.count_of(*video_.count());
  }

 private:
  std::optional<NextFrame> next_pair() override {
    while (video_.advance()) {
      if (options().frames.is_past(video_.index())) return std::nullopt;
      if (!options().frames.contains(video_.index())) continue;
      NextFrame both{video_.index(), video_.stamp(), {}};
      if (const std::optional<cv::Mat> image = video_.image()) both.pair = halves(*image);
      return both;
    }
    end_early(video_.cut_off());
    return std::nullopt;
  }

  [[nodiscard]] io::LoadedPair halves(const cv::Mat& image) {
    std::array<Rect, 2> places;
    try {
      places = io::halves_of({image.cols, image.rows}, io::layout_of(options().layout));
    } catch (const Error& error) {
      throw Error(video_.path().string() + ": " + error.what());
    }
    const auto picture = [&](const Rect& place) {
      return picture_of(image(cv::Rect(place.x, place.y, place.width, place.height)), video_.is_grey(),
                        pool());
    };
    return {picture(places[0]), picture(places[1]), 8};
  }

  VideoFile video_;
};

class TwoVideos : public VideoSequence {
 public:
  TwoVideos(const fs::path& left, const fs::path& right, const SourceOptions& options, const Pool& pool)
      : VideoSequence(left.filename().string(), left, options, pool),
        videos_{VideoFile(left, options.rate_hz), VideoFile(right, options.rate_hz)},
        pairing_(options.max_skew_ms, [this](std::size_t side, Pairing::WaitingItem&& alone) {
          remark_on({side == 0 ? "left image without a right one" : "right image without a left one", 1,
                     io::number_text(alone.value.index), true, false});
        }) {
    begin(left);
  }
  [[nodiscard]] std::optional<std::size_t> size() const override {
    if (!videos_[0].count() || !videos_[1].count()) return std::nullopt;
    return options().frames.count_of(std::min(*videos_[0].count(), *videos_[1].count()));
  }

 private:
  struct WaitingFrame {
    std::size_t index = 0;
    std::optional<cv::Mat> image;
  };
  using Pairing = StampPairing<WaitingFrame>;

  bool has(std::size_t side, std::size_t count) {
    VideoFile& video = videos_[side];
    while (pairing_.waiting(side).size() < count && video.advance()) {
      // A pair's number is at most that of its frames, so earlier frames can be skipped.
      const bool is_before = video.index() < options().frames.first;
      pairing_.push(side, video.stamp(), {video.index(), is_before ? std::nullopt : video.image()});
    }
    return pairing_.waiting(side).size() >= count;
  }

  std::optional<NextFrame> next_pair() override {
    const auto reading_on = [this](std::size_t side, std::size_t count) { return has(side, count); };
    while (const auto pair = pairing_.next(reading_on)) {
      const std::size_t index = pairs_++;
      if (options().frames.is_past(index)) return std::nullopt;
      if (options().frames.contains(index))
        return NextFrame{index, pair->left.stamp, pair_of(pair->left.value.image, pair->right.value.image)};
    }
    // The rest of the longer one has no counterpart.
    pairing_.leave_all(reading_on);
    const std::string left_words = videos_[0].cut_off();
    end_early(left_words.empty() ? videos_[1].cut_off() : left_words);
    return std::nullopt;
  }

  std::optional<io::LoadedPair> pair_of(const std::optional<cv::Mat>& left,
                                        const std::optional<cv::Mat>& right) {
    if (!left || !right) return std::nullopt;
    if (left->size() != right->size()) {
      throw Error(videos_[1].path().string() + ": is " + text(Size{right->cols, right->rows}) +
                  ", expected " + text(Size{left->cols, left->rows}) + " as " + videos_[0].path().string() +
                  " is");
    }
    return io::LoadedPair{picture_of(*left, videos_[0].is_grey(), pool()),
                          picture_of(*right, videos_[1].is_grey(), pool()), 8};
  }

  std::array<VideoFile, 2> videos_;
  Pairing pairing_;
  std::size_t pairs_ = 0;
};

}  // namespace

std::unique_ptr<Sequence> opencv_video(const fs::path& file, const SourceOptions& options, const Pool& pool) {
  return std::make_unique<OneVideo>(file, options, pool);
}

std::unique_ptr<Sequence> opencv_videos(const fs::path& left, const fs::path& right,
                                        const SourceOptions& options, const Pool& pool) {
  return std::make_unique<TwoVideos>(left, right, options, pool);
}

}  // namespace cairn::input
