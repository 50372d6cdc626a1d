// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/io/calibration_files.hpp>
#include <cairn/io/dataset.hpp>
#include <cairn/io/raw_calibration.hpp>
#include <string>

#include "support/temporary_folder.hpp"

namespace cairn {
namespace {

namespace fs = std::filesystem;
using support::has;
using support::refusal;
using support::survives_damage;
using support::TemporaryFolder;

io::RawCalibration example() {
  io::RawCalibration raw{{640, 480}, {}, {}, {}, {}};
  raw.left.matrix = {533.5, 0, 342.25, 0, 533.25, 234.5, 0, 0, 1};
  raw.right.matrix = {537, 0, 327, 0, 536, 250, 0, 0, 1};
  raw.left.distortion = {-0.28, 0.1, 1.5e-3, -1e-4, 0.03};
  raw.right.distortion = {-0.3, 0.14, 0, 0};
  raw.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  raw.translation_m = {-0.083, 0.001, 0.0004};
  return raw;
}

TEST(RawCalibration, IsReadBackAsWritten) {
  const TemporaryFolder folder;
  io::RawCalibration raw = example();
  raw.left.rotation = raw.right.rotation = raw.rotation;
  raw.left.projection = {500, 0, 320, 0, 0, 500, 240, 0, 0, 0, 1, 0};
  raw.right.projection = {500, 0, 320, -41.5, 0, 500, 240, 0, 0, 0, 1, 0};
  io::save_raw_calibration(folder.path() / "calib.yaml", raw, {"a remark: with a colon"});
  const io::RawCalibration read = io::load_raw_calibration(folder.path() / "calib.yaml");
  EXPECT_EQ(read.image_size, raw.image_size);
  EXPECT_EQ(read.left.matrix, raw.left.matrix);
  EXPECT_EQ(read.right.distortion, raw.right.distortion);
  EXPECT_EQ(read.left.distortion, raw.left.distortion);
  EXPECT_EQ(read.rotation, raw.rotation);
  EXPECT_EQ(read.translation_m, raw.translation_m);
  EXPECT_EQ(read.right.projection, raw.right.projection);
  // Also accepted by the reader for rectified pairs.
  const io::Calibration rectified = io::load_calibration(folder.path() / "calib.yaml");
  ASSERT_TRUE(rectified.rig);
  EXPECT_FLOAT_EQ(rectified.rig->baseline_m, 0.083F);
  EXPECT_EQ(rectified.image_size, raw.image_size);
}

TEST(RawCalibration, IsReadFromOpenCvsXmlAndOtherNames) {
  const TemporaryFolder folder;
  const auto matrix = [](const std::string& name, const char* rows, const char* cols, const char* data) {
    return "<" + name + " type_id=\"opencv-matrix\"><rows>" + rows + "</rows><cols>" + cols +
           "</cols><dt>d</dt><data>" + data + "</data></" + name + ">\n";
  };
  const std::string xml = "<?xml version=\"1.0\"?>\n<opencv_storage>\n<imageSize>640 480</imageSize>\n" +
                          matrix("cameraMatrix1", "3", "3", "500 0 320 0 501 240 0 0 1") +
                          matrix("distCoeffs1", "1", "5", "0.1 0.2 0 0 0.3") +
                          matrix("cameraMatrix2", "3", "3", "510 0 321 0 511 241 0 0 1") +
                          matrix("distCoeffs2", "1", "5", "0 0 0 0 0") +
                          matrix("R", "3", "3", "1 0 0 0 1 0 0 0 1") + matrix("T", "3", "1", "-0.1 0 0") +
                          "</opencv_storage>\n";
  const io::RawCalibration raw = io::load_raw_calibration(folder.with("calib.xml", xml));
  EXPECT_EQ(raw.left.matrix[4], 501);
  EXPECT_EQ(raw.right.matrix[2], 321);
  EXPECT_EQ(raw.left.distortion.size(), 5U);
  ASSERT_TRUE(raw.translation_m);
  EXPECT_EQ((*raw.translation_m)[0], -0.1);
}

std::string ros(const std::string& fourth, const std::string& model = "plumb_bob") {
  return "image_width: 640\nimage_height: 480\n"
         "camera_matrix:\n  rows: 3\n  cols: 3\n  data: [551, 0, 321, 0, 552, 239, 0, 0, 1]\n"
         "distortion_model: " +
         model +
         "\ndistortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [-0.1, 0.02, 0, 0, 0]\n"
         "rectification_matrix:\n  rows: 3\n  cols: 3\n  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n"
         "projection_matrix:\n  rows: 3\n  cols: 4\n  data: [550, 0, 320, " +
         fourth + ", 0, 550, 240, 0, 0, 0, 1, 0]\n";
}

TEST(RawCalibration, IsReadFromEitherFileOfARosPair) {
  const TemporaryFolder folder;
  const auto left = folder.with("left.yaml", ros("0"));
  const auto right = folder.with("right.yaml", ros("-66"));
  for (const auto& named : {left, right}) {
    const io::RawCalibration raw = io::load_raw_calibration(named);
    EXPECT_EQ((*raw.right.projection)[3], -66);
    EXPECT_EQ((*raw.left.projection)[3], 0);
    EXPECT_EQ(raw.left.matrix[0], 551);
  }
}

/// A camera that looks along the body's x, with its x along the body's −y.
std::string euroc(const std::string& y, const std::string& model = "radial-tangential") {
  return "sensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [0, 0, 1, 0.5, -1, 0, 0, " + y +
         ", 0, -1, 0, 0, 0, 0, 0, 1]\nrate_hz: 20\nresolution: [752, 480]\ncamera_model: pinhole\n"
         "intrinsics: [458.654, 457.296, 367.215, 248.375] #fu, fv, cu, cv\ndistortion_model: " +
         model + "\ndistortion_coefficients: [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05]\n";
}

TEST(RawCalibration, IsReadFromEurocsTwoSensors) {
  const TemporaryFolder folder;
  const auto left = folder.with("mav0/cam0/sensor.yaml", euroc("0.06"));
  const auto right = folder.with("mav0/cam1/sensor.yaml", euroc("-0.05"));
  const io::RawCalibration raw = io::load_raw_calibration(left);
  EXPECT_EQ(raw.image_size, (Size{752, 480}));
  EXPECT_EQ(raw.left.matrix, (std::array<double, 9>{458.654, 0, 367.215, 0, 457.296, 248.375, 0, 0, 1}));
  EXPECT_EQ(raw.right.distortion, (std::vector<double>{-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05}));
  EXPECT_EQ(raw.rotation, (std::array<double, 9>{1, 0, 0, 0, 1, 0, 0, 0, 1}));
  // The right camera is 0.11 m to the right of the left one.
  ASSERT_TRUE(raw.translation_m);
  EXPECT_NEAR((*raw.translation_m)[0], -0.11, 1e-12);
  EXPECT_NEAR((*raw.translation_m)[1], 0, 1e-12);
  EXPECT_NEAR((*raw.translation_m)[2], 0, 1e-12);
  std::string turned = euroc("0");
  turned.replace(turned.find("0, 0, 1, 0.5, -1"), 51, "1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]");
  (void)folder.with("mav0/cam1/sensor.yaml", turned);
  const io::RawCalibration other = io::load_raw_calibration(left);
  EXPECT_EQ(other.rotation, (std::array<double, 9>{0, 0, 1, -1, 0, 0, 0, -1, 0}));
  EXPECT_EQ(other.translation_m, (std::array<double, 3>{0.5, 0.06, 0}));
  EXPECT_TRUE(has(refusal([&] { (void)io::load_raw_calibration(right); }), {"cam0/sensor.yaml"}));
  (void)folder.with("mav0/cam1/sensor.yaml", euroc("-0.05", "equidistant"));
  EXPECT_TRUE(has(refusal([&] { (void)io::load_raw_calibration(left); }), {"equidistant"}));
  fs::remove(right);
  EXPECT_TRUE(has(refusal([&] { (void)io::load_raw_calibration(left); }), {"cam1/sensor.yaml"}));
}

constexpr std::string_view kIntrinsics =
    "%YAML:1.0\n---\nM1: [335, 0, 342, 0, 336, 232, 0, 0, 1]\nD1: [-0.3, 0.1, 0, 0, 0]\n"
    "M2: [335, 0, 301, 0, 336, 245, 0, 0, 1]\nD2: [-0.3, 0.1, 0, 0, 0]\n";
constexpr std::string_view kExtrinsics =
    "%YAML:1.0\n---\nR: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nT: [-0.0596, 0, 0]\n";

TEST(RawCalibration, IsReadFromEitherFileOfOpenCvsSampleAndTakesTheSizeOfTheImages) {
  const TemporaryFolder folder;
  const auto files = {folder.with("intrinsics.yml", kIntrinsics), folder.with("extrinsics.yml", kExtrinsics)};
  for (const auto& file : files) {
    const io::RawCalibration raw = io::load_raw_calibration(file, [] { return Size{640, 480}; });
    EXPECT_EQ(raw.image_size, (Size{640, 480}));
    EXPECT_EQ(raw.left.matrix[4], 336);
    EXPECT_EQ(raw.right.distortion.size(), 5U);
    ASSERT_TRUE(raw.translation_m);
    EXPECT_EQ((*raw.translation_m)[0], -0.0596);
    EXPECT_TRUE(has(refusal([&] { (void)io::load_raw_calibration(file); }), {"no width and height"}));
  }
}

std::string kalibr(const std::string& x, const std::string& model = "radtan") {
  const std::string camera =
      "  camera_model: pinhole\n  distortion_coeffs: [-0.28, 0.07, 0.0002, 0.00002]\n  distortion_model: " +
      model + "\n  resolution: [752, 480]\n";
  return "cam0:\n  intrinsics: [458, 457, 367, 248]\n" + camera +
         "cam1:\n  intrinsics: [459, 456, 379, 255]\n  T_cn_cnm1:\n  - [1, 0, 0, " + x +
         "]\n  - [0, 1, 0, 0.001]\n  - [0, 0, 1, 0]\n  - [0, 0, 0, 1]\n" + camera;
}

TEST(RawCalibration, IsReadFromKalibrsCamchain) {
  const TemporaryFolder folder;
  io::RawCalibration raw = io::load_raw_calibration(folder.with("camchain.yaml", kalibr("-0.11")));
  EXPECT_EQ(raw.image_size, (Size{752, 480}));
  EXPECT_EQ(raw.left.matrix, (std::array<double, 9>{458, 0, 367, 0, 457, 248, 0, 0, 1}));
  EXPECT_EQ(raw.right.matrix[0], 459);
  EXPECT_FALSE(raw.left.is_fisheye);
  EXPECT_EQ(raw.translation_m, (std::array<double, 3>{-0.11, 0.001, 0}));
  // cam1 is the left camera.
  raw = io::load_raw_calibration(folder.with("camchain.yaml", kalibr("0.11", "equidistant")));
  EXPECT_EQ(raw.left.matrix[0], 459);
  EXPECT_TRUE(raw.left.is_fisheye);
  EXPECT_EQ(raw.translation_m, (std::array<double, 3>{-0.11, -0.001, 0}));
  EXPECT_TRUE(has(
      refusal([&] { (void)io::load_raw_calibration(folder.with("camchain.yaml", kalibr("-0.11", "fov"))); }),
      {"cam0", "pinhole-fov", "pinhole-equidistant"}));
}

TEST(RawCalibration, RefusesCalibrationsThatCannotRectify) {
  const TemporaryFolder folder;
  const auto refuses = [&](const std::string& text, const std::vector<std::string>& words) {
    const auto file = folder.with("calib.yaml", text);
    std::vector<std::string_view> all(words.begin(), words.end());
    const std::string message = refusal([&] { (void)io::load_raw_calibration(file); });
    EXPECT_NE(message.find("calib.yaml"), std::string::npos) << message;
    for (const std::string_view word : all) EXPECT_NE(message.find(word), std::string::npos) << message;
  };
  refuses("focal_px: 500\nwidth: 640\nheight: 480\n", {"M1"});
  refuses("[]", {"map"});
  io::RawCalibration raw = example();
  raw.rotation.reset();
  io::save_raw_calibration(folder.path() / "calib.yaml", raw, {});
  EXPECT_NE(refusal([&] { (void)io::load_raw_calibration(folder.path() / "calib.yaml"); }).find("R and T"),
            std::string::npos);
  raw = example();
  raw.left.distortion = {1, 2, 3};
  io::save_raw_calibration(folder.path() / "calib.yaml", raw, {});
  EXPECT_NE(
      refusal([&] { (void)io::load_raw_calibration(folder.path() / "calib.yaml"); }).find("3 distortion"),
      std::string::npos);
  (void)folder.with("right.yaml", ros("-66"));
  const auto omni = folder.with("left.yaml", ros("0", "mei"));
  EXPECT_NE(refusal([&] { (void)io::load_raw_calibration(omni); }).find("mei"), std::string::npos);
  const auto fisheye = folder.with("left.yaml", ros("0", "equidistant"));  // with five coefficients
  EXPECT_NE(refusal([&] { (void)io::load_raw_calibration(fisheye); }).find("expected the 4 of a fisheye"),
            std::string::npos);
  EXPECT_NE(refusal([&] { (void)io::load_raw_calibration(folder.path() / "none"); }).find("none"),
            std::string::npos);
}

TEST(Pairs, AreFoundByNamesInFoldersAndAsFrames) {
  const TemporaryFolder folder;
  for (const char* name :
       {"a/left02.jpg", "a/right02.jpg", "a/left01.jpg", "a/right01.jpg", "a/left03.jpg", "a/notes_left.txt",
        "a/notes_right.txt", "b/left/7.png", "b/right/7.png", "b/left/8.png", "c/one/left.png",
        "c/one/right.png", "c/two/left.png", "c/two/right.png", "d/nothing.txt", "e/left.jpg", "e/right.jpg",
        "e/left01.jpg", "e/right01.jpg"})
    (void)folder.with(name, "");
  const auto by_name = io::find_pairs(folder.path() / "a");
  ASSERT_EQ(by_name.size(), 2U);
  EXPECT_EQ(by_name[0].name, "left01");
  EXPECT_EQ(by_name[1].right, folder.path() / "a" / "right02.jpg");
  const auto in_folders = io::find_pairs(folder.path() / "b");
  ASSERT_EQ(in_folders.size(), 1U);
  EXPECT_EQ(in_folders[0].right, folder.path() / "b" / "right" / "7.png");
  EXPECT_EQ(io::find_pairs(folder.path() / "c").size(), 2U);
  EXPECT_NE(refusal([&] { (void)io::find_pairs(folder.path() / "d"); }).find("left01.png and right01.png"),
            std::string::npos);
  // Calibration uses all that pair up, other commands only the pair named left.
  EXPECT_EQ(io::find_pairs(folder.path() / "e").size(), 2U);
  EXPECT_EQ(io::find_frames(folder.path() / "e").size(), 1U);
  for (const char* same : {"a", "b", "c"}) {
    EXPECT_EQ(io::find_frames(folder.path() / same).size(), io::find_pairs(folder.path() / same).size())
        << same;
  }
}

TEST(Pairs, AreFoundUnderOtherNamesAndBesideHiddenFiles) {
  const TemporaryFolder folder;
  for (const char* name : {"tartan/image_left/000_left.png", "tartan/image_right/000_right.png",
                           "upper/Left/1.png", "upper/Right/1.png", "short/a_L.png", "short/a_R.png",
                           "mac/left00.pgm", "mac/right00.pgm", "mac/._left00.pgm", "mac/._right00.pgm",
                           "lone/left/1.pgm", "lone/right/1.pgm", "lone/left/2.pgm", "lone/left/3.pgm"})
    (void)folder.with(name, "");
  const fs::path root = folder.path();
  EXPECT_EQ(io::find_frames(root / "tartan")[0].right, root / "tartan" / "image_right" / "000_right.png");
  EXPECT_EQ(io::find_frames(root / "upper")[0].right, root / "upper" / "Right" / "1.png");
  EXPECT_EQ(io::find_frames(root / "short")[0].right, root / "short" / "a_R.png");
  ASSERT_EQ(io::find_frames(root / "mac").size(), 1U);
  EXPECT_EQ(io::find_frames(root / "mac")[0].name, "left00");
  std::vector<fs::path> alone;
  EXPECT_EQ(io::find_frames(root / "lone", io::Cameras::rectified, &alone).size(), 1U);
  EXPECT_EQ(alone,
            (std::vector<fs::path>{root / "lone" / "left" / "2.pgm", root / "lone" / "left" / "3.pgm"}));
}

}  // namespace
}  // namespace cairn
