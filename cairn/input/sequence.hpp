// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <cairn/core/pool.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <cairn/io/dataset.hpp>
#include <cairn/io/image_files.hpp>
#include <cairn/io/stereo_calibration.hpp>
#include <cairn/sequence/pose.hpp>

/// Sequences of stereo pairs, decoded one pair at a time. (docs/sequences.md, "Sources")
namespace cairn::input {

/// One rectified pair of a sequence.
struct SequenceFrame {
  std::string name;       // of the folder, of the left file without extension, or the number in a video
  std::size_t index = 0;  // in the source, from 0; --frames counts these
  Stamp stamp;            // later than the one before, unless the clock was set back, see clock_step()
  io::LoadedImage left;
  Image<Gray> right;       // may be empty where disparities are given
  bool after_gap = false;  // more than SourceOptions::max_gap_s after the frame before
  // For cameras: the arrival time by the steady clock of this computer; nullopt for files.
  std::optional<std::chrono::steady_clock::time_point> arrived = {};
  // ROS' name of the left camera's frame, from the image's header; empty where the source has none.
  std::string frame_id = {};
  bool begins_round = false;       // the first frame of another round through files: nobody waits for it
  Image<float> disparity_px = {};  // given, and taken instead of the pair's; NaN: hole. Empty: none
};

/// The pair of a frame. Throws Error, naming it, if it has a depth image or disparities instead.
StereoPair pair_of(const SequenceFrame& frame);

/// The status of a camera; for files all counts are 0 and it is connected.
struct SourceStatus {
  bool is_live = false;  // a camera: frames arrive whether they are read or not
  bool is_connected = true;
  std::uint64_t dropped = 0;   // frames that the device reported but that never arrived
  std::uint64_t unpaired = 0;  // left or right images without the other within source.max_skew
  std::uint64_t reconnects = 0;
  std::string trouble;  // why it is not connected, in one line
  std::string clock;    // clock of the stamps: "system" (since 1970) or "source"; empty for files
};

/// The frames first, first + step, … below last_excluded.
struct FrameRange {
  std::size_t first = 0;
  std::optional<std::size_t> last_excluded;  // nullopt: to the end
  std::size_t step = 1;

  [[nodiscard]] bool contains(std::size_t index) const {
    return index >= first && !is_past(index) && (index - first) % step == 0;
  }
  /// Whether it has neither this index nor a later one.
  [[nodiscard]] bool is_past(std::size_t index) const { return last_excluded && index >= *last_excluded; }
  /// The number of frames that it has of `count`.
  [[nodiscard]] std::size_t count_of(std::size_t count) const {
    const std::size_t end = std::min(count, last_excluded.value_or(count));
    return end <= first ? 0 : (end - first + step - 1) / step;
  }
};
/// "A:B[:STEP]" with A and B optional, or "N" for the first N frames. Throws Error if it is invalid or empty.
FrameRange parse_frame_range(std::string_view text);

/// The options of reading a source.
struct SourceOptions {
  std::string calib;   // overrides the calibration of the source
  std::string layout;  // of one video, camera or folder with both images in one: side_by_side or top_bottom
  double rate_hz = 0;  // replaces missing stamps and those of a video; 0 = from the source, else 10
  FrameRange frames;
  double max_gap_s = 1.0;
  double max_skew_ms = 5;  // between the stamps of left and right, if each side has its own
  // Of a recording and of ROS 2: "LEFT,RIGHT", "IMAGE,DEPTH" or "LEFT,RIGHT,DEPTH", whose right image checks the depth;
  // empty: found by type and name, or left/image_rect and right/image_rect.
  std::string topics;
  io::MapOptions maps;             // of folders: used instead of matching
  bool rectify = false;            // the images are raw and are rectified by the calibration; always for
                                   // EuRoC
  bool scale_calibration = false;  // where it is for images of another size of the same shape
  int binning = 1;                 // so many rows and columns of pixels in one: cairn/image/binning.hpp
  bool has_search_range = false;   // match.num_disparities is set: ndisp of the calibration is not read
  double open_timeout_s = 10;      // for cameras: until the first pair
};

/// The names in SourceOptions::topics: two or three, all different. Throws Error.
std::vector<std::string> split_topics(const std::string& topics);

/// A remark on frames of a source, with their number. No frame is skipped without such a remark.
struct SourceRemark {
  std::string what;          // "left image without a right one"
  std::size_t count = 0;     // frames
  std::string first;         // name of the first one, and why it cannot be read
  bool is_left_out = false;  // these frames are not delivered
  bool is_unusable = false;  // their files cannot be read
};

/// An open sequence: its first frame could be read.
class Sequence {
 public:
  Sequence() = default;
  virtual ~Sequence() = default;
  Sequence(const Sequence&) = delete;
  Sequence& operator=(const Sequence&) = delete;

