// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/sequence.hpp>

#include <cairn/input/binned_sequence.hpp>

#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>
#include <cairn/io/read_file.hpp>
#include <filesystem>
#include <set>
#include <system_error>

#include <cairn/input/camera/open_camera.hpp>
#include <cairn/input/frame_list.hpp>
#include <cairn/input/frame_watch.hpp>
#include <cairn/input/mcap_sequence.hpp>
#include <cairn/input/open_parts.hpp>
#include <cairn/io/names_and_numbers.hpp>
#include <cairn/io/raster.hpp>
#include <cairn/ros/mcap.hpp>

namespace cairn::input {
namespace {

namespace fs = std::filesystem;

/// Whether each of the images can be read by itself.
bool are_readable(const ListedFrame& files) {
  try {
    (void)io::load_picture(files.left);
    if (!files.right.empty()) (void)io::load_picture(files.right);
    if (files.given) (void)io::load_values(*files.given);
    return true;
  } catch (const Error&) {
    return false;
  }
}

bool is_same(const std::optional<StereoRig>& a, const std::optional<StereoRig>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  return a->focal_px == b->focal_px && a->cx_px == b->cx_px && a->cy_px == b->cy_px &&
         a->baseline_m == b->baseline_m && a->doffs_px == b->doffs_px;
}

/// A sequence of image files.
class FileSequence : public SourceSequence {
 public:
  FileSequence(std::string name, FrameList list, const SourceOptions& options, Pool pool)
      : SourceSequence(options.max_gap_s),
        name_(std::move(name)),
        list_(std::move(list)),
        pool_(std::move(pool)) {
    remarks_ = std::move(list_.remarks);
    const ListedFrame& first = list_.frames.front();
    const std::optional<fs::path> found = first.calib ? first.calib : list_.calib;
    each_has_own_ = options.calib.empty() && first.calib && !list_.is_raw && !options.rectify;
    if (options.rectify && first.given)
      throw Error("--rectify: " + first.given->path.string() + " belongs to a rectified image");
    calibration_ = open_calibration(options, found, list_.grey_cameras, list_.is_raw, [&] {
      return io::load_pair(first.left, first.right, first.layout).left.gray.size();
    });
    if (each_has_own_) calib_bytes_ = io::read_file(calibration_.path, io::kMaxTextBytes);
    first_ = load(first);
    std::ranges::move(calibration_.remarks(first.name), std::back_inserter(remarks_));
  }

  [[nodiscard]] std::optional<std::size_t> size() const override { return list_.frames.size(); }
  [[nodiscard]] std::string name() const override { return name_; }
  [[nodiscard]] std::string stamps_from() const override { return list_.stamps_from; }

 private:
  std::optional<SequenceFrame> advance() override {
    while (at_ < list_.frames.size()) {
      const ListedFrame& files = list_.frames[at_++];
      if (!watch_.continues(files.stamp, files.name, remarks_)) continue;
      try {
        return load(files);
      } catch (const Error& error) {
        // Only undecodable files are skipped; images that do not fit mean that this is no sequence.
        if (are_readable(files)) throw;
        remark(remarks_,
               {"frame that cannot be read", 1, files.name + " (" + error.what() + ")", true, true});
      }
    }
    return std::nullopt;
  }

  SequenceFrame load(const ListedFrame& files) {
    if (each_has_own_) check_calibration(files);
    io::LoadedPair pair = images_of(files);
    bits_ = pair.bits;
    // Raw images are compared by their own size.
    if (watch_.image_size().area() > 0 && pair.left.gray.size() != raw_size_) {
      throw Error(files.left.string() + ": is " + text(pair.left.gray.size()) + ", expected " +
                  text(raw_size_) + " like the frames before");
    }
    raw_size_ = pair.left.gray.size();
    pair = calibration_.rectified(std::move(pair), pool_);
    const bool is_depth = files.given && files.given->depth_units_per_m;
    if (watch_.image_size().area() == 0) {
      calibration_.suit(pair.left.gray.size());
      if (is_depth) calibration_.says.rig = io::rig_of_depth(calibration_.says);
    }
    SequenceFrame frame{files.name, files.index, files.stamp, std::move(pair.left),
                        std::move(pair.right.gray)};
    if (files.given) {
      frame.disparity_px = io::load_given(*files.given, frame.left.gray.size(), calibration_.says.rig, pool_);
    }
    watch_.see(frame, files.left.string(), remarks_);
    return frame;
  }

  /// An image without a right one is scaled like a pair.
  io::LoadedPair images_of(const ListedFrame& files) const {
    if (!files.right.empty()) return io::load_pair(files.left, files.right, files.layout, pool_, bits_);
    const io::Raster raster = io::read_raster(files.left, io::Palette::colours);
    io::LoadedPair pair = io::pair_of(raster, raster, pool_, bits_);
    pair.right = {};
    return pair;
  }

