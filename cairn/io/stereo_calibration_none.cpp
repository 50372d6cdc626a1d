// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/error.hpp>
#include <cairn/io/stereo_calibration.hpp>

namespace cairn::io {
namespace {

[[noreturn]] void not_built_in() {
  throw Error(
      "calibrating and rectifying are not built in: they need OpenCV's calib3d (libopencv-calib3d-dev)");
}

}  // namespace

struct Rectifier::Maps {};

std::optional<Corners> find_board(View<const Gray>, const Board&) {
  not_built_in();
}
StereoCalibration calibrate_stereo(std::span<const BoardDetection>, const Board&, Size) {
  not_built_in();
}
Rectifier::Rectifier(const RawCalibration&) {
  not_built_in();
}
Rectifier::~Rectifier() = default;
LoadedPair Rectifier::operator()(const LoadedPair&, const Pool&) const {
  not_built_in();
}

}  // namespace cairn::io
