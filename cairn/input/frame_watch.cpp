// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/frame_watch.hpp>

#include <cairn/core/error.hpp>
#include <cairn/io/raw_calibration.hpp>
#include <string_view>

#include <cairn/input/frame_list.hpp>
#include <cairn/io/frame_names.hpp>
#include <cairn/sequence/stamps.hpp>

namespace cairn::input {
namespace {

namespace fs = std::filesystem;

template <class T>
std::uint64_t hash_of(View<const T> image) {
  constexpr std::uint64_t kFactor = 0x9E3779B97F4A7C15U;
  std::uint64_t hash = 0;
  for (int y = 0; y < image.height(); ++y) {
    const std::string_view row(reinterpret_cast<const char*>(image.row(y)),
                               static_cast<std::size_t>(image.width()) * sizeof(T));
    hash = (hash ^ std::hash<std::string_view>{}(row)) * kFactor;
  }
  return hash;
}

}  // namespace

io::LoadedPair SourceCalibration::rectified(io::LoadedPair pair, const Pool& pool) const {
  if (!rectifier) return pair;
  try {
    return (*rectifier)(pair, pool);
  } catch (const Error& error) {
    throw Error(path.string() + ": " + error.what());
  }
}

void SourceCalibration::suit(Size image) {
  if (rectifier) {
    says.num_disparities = io::disparities_down_to(0, *says.rig, image.width);
  } else if (!path.empty()) {
    says = io::suited(says, image, path, scales);
    if (has_search_range) says.num_disparities.reset();
    io::check_search_range(io::binned(says, image, binning), path);
  }
}

std::vector<SourceRemark> SourceCalibration::remarks(const std::string& first) const {
  std::vector<SourceRemark> remarks;
  const auto add = [&](const std::string& what) {
    remarks.push_back({path.string() + ": " + what, 0, first, false, false});
  };
  for (const std::string& remark : says.remarks) add(remark);
  if (!rectifier && !path.empty() && says.of_raw_cameras) {
    add("describes raw cameras and their distortion; the images are assumed to be rectified (if raw: --rectify)");
  }
  return remarks;
}

SourceCalibration open_calibration(const SourceOptions& options, const std::optional<fs::path>& found,
                                   bool grey_cameras, bool is_raw, const std::function<Size()>& image_size) {
  SourceCalibration calibration;
  calibration.scales = options.scale_calibration;
  calibration.binning = options.binning;
  calibration.has_search_range = options.has_search_range;
  if (!options.calib.empty()) {
    calibration.path = options.calib;
  } else if (found) {
    calibration.path = *found;
  }
  if (is_raw || options.rectify) {
    if (calibration.path.empty())
      throw Error("--rectify: found no calibration, expected that of the raw cameras as --calib FILE");
    calibration.rectifier =
        std::make_shared<io::Rectifier>(io::load_raw_calibration(calibration.path, image_size));
    calibration.says.rig = calibration.rectifier->rig();
  } else if (!calibration.path.empty()) {
    calibration.says = io::load_calibration(calibration.path, grey_cameras);
  }
  return calibration;
}

bool FrameWatch::continues(Stamp stamp, const std::string& name, std::vector<SourceRemark>& remarks) const {
  const ClockStep step = before_ ? clock_step(before_->stamp, stamp) : ClockStep::forward;
  if (step == ClockStep::forward) return true;
  const bool is_left_out = step == ClockStep::repeated;
  remark(remarks, {is_left_out ? "frame with a stamp that is not later than the one before"
                               : "clock set back, a new run begins",
                   1, name + " (" + stamp_text(stamp) + " after " + stamp_text(before_->stamp) + ")",
                   is_left_out, false});
  return !is_left_out;
}

void FrameWatch::see(SequenceFrame& frame, const std::string& file, std::vector<SourceRemark>& remarks) {
  const Size size = frame.left.gray.size();
  const bool is_given = !frame.disparity_px.empty();
  PreviousFrame now{frame.stamp, frame.name, hash_of<Gray>(frame.left.gray),
                    is_given ? hash_of<float>(frame.disparity_px) : hash_of<Gray>(frame.right)};
  if (!before_) {
    size_ = size;
    frame_id_ = frame.frame_id;
  } else {
    if (size != size_)
      throw Error(file + ": is " + text(size) + ", expected " + text(size_) + " like the frames before");
    frame.after_gap = seconds_between(before_->stamp, now.stamp) > max_gap_s_;
    const bool left_stands = now.left == before_->left;
    const bool right_stands = now.right == before_->right;
    if (left_stands != right_stands) {
      const std::string right = is_given ? "depth image" : "right image";
      remark(remarks, {left_stands ? "left image repeated from the frame before, the " + right + " new"
                                   : right + " repeated from the frame before, the left one new",
                       1, frame.name, false, false});
    }
  }
  before_ = std::move(now);
}

std::optional<SequenceFrame> LiveSequence::next() {
  std::optional<SequenceFrame> frame = SourceSequence::next();
  note_losses(frame ? frame->name : io::number_text(count_));
  if (is_stopped_) return std::nullopt;
  return frame;
}

std::optional<std::size_t> LiveSequence::size() const {
  const FrameRange& range = options_.frames;
  if (!range.last_excluded) return std::nullopt;
  return range.count_of(*range.last_excluded);
}

void LiveSequence::note(const char* what, std::uint64_t count, const std::string& before) {
  if (count == 0) return;
  const auto known =
      std::ranges::find_if(remarks_, [&](const SourceRemark& other) { return other.what == what; });
  if (known == remarks_.end()) {
    remarks_.push_back({what, count, "before " + before, true, false});
  } else {
    known->count = count;
  }
}

std::optional<std::size_t> LiveSequence::index_of(Stamp stamp) {
  if (!watch_.continues(stamp, io::number_text(count_), remarks_)) return std::nullopt;
  const std::size_t index = count_++;
  if (!options_.frames.contains(index)) return std::nullopt;
  return index;
}

}  // namespace cairn::input
