// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "../io/calibration_files.hpp"
#include "../io/stereo_calibration.hpp"

#include "sequence.hpp"

/// What every kind of source does with its frames; internal to source.
namespace cairn::io {

/// The calibration of a whole source.
struct SourceCalibration {
  std::filesystem::path path;  // empty where there is none
  Calibration says;
  std::shared_ptr<const Rectifier> rectifier;  // where the images are raw

  /// The rectified pair where the images are raw, else the pair itself. Throws Error where the calibration
  /// was made for another size.
  [[nodiscard]] PicturePair rectified(PicturePair pair, const Pool& pool) const;

  /// Once the images' size is known: the search range of raw ones; else throws Error where the file was made
  /// for another size, or its range is wider than the images.
  void suit(Size image);
  /// Of images that are taken for rectified, where the file describes raw cameras. `first`: its name.
  [[nodiscard]] std::optional<SourceRemark> remark_on_raw(const std::string& first) const;
};
/// `found`: beside the images; options.calib goes before. Throws Error, also where raw images have none.
SourceCalibration open_calibration(const SourceOptions& options,
                                   const std::optional<std::filesystem::path>& found, bool grey_cameras,
                                   bool is_raw);

/// Looks at every frame that a source gives, in order.
class FrameWatch {
 public:
  explicit FrameWatch(double max_gap_s) : max_gap_s_(max_gap_s) {}

  /// Sets after_gap, and has a remark on a camera that stands still while the other does not. Throws Error
  /// where the size is not the first frame's or the stamp not later than the one before. `file`: for
  /// messages.
  void see(SequenceFrame& frame, const std::string& file, std::vector<SourceRemark>& remarks);
  [[nodiscard]] Size image_size() const { return size_; }

 private:
  struct Seen {
    Stamp stamp;
    std::string name;
    std::uint64_t left = 0;  // hashes of the images
    std::uint64_t right = 0;
  };
  double max_gap_s_;
  Size size_;
  std::optional<Seen> before_;
};

}  // namespace cairn::io