  /// The next pair; nullopt after the last. Throws Error naming the file or frame if its size or calibration
  /// differs from the first frame. A frame that cannot be decoded, or that is not later than the one before, is
  /// skipped with a remark.
  virtual std::optional<SequenceFrame> next() = 0;
  /// The largest number of frames that next() delivers; an estimate for a video, or unknown.
  [[nodiscard]] virtual std::optional<std::size_t> size() const = 0;
  /// The source without its parent folder.
  [[nodiscard]] virtual std::string name() const = 0;
  [[nodiscard]] virtual Size image_size() const = 0;
  /// nullopt without a calibration: no metres then.
  [[nodiscard]] virtual const std::optional<StereoRig>& rig() const = 0;
  /// The number of disparities of the calibration: the default of match.num_disparities.
  [[nodiscard]] virtual std::optional<int> disparities() const = 0;
  /// The mounting of the rig from its calibration: Config::ground.known.
  [[nodiscard]] virtual const KnownGround& ground() const = 0;
  /// The rectification of raw images by next(); null for rectified sources.
  [[nodiscard]] virtual const io::Rectifier* rectifier() const = 0;
  /// ROS' name of the left camera's frame, of the first image; empty where the source has none.
  [[nodiscard]] virtual std::string frame_id() const { return {}; }
  /// The origin of the stamps: "stamps.txt", "a rate of 10 Hz".
  [[nodiscard]] virtual std::string stamps_from() const = 0;
  /// Remarks on frames skipped or noticed so far.
  [[nodiscard]] virtual const std::vector<SourceRemark>& remarks() const = 0;
  /// Why the sequence ended early, in one line (a truncated video); empty if it did not.
  [[nodiscard]] virtual const std::string& ended_early() const = 0;

  /// Stops a camera: next() returns nullopt within 0.2 s, now and on later calls. From any thread.
  virtual void stop() {}
  /// The present status. From any thread.
  [[nodiscard]] virtual SourceStatus status() const { return {}; }
};

/// Opens a source, recognised by its content or name:
/// - a folder of frames (docs/formats.md), of KITTI odometry or raw recordings, of EuRoC or TUM-VI;
/// - a folder of images with both images each, with options.layout;
/// - a folder of colour or grey images with depth images (TUM RGB-D and the like, see io::find_frames());
/// - "DIR_L,DIR_R", two folders of images, paired in order or by stamps; "left_%04d.png,right_%04d.png", two
///   patterns;
/// - a video with options.layout, or "l.mp4,r.mp4"; a recording (MCAP);
/// - cameras (docs/cameras.md):
///   "v4l2:/dev/video0[,/dev/video2][,w=2560,h=720,fps=30,format=YUYV,layout=side_by_side]",
///   "gst:PIPELINE[ !! PIPELINE]", "rtsp://..."; "ros2:/stereo", topics of ROS 2 (docs/ros2.md).
/// Throws Error (one line: what was found, what was expected, which file or option).
std::unique_ptr<Sequence> open_sequence(const std::string& source, const SourceOptions& options,
                                        const Pool& pool = {});

}  // namespace cairn::input