  void check_calibration(const ListedFrame& files) {
    if (!files.calib || *files.calib == calibration_.path ||
        io::read_file(*files.calib, io::kMaxTextBytes) == calib_bytes_)
      return;
    const io::Calibration own = io::load_calibration(*files.calib, list_.grey_cameras);
    const bool is_depth = files.given && files.given->depth_units_per_m;
    if (!is_same(is_depth ? io::rig_of_depth(own) : own.rig, calibration_.says.rig)) {
      throw Error(files.calib->string() + ": differs from the calibration " + calibration_.path.string() +
                  ", expected one rig for the whole sequence");
    }
  }

  std::string name_;
  FrameList list_;
  Pool pool_;
  bool each_has_own_ = false;
  std::string calib_bytes_;
  Size raw_size_;
  int bits_ = 8;
  std::size_t at_ = 1;  // index in the list; the first one is read when opening
};

bool exists(const fs::path& path) {
  std::error_code unknown;
  return fs::exists(path, unknown);
}

std::string name_of(const fs::path& path) {
  return fs::absolute(path).lexically_normal().filename().string();
}

void check(const SourceOptions& options) {
  const auto refuse = [](const std::string& option, double value, const std::string& expected) {
    throw Error(option + ": found " + std::to_string(value) + ", expected " + expected);
  };
  if (!(options.rate_hz >= 0 && options.rate_hz <= 1e6)) refuse("--rate", options.rate_hz, "Hz, 0 ... 1e6");
  if (!(options.max_gap_s > 0)) refuse("--max-gap", options.max_gap_s, "a positive number of s");
  if (!(options.max_skew_ms >= 0)) refuse("--max-skew", options.max_skew_ms, "ms, not negative");
  if (!(options.open_timeout_s > 0 && options.open_timeout_s <= 1e6))
    refuse("--open-timeout", options.open_timeout_s, "s, above 0 ... 1e6");
  (void)io::layout_of(options.layout);
  io::check_binning(options.binning);
}

void check_no_topics(const SourceOptions& options, const std::string& source) {
  if (!options.topics.empty())
    throw Error("--topics " + options.topics + ": is for a recording (MCAP) or ros2:, " + source +
                " is none");
}

void check_no_layout(const SourceOptions& options, const std::string& source) {
  if (!options.layout.empty())
    throw Error("--layout " + options.layout + ": is for images or one video with both images, " + source +
                " is none");
}

[[noreturn]] void refuse_maps(const io::MapOptions& maps, const std::string& source) {
  throw Error(std::string(!maps.disparity.empty() ? "--disparity"
                          : !maps.depth.empty()   ? "--depth-image"
                                                  : "--depth-units") +
              ": is for a folder of frames, " + source + " is none");
}

std::unique_ptr<Sequence> open_pair(const std::string& left, const std::string& right,
                                    const SourceOptions& options, const Pool& pool) {
  check_no_layout(options, left + "," + right);
  if (left.empty() || right.empty())
    throw Error(left + "," + right + ": expected a left part before and a right part after the comma");
  if (!is_pattern(left) && !is_pattern(right)) {
    for (const std::string& side : {left, right}) {
      if (!exists(side)) throw Error(side + ": not found, expected a folder, a video or a pattern");
    }
    if (io::is_folder(left) != io::is_folder(right))
      throw Error(left + "," + right + ": is one folder and one file, expected two folders or two files");
    if (!io::is_folder(left)) return open_videos(left, right, options, pool);
  } else if (is_pattern(left) != is_pattern(right)) {
    throw Error(left + "," + right + ": has one pattern, expected two");
  }
  return std::make_unique<FileSequence>(name_of(left), list_two(left, right, options), options, pool);
}

/// Recordings that only their makers' programs read.
void refuse_other_recording(const std::string& source) {
  struct Known {
    const char* extension;
    const char* what;
  };
  constexpr std::array kKnown{
      Known{".db3", "a ROS 2 recording in SQLite, expected MCAP (ros2 bag convert, storage_id: mcap)"},
      Known{".bag", "a recording of ROS 1 or a RealSense, expected MCAP (for ROS 1: mcap convert)"},
      Known{".svo", "a recording of the ZED, expected images or a video (ZED_SVO_Export)"},
      Known{".svo2", "a recording of the ZED, expected images or a video (ZED_SVO_Export)"}};
  for (const auto& [extension, what] : kKnown) {
    if (fs::path(source).extension() == extension) throw Error(source + ": is " + what);
  }
}

/// Regardless of binning.
std::unique_ptr<Sequence> open_whole(const std::string& source, const SourceOptions& options,
                                     const Pool& pool) {
  if (source.empty()) throw Error("SOURCE: found an empty name, expected a folder or a video");
  if (options.maps.any() && (is_camera(source) || !io::is_folder(source) || recording_of(source)))
    refuse_maps(options.maps, source);
  if (exists(source) && !is_camera(source)) {
    if (const auto recording = recording_of(source)) {
      check_no_layout(options, source);
      return open_mcap(*recording, options, pool);
    }
  }
  if (source.starts_with("ros2:") && !exists(source)) {
    check_no_layout(options, source);
    return open_ros2(source, options, pool);
  }
  check_no_topics(options, source);
  if (is_camera(source)) return open_camera(source, options, pool);
  for (const char* web : {"http://", "https://"}) {
    if (source.starts_with(web)) {
      throw Error(source + ": expected gst:'souphttpsrc location=" + source +
                  " is-live=true ! decodebin' for an HTTP camera");
    }
  }
  if (!exists(source)) {
    if (const std::size_t comma = source.find(','); comma != std::string::npos)
      return open_pair(source.substr(0, comma), source.substr(comma + 1), options, pool);
    if (is_pattern(source))
      throw Error(source + ": is one pattern, expected two: left_%04d.png,right_%04d.png");
    throw Error(
        source +
        ": not found, expected a folder of frames, a recording (.mcap), a video, LEFT,RIGHT, or a camera or topics "
        "(v4l2:, gst:, rtsp://, ros2:)");
  }
  if (!io::is_folder(source)) {
    refuse_other_recording(source);
    if (fs::is_character_file(source))
      throw Error(source + ": is a device, expected v4l2:" + source + " for a camera");
    if (options.layout.empty()) {
      throw Error(source +
                  ": is one file, expected --layout side_by_side or top_bottom for a video with both images, "
                  "or LEFT,RIGHT");
    }
    return open_video(source, options, pool);
  }
  const fs::path folder = (fs::path(source) / "").parent_path();  // without a trailing slash
  return std::make_unique<FileSequence>(name_of(folder), list_folder(folder, options), options, pool);
}

}  // namespace

StereoPair pair_of(const SequenceFrame& frame) {
  if (frame.right.empty()) {
    throw Error("frame " + frame.name +
                ": has a depth image or disparities instead of a right image, expected a pair");
  }
  return StereoPair::from(frame.left.gray, frame.right, frame.left.rgb);
}

std::vector<std::string> split_topics(const std::string& topics) {
  std::vector<std::string> names(1);
  for (const char c : topics) {
    if (c == ',') {
      names.emplace_back();
    } else {
      names.back() += c;
    }
  }
  const std::set<std::string> different(names.begin(), names.end());
  if (names.size() < 2 || names.size() > 3 || different.size() < names.size() || different.contains(""))
    throw Error("--topics: found " + topics + ", expected LEFT,RIGHT, IMAGE,DEPTH or LEFT,RIGHT,DEPTH");
  return names;
}

FrameRange parse_frame_range(std::string_view text) {
  const auto refuse = [&] {
    throw Error("--frames " + std::string(text) +
                ": expected FIRST:END or FIRST:END:STEP with FIRST < END and STEP > 0 (10:60, ::2), or the "
                "number of first ones");
  };
  FrameRange range;
  const std::size_t first_colon = text.find(':');
  if (first_colon == std::string_view::npos) {
    range.last_excluded = io::whole<std::size_t>(text);
    if (!range.last_excluded || *range.last_excluded == 0) refuse();
    return range;
  }
  const std::size_t second_colon = std::min(text.find(':', first_colon + 1), text.size());
  const std::string_view first = text.substr(0, first_colon);
  const std::string_view last = text.substr(first_colon + 1, second_colon - first_colon - 1);
  if (!first.empty()) {
    if (!io::whole<std::size_t>(first)) refuse();
    range.first = *io::whole<std::size_t>(first);
  }
  if (!last.empty()) {
    range.last_excluded = io::whole<std::size_t>(last);
    if (!range.last_excluded || *range.last_excluded <= range.first) refuse();
  }
  if (second_colon < text.size()) {
    const auto step = io::whole<std::size_t>(text.substr(second_colon + 1));
    if (!step || *step == 0) refuse();
    range.step = *step;
  }
  return range;
}

std::unique_ptr<Sequence> open_sequence(const std::string& source, const SourceOptions& options,
                                        const Pool& pool) {
  check(options);
  std::unique_ptr<Sequence> sequence = open_whole(source, options, pool);
  return options.binning == 1 ? std::move(sequence) : binned(std::move(sequence), options.binning, pool);
}

}  // namespace cairn::input
