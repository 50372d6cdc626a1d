// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

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

#include "../io/image_files.hpp"
#include "../io/stereo_calibration.hpp"
#include "../tracking/pose.hpp"

/// Sequences of stereo pairs, decoded one pair at a time. (docs/sequences.md, "Sources")
namespace cairn::io {

/// One rectified pair of a sequence.
struct SequenceFrame {
  std::string name;       // the folder's, the left file's without its ending, or the number in a video
  std::size_t index = 0;  // in the source, from 0; --frames counts these
  Stamp stamp;            // later than the one before
  Picture left;
  Image<Gray> right;
  bool after_gap = false;  // more than SourceOptions::max_gap_s after the frame before
  // Of cameras: when the frame was there, by this computer's steady clock; none of files.
  std::optional<std::chrono::steady_clock::time_point> arrived = {};
};

/// How a camera does; of files all is 0 and connected.
struct SourceStatus {
  bool is_live = false;  // a camera: frames come whether they are taken or not
  bool is_connected = true;
  std::uint64_t dropped = 0;   // frames that the device says it gave and that never came
  std::uint64_t unpaired = 0;  // left or right ones without the other within source.max_skew
  std::uint64_t reconnects = 0;
  std::string trouble;  // why it is not connected, in one line
  std::string clock;    // what stamps count from: "system", "monotonic", "source"
};

/// The frames first, first + step, … below last_excluded.
struct FrameRange {
  std::size_t first = 0;
  std::optional<std::size_t> last_excluded;  // none: to the end
  std::size_t step = 1;
};
/// "A:B[:STEP]" with A or B left out for the beginning and the end, or "N" for the first ones. Throws Error
/// where it is none, or empty.
FrameRange parse_frame_range(std::string_view text);

/// How a source is read.
struct SourceOptions {
  std::string calib;   // instead of the calibration that the source has
  std::string layout;  // of one video: side_by_side or top_bottom
  double rate_hz = 0;  // where there are no stamps, and instead of a video's; 0 = the source's own, else 10
  FrameRange frames;
  double max_gap_s = 1.0;
  double max_skew_ms = 5;  // between the stamps of left and right, where each side has its own
  std::string topics;      // of a recording, "LEFT,RIGHT"; empty: found by type and name
  bool rectify = false;    // the images are raw, the calibration says how they are rectified; always so of
                           // EuRoC's
  double open_timeout_s = 10;  // of cameras: until the first pair
};

/// What is to be said of a source's frames, counted. No frame is left out without such a count.
struct SourceRemark {
  std::string what;          // "left image without a right one"
  std::size_t count = 0;     // frames
  std::string first;         // the first one's name, and why it cannot be read
  bool is_left_out = false;  // these frames are not delivered
  bool is_unusable = false;  // because their files cannot be read
};

/// A sequence that is open: its first frame could be read.
class Sequence {
 public:
  Sequence() = default;
  virtual ~Sequence() = default;
  Sequence(const Sequence&) = delete;
  Sequence& operator=(const Sequence&) = delete;

  /// The next pair; none after the last. Throws Error, naming the file or frame, where its size or its
  /// calibration differs from the first frame's, or its stamp is not later than the one before. A frame that
  /// cannot be decoded is left out with a remark.
  virtual std::optional<SequenceFrame> next() = 0;
  /// The number of frames that next() delivers at most; a video's is an estimate, or is not known.
  [[nodiscard]] virtual std::optional<std::size_t> size() const = 0;
  /// The source without its folder.
  [[nodiscard]] virtual std::string name() const = 0;
  [[nodiscard]] virtual Size image_size() const = 0;
  /// None where no calibration is known: no metres then.
  [[nodiscard]] virtual const std::optional<StereoRig>& rig() const = 0;
  /// The calibration's number of disparities: the default of match.num_disparities.
  [[nodiscard]] virtual std::optional<int> disparities() const = 0;
  /// How the rig is mounted, as its calibration says: Config::ground.known.
  [[nodiscard]] virtual const KnownGround& ground() const = 0;
  /// What turns raw images into those of next(); none where they came rectified.
  [[nodiscard]] virtual const Rectifier* rectifier() const = 0;
  /// Where the stamps come from, in words: "stamps.txt", "a rate of 10 Hz".
  [[nodiscard]] virtual std::string stamps_from() const = 0;
  /// What was left out or noticed up to now.
  [[nodiscard]] virtual const std::vector<SourceRemark>& remarks() const = 0;
  /// Why the sequence ended before its end, in one line (a video that is cut off); empty where it did not.
  [[nodiscard]] virtual const std::string& ended_early() const = 0;

  /// Of a camera: next() returns none within 0.2 s, now or whenever it is called again. From any thread.
  virtual void stop() {}
  /// From any thread.
  [[nodiscard]] virtual SourceStatus status() const { return {}; }
};

/// Opens a source, recognised by what is there:
/// a folder of frames (docs/formats.md), of KITTI's odometry or raw recordings, of EuRoC's or TUM-VI's;
/// "DIR_L,DIR_R" two folders of images, paired in order or by stamps; "left_%04d.png,right_%04d.png" two
/// patterns; a video with options.layout, or "l.mp4,r.mp4"; a recording (MCAP); cameras (docs/cameras.md):
/// "v4l2:/dev/video0[,/dev/video2][,w=2560,h=720,fps=30,format=YUYV,layout=side_by_side]",
/// "gst:PIPELINE[ !! PIPELINE]", "rtsp://..."; "ros2:/stereo" topics of ROS 2 (docs/ros2.md).
/// Throws Error (one line: what was found, what was expected, which file or option).
std::unique_ptr<Sequence> open_sequence(const std::string& source, const SourceOptions& options,
                                        const Pool& pool = {});

}  // namespace cairn::io
