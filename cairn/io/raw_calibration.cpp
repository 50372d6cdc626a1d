// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/error.hpp>
#include <cairn/core/number_text.hpp>
#include <cairn/io/atomic_file.hpp>
#include <cairn/io/calibration_forms.hpp>
#include <cairn/io/raw_calibration.hpp>
#include <cairn/io/read_file.hpp>
#include <span>

namespace cairn::io {
namespace {

namespace fs = std::filesystem;

std::string matrix_text(const char* name, int rows, std::span<const double> numbers) {
  const int columns = static_cast<int>(numbers.size()) / rows;
  std::string text = std::string(name) + ": !!opencv-matrix\n   rows: " + std::to_string(rows) +
                     "\n   cols: " + std::to_string(columns) + "\n   dt: d\n   data: [ ";
  for (std::size_t i = 0; i < numbers.size(); ++i) text += (i == 0 ? "" : ", ") + shortest_text(numbers[i]);
  return text + " ]\n";
}

void check_camera(const RawCamera& camera, const std::string& name) {
  if (!(camera.matrix[0] > 0 && camera.matrix[4] > 0)) {
    throw Error("the " + name + " camera has focal lengths " + shortest_text(camera.matrix[0]) + " and " +
                shortest_text(camera.matrix[4]) + ", expected positive numbers");
  }
  const std::size_t count = camera.distortion.size();
  if (camera.is_fisheye && count != 4) {
    throw Error("the " + name + " camera has " + std::to_string(count) +
                " distortion coefficients, expected the 4 of a fisheye lens");
  }
  if (count != 0 && count != 4 && count != 5 && count != 8 && count != 12 && count != 14) {
    throw Error("the " + name + " camera has " + std::to_string(count) +
                " distortion coefficients, expected 0, 4, 5, 8, 12 or 14");
  }
}

void check(const RawCalibration& calibration) {
  check_camera(calibration.left, "left");
  check_camera(calibration.right, "right");
  if (calibration.left.is_fisheye != calibration.right.is_fisheye)
    throw Error("has one fisheye lens and one that is none, expected two of a kind");
  if (calibration.image_size.area() == 0) throw Error("has no width and height of the images");
  const bool rectifies = calibration.left.rotation && calibration.left.projection &&
                         calibration.right.rotation && calibration.right.projection;
  if (!rectifies && !(calibration.rotation && calibration.translation_m))
    throw Error("has neither R and T nor R1, R2, P1 and P2, expected the relative pose of the cameras");
}

/// For a better message than that matrices are missing.
bool is_of_rectified_pair(const fs::path& path) {
  try {
    const Calibration calibration = load_calibration(path);
    return calibration.rig && !calibration.of_raw_cameras;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

RawCalibration load_raw_calibration(const fs::path& path, const std::function<Size()>& image_size) {
  const std::string text = read_file(path, kMaxTextBytes);
  try {
    RawCalibration calibration = read_raw(text, path);
    if (calibration.image_size.area() == 0 && image_size) calibration.image_size = image_size();
    check(calibration);
    calibration.path = path;
    return calibration;
  } catch (const Error& error) {
    if (is_of_rectified_pair(path)) {
      throw Error(
          path.string() +
          ": is the calibration of a rectified pair, expected that of its raw cameras (M1 D1 M2 D2 R T, "
          "as cairn calibrate writes it)");
    }
    throw Error(path.string() + ": " + error.what());
  }
}

void save_raw_calibration(const fs::path& path, const RawCalibration& calibration,
                          const std::vector<std::string>& remarks) {
  std::string text = "%YAML:1.0\n---\n";
  for (const std::string& remark : remarks) text += "# " + remark + "\n";
  text += "image_width: " + std::to_string(calibration.image_size.width) +
          "\nimage_height: " + std::to_string(calibration.image_size.height) + "\n";
  text += matrix_text("M1", 3, calibration.left.matrix) + matrix_text("D1", 1, calibration.left.distortion) +
          matrix_text("M2", 3, calibration.right.matrix) + matrix_text("D2", 1, calibration.right.distortion);
  if (calibration.rotation) text += matrix_text("R", 3, *calibration.rotation);
  if (calibration.translation_m) text += matrix_text("T", 3, *calibration.translation_m);
  if (calibration.left.rotation) text += matrix_text("R1", 3, *calibration.left.rotation);
  if (calibration.right.rotation) text += matrix_text("R2", 3, *calibration.right.rotation);
  if (calibration.left.projection) text += matrix_text("P1", 3, *calibration.left.projection);
  if (calibration.right.projection) text += matrix_text("P2", 3, *calibration.right.projection);
  write_file(path, text);
}

}  // namespace cairn::io
