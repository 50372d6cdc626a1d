// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <cairn/io/calibration_files.hpp>
#include <cairn/io/stereo_calibration.hpp>

#include <cairn/input/sequence.hpp>

/// Frame handling common to all sources; internal to source.
namespace cairn::input {

/// The calibration of a source.
struct SourceCalibration {
  std::filesystem::path path;  // empty if there is none
  io::Calibration says;
  std::shared_ptr<const io::Rectifier> rectifier;  // for raw images
  int binning = 1;
  bool scales = false;            // to the size of the images
  bool has_search_range = false;  // without the file

  /// The rectified pair for raw images, else the pair itself. Throws Error if the calibration was made for
  /// another size.
  [[nodiscard]] io::LoadedPair rectified(io::LoadedPair pair, const Pool& pool) const;

  /// Checks or scales the calibration once the image size is known: sets the search range for raw images; else throws
  /// Error if the file was made for another size, or its range exceeds the image width.
  void suit(Size image);
  /// Those of the file, and one if it describes raw cameras but the images are assumed to be rectified. `first`: name
  /// of the first frame.
  [[nodiscard]] std::vector<SourceRemark> remarks(const std::string& first) const;
};
/// `found`: next to the images; options.calib takes precedence. `image_size`: of the images, called if the
/// calibration of raw cameras has none. Throws Error, also for raw images without a calibration.
SourceCalibration open_calibration(const SourceOptions& options,
                                   const std::optional<std::filesystem::path>& found, bool grey_cameras,
                                   bool is_raw, const std::function<Size()>& image_size = {});

/// Checks every frame of a source, in order.
class FrameWatch {
 public:
  explicit FrameWatch(double max_gap_s) : max_gap_s_(max_gap_s) {}

  /// Whether a frame with this stamp continues the sequence, by clock_step(): a remark counts those left out, and
  /// another one where the clock was set back. Call it before see().
  [[nodiscard]] bool continues(Stamp stamp, const std::string& name,
                               std::vector<SourceRemark>& remarks) const;
  /// Sets after_gap, and adds a remark on a camera that repeats its image while the other does not. Throws
  /// Error if the size differs from the first frame. `file`: for messages.
  void see(SequenceFrame& frame, const std::string& file, std::vector<SourceRemark>& remarks);
  [[nodiscard]] Size image_size() const { return size_; }
  [[nodiscard]] const std::string& frame_id() const { return frame_id_; }

 private:
  struct PreviousFrame {
    Stamp stamp;
    std::string name;
    std::uint64_t left = 0;   // hashes of the images
    std::uint64_t right = 0;  // of the given disparities if there is none
  };
  double max_gap_s_;
  Size size_;
  std::string frame_id_;  // of the first frame
  std::optional<PreviousFrame> before_;
};

/// Base of frame sources: a calibration, the checks of frames, and remarks.
class SourceSequence : public Sequence {
 public:
  std::optional<SequenceFrame> next() override {
    return first_ ? std::exchange(first_, std::nullopt) : advance();
  }
  [[nodiscard]] Size image_size() const override { return watch_.image_size(); }
  [[nodiscard]] const std::optional<StereoRig>& rig() const override { return calibration_.says.rig; }
  [[nodiscard]] std::optional<int> disparities() const override { return calibration_.says.num_disparities; }
  [[nodiscard]] const KnownGround& ground() const override { return calibration_.says.ground; }
  [[nodiscard]] const io::Rectifier* rectifier() const override { return calibration_.rectifier.get(); }
  [[nodiscard]] std::string frame_id() const override { return watch_.frame_id(); }
  [[nodiscard]] const std::vector<SourceRemark>& remarks() const override { return remarks_; }
  [[nodiscard]] const std::string& ended_early() const override { return ended_early_; }

 protected:
  explicit SourceSequence(double max_gap_s) : watch_(max_gap_s) {}
  /// Reads the next frame.
  virtual std::optional<SequenceFrame> advance() = 0;

  std::optional<SequenceFrame> first_;  // was read when the sequence was opened
  FrameWatch watch_;
  SourceCalibration calibration_;
  std::vector<SourceRemark> remarks_;
  std::string ended_early_;
};

/// Base of live sources: counts frames from 0, and what was lost.
class LiveSequence : public SourceSequence {
 public:
  std::optional<SequenceFrame> next() override;
  [[nodiscard]] std::optional<std::size_t> size() const override;
  /// Only sets a flag, so it may be called in a signal handler: whoever waits looks at it every kNotice.
  void stop() override { is_stopped_ = true; }

 protected:
  static constexpr std::chrono::milliseconds kNotice{50};

  LiveSequence(const SourceOptions& options, Pool pool)
      : SourceSequence(options.max_gap_s), options_(options), pool_(std::move(pool)) {}
  /// Counts in remarks what was lost before the frame of this name.
  virtual void note_losses(const std::string& before) = 0;
  /// Adds or updates a remark with a count; none for 0.
  void note(const char* what, std::uint64_t count, const std::string& before);
  /// The index of the next frame; nullopt if it is outside the range, or not later than the previous one.
  std::optional<std::size_t> index_of(Stamp stamp);

  SourceOptions options_;
  Pool pool_;
  std::size_t count_ = 0;
  std::atomic<bool> is_stopped_ = false;
};

}  // namespace cairn::input
