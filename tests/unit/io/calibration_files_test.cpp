// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/io/calibration_files.hpp>

#include "support/temporary_folder.hpp"

namespace cairn {
namespace {

namespace fs = std::filesystem;
using support::has;
using support::refusal;
using support::survives_damage;
using support::TemporaryFolder;

constexpr std::string_view kKeyValue =
    "fx=271.5\nfy=271.5\ncx=159.5\ncy=119.25\nbaseline=0.108\ndoffs=2.5\nwidth=320\nheight=240\nndisp=32\n";

constexpr std::string_view kMiddlebury =
    "cam0=[994.978 0 311.193; 0 994.978 254.877; 0 0 1]\n"
    "cam1=[994.978 0 342.279; 0 994.978 254.877; 0 0 1]\n"
    "doffs=31.086\nbaseline=193.001\nwidth=741\nheight=500\nndisp=64\nisint=0\nvmin=23\nvmax=61\ndyavg="
    "0\ndymax=0\n";

constexpr std::string_view kKittiRaw =
    "calib_time: 09-Jan-2012 13:57:47\ncorner_dist: 9.950000e-02\n"
    "S_rect_02: 1.242000e+03 3.750000e+02\n"
    "P_rect_00: 7.0e+02 0 6.0e+02 0 0 7.0e+02 1.7e+02 0 0 0 1 0\n"
    "P_rect_01: 7.0e+02 0 6.0e+02 -3.5e+02 0 7.0e+02 1.7e+02 0 0 0 1 0\n"
    "P_rect_02: 7.200000e+02 0.0 6.100000e+02 4.500000e+01 0 7.2e+02 1.73e+02 2.1e-01 0 0 1 2.7e-03\n"
    "P_rect_03: 7.200000e+02 0.0 6.150000e+02 -3.375000e+02 0 7.2e+02 1.73e+02 2.2e+00 0 0 1 2.7e-03\n";

constexpr std::string_view kOpenCvYaml =
    "%YAML:1.0\n---\n"
    "P1: !!opencv-matrix\n   rows: 3\n   cols: 4\n   dt: d\n"
    "   data: [ 5.5e+02, 0., 3.2e+02, 0., 0., 5.5e+02, 2.4e+02, 0., 0., 0.,\n       1., 0. ]\n"
    "P2: !!opencv-matrix\n   rows: 3\n   cols: 4\n   dt: d\n"
    "   data: [ 5.5e+02, 0., 3.3e+02, -6.6e+01, 0., 5.5e+02, 2.4e+02, 0., 0.,\n       0., 1., 0. ]\n"
    "image_width: 640\nimage_height: 480\n";

constexpr std::string_view kOpenCvXml =
    "<?xml version=\"1.0\"?>\n<opencv_storage>\n<!-- <P1>none</P1> -->\n<imageSize>\n  640 480</imageSize>\n"
    "<P1 type_id=\"opencv-matrix\">\n  <rows>3</rows>\n  <cols>4</cols>\n  <dt>d</dt>\n"
    "  <data>\n    5.5e+02 0. 3.2e+02 0. 0. 5.5e+02 2.4e+02 0. 0. 0. 1. 0.</data></P1>\n"
    "<P2 type_id=\"opencv-matrix\">\n  <rows>3</rows>\n  <cols>4</cols>\n  <dt>d</dt>\n"
    "  <data>\n    5.5e+02 0. 3.3e+02 -6.6e+01 0. 5.5e+02 2.4e+02 0. 0. 0. 1. 0.</data></P2>\n"
    "</opencv_storage>\n";

constexpr std::string_view kRosLeft =
    "image_width: 640\nimage_height: 480\ncamera_name: left\n"
    "camera_matrix:\n  rows: 3\n  cols: 3\n  data: [551, 0, 321, 0, 552, 239, 0, 0, 1]\ndistortion_model: "
    "plumb_bob\n"
    "projection_matrix:\n  rows: 3\n  cols: 4\n  data: [550, 0, 320, 0, 0, 550, 240, 0, 0, 0, 1, 0]\n";
constexpr std::string_view kRosRight =
    "image_width: 640\nimage_height: 480\ncamera_name: right\n"
    "projection_matrix:\n  rows: 3\n  cols: 4\n  data: [550, 0, 330, -66, 0, 550, 240, 0, 0, 0, 1, 0]\n";

/// The rig of the OpenCV and the ROS files above.
void expect_common_rig(const io::Calibration& calibration) {
  ASSERT_TRUE(calibration.rig);
  EXPECT_FLOAT_EQ(calibration.rig->focal_px, 550);
  EXPECT_FLOAT_EQ(calibration.rig->cx_px, 320);
  EXPECT_FLOAT_EQ(calibration.rig->cy_px, 240);
  EXPECT_FLOAT_EQ(calibration.rig->baseline_m, 0.12F);
  EXPECT_FLOAT_EQ(calibration.rig->doffs_px, 10);
  EXPECT_EQ(calibration.image_size, (Size{640, 480}));
}

std::string replaced(std::string_view text, std::string_view what, std::string_view with) {
  std::string all(text);
  return all.replace(all.find(what), what.size(), with);
}

class CalibrationFiles : public testing::Test {
 protected:
  [[nodiscard]] io::Calibration read(std::string_view text, const std::string& name = "calib.txt") const {
    return io::load_calibration(folder_.with(name, text));
  }
  [[nodiscard]] std::string refused(std::string_view text, const std::string& name = "calib.txt") const {
    const fs::path path = folder_.with(name, text);
    std::string message = refusal([&] { io::load_calibration(path); });
    EXPECT_TRUE(message.starts_with(path.string() + ": ")) << message;
    return message;
  }
  TemporaryFolder folder_;
};

// ---- key=value ----

TEST_F(CalibrationFiles, KeyValueLinesAreInMetres) {
  const io::Calibration calibration = read(kKeyValue);
  ASSERT_TRUE(calibration.rig);
  EXPECT_FLOAT_EQ(calibration.rig->focal_px, 271.5F);
  EXPECT_FLOAT_EQ(calibration.rig->cx_px, 159.5F);
  EXPECT_FLOAT_EQ(calibration.rig->cy_px, 119.25F);
  EXPECT_FLOAT_EQ(calibration.rig->baseline_m, 0.108F);
  EXPECT_FLOAT_EQ(calibration.rig->doffs_px, 2.5F);
  EXPECT_EQ(calibration.image_size, (Size{320, 240}));
  EXPECT_EQ(calibration.num_disparities, 32);
}

TEST_F(CalibrationFiles, MissingDoffsIs0AndUnknownKeysAreIgnored) {
  const io::Calibration calibration =
      read("# ours\r\nfx = 100 # px\r\n\r\ncx=1\ncy=2\nbaseline=+1e-1\nlens=wide\n");
  ASSERT_TRUE(calibration.rig);
  EXPECT_EQ(calibration.rig->doffs_px, 0);
  EXPECT_FLOAT_EQ(calibration.rig->baseline_m, 0.1F);
  EXPECT_FALSE(calibration.image_size || calibration.num_disparities);
}

TEST_F(CalibrationFiles, WithoutFocalLengthOrBaselineThereIsNoRig) {
  const io::Calibration calibration = read("width=1241\nheight=376\nndisp=128\n");
  EXPECT_FALSE(calibration.rig);
  EXPECT_EQ(calibration.image_size, (Size{1241, 376}));
  EXPECT_EQ(calibration.num_disparities, 128);
  EXPECT_FALSE(read("fx=100\ncx=1\ncy=2\n").rig);
  EXPECT_FALSE(read("baseline=0.1\ncx=1\ncy=2\n").rig);
}

TEST_F(CalibrationFiles, AMisspeltBaselineIsRefused) {
  EXPECT_TRUE(
      has(refused("fx=100\ncx=1\ncy=2\nbasline=0.1\n"), {"basline", "expected 'baseline' in metres"}));
  EXPECT_TRUE(has(refused("fx=100\ncx=1\ncy=2\nbaseline_mm=100\n"), {"baseline_mm", "'baseline' in metres"}));
  EXPECT_TRUE(has(refused("cam0=[100 0 1; 0 100 2; 0 0 1]\nBaseline=160\n"), {"'baseline' in millimetres"}));
}

TEST_F(CalibrationFiles, UnknownKeysAreNamed) {
  const io::Calibration calibration = read(std::string(kKeyValue) + "lens=wide\nTx=3\n");
  ASSERT_EQ(calibration.remarks.size(), 1U);
  EXPECT_TRUE(has(calibration.remarks[0], {"Tx", "lens"}));
  EXPECT_TRUE(read(kKeyValue).remarks.empty());
}

TEST_F(CalibrationFiles, KeysOfOtherProgramsInsteadOfTheseAreRefused) {
  EXPECT_TRUE(has(refused("f=500\ncx=320\ncy=240\nbf=60\n"), {"no fx", "'f'", "'bf'", "expected fx"}));
  EXPECT_TRUE(has(refused("fx=500\ncx=320\ncy=240\nbf=60\n"), {"no baseline", "'bf'"}));
}

TEST_F(CalibrationFiles, ARigWithoutCentreIsRefused) {
  EXPECT_TRUE(has(refused("fx=100\nbaseline=0.1\ncy=2\n"), {"cx"}));
  EXPECT_TRUE(has(refused("fx=100\nbaseline=0.1\ncx=2\n"), {"cy"}));
}

TEST_F(CalibrationFiles, InvalidNumbersAreRefusedWithTheirKey) {
  const auto with = [&](std::string_view what, std::string_view other) {
    return refused(replaced(kKeyValue, what, other));
  };
  EXPECT_TRUE(has(with("fx=271.5", "fx=abc"), {"fx", "'abc'"}));
  EXPECT_TRUE(has(with("fx=271.5", "fx="), {"fx"}));
  EXPECT_TRUE(has(with("fx=271.5", "fx=271.5 px"), {"fx", "271.5 px"}));
  EXPECT_TRUE(has(with("fx=271.5", "fx=nan"), {"fx", "nan", "finite"}));
  EXPECT_TRUE(has(with("cx=159.5", "cx=inf"), {"cx", "inf"}));
  EXPECT_TRUE(has(with("cy=119.25", "cy=1e999"), {"cy"}));
  EXPECT_TRUE(has(with("cy=119.25", "cy=1e300"), {"cy"}));
  EXPECT_TRUE(has(with("fx=271.5\nfy=271.5", "fx=0\nfy=0"), {"focal", "0", "positive"}));
  EXPECT_TRUE(has(with("fx=271.5\nfy=271.5", "fx=-5\nfy=-5"), {"focal", "-5", "positive"}));
  EXPECT_TRUE(has(with("baseline=0.108", "baseline=0"), {"baseline", "positive"}));
  EXPECT_TRUE(has(with("baseline=0.108", "baseline=-0.1"), {"baseline", "-0.1"}));
  EXPECT_TRUE(has(with("baseline=0.108", "baseline=1e-60"), {"baseline"}));
  EXPECT_TRUE(has(with("width=320", "width=320.5"), {"width", "320.5", "whole"}));
  EXPECT_TRUE(has(with("width=320", "width=0"), {"width"}));
  EXPECT_TRUE(has(with("height=240", "height=1e9"), {"height"}));
  EXPECT_TRUE(has(with("ndisp=32", "ndisp=-32"), {"ndisp", "-32"}));
  EXPECT_TRUE(has(with("ndisp=32", "ndisp"), {"line 9", "'ndisp'"}));
  EXPECT_TRUE(has(with("cx=159.5", "fx=3"), {"fx", "twice"}));
}

TEST_F(CalibrationFiles, UnequalFocalLengthsAreRefusedButForRounding) {
  EXPECT_TRUE(has(refused(replaced(kKeyValue, "fy=271.5", "fy=280")), {"271.5", "280"}));
  EXPECT_TRUE(read(replaced(kKeyValue, "fy=271.5", "fy=271.6")).remarks.empty());
  const io::Calibration calibration = read(replaced(kKeyValue, "fy=271.5", "fy=272"));
  EXPECT_FLOAT_EQ(calibration.rig->focal_px, 271.5F);
  ASSERT_EQ(calibration.remarks.size(), 1U);
  EXPECT_TRUE(has(calibration.remarks[0], {"271.5", "272", "0.18 %"}));
}

TEST_F(CalibrationFiles, KTxtIsACameraMatrixAndTheBaseline) {
  const io::Calibration calibration =
      read("754.66 0.0 489.37 0.0 754.66 265.16 0.0 0.0 1.0\n0.063\n", "K.txt");
  ASSERT_TRUE(calibration.rig);
  EXPECT_FLOAT_EQ(calibration.rig->focal_px, 754.66F);
  EXPECT_FLOAT_EQ(calibration.rig->cx_px, 489.37F);
  EXPECT_FLOAT_EQ(calibration.rig->cy_px, 265.16F);
  EXPECT_FLOAT_EQ(calibration.rig->baseline_m, 0.063F);
  EXPECT_TRUE(has(refused("754.66 0 489.37 0 754.66 265.16 0 0 1\n"), {"not a calibration"}));
}

TEST_F(CalibrationFiles, FilesOfOtherProgramsAreNamedWithWhatToCopy) {
  EXPECT_TRUE(has(refused("Camera.fx: 500\nCamera.bf: 60\n"), {"ORB-SLAM", "Camera.bf / Camera.fx"}));
  EXPECT_TRUE(has(refused("[LEFT_CAM_HD]\nfx=500\n[STEREO]\nBaseline=120\n"), {"ZED", "M1 D1"}));
  EXPECT_TRUE(has(refused("{\"value0\": {\"T_imu_cam\": []}}"), {"Basalt"}));
  EXPECT_TRUE(has(refused("cam0:\n  intrinsics: [1, 1, 1, 1]\n"), {"Kalibr", "cairn rectify"}));
}

// ---- Middlebury ----

TEST_F(CalibrationFiles, MiddleburyIsInMillimetres) {
  const io::Calibration calibration = read(kMiddlebury);
  ASSERT_TRUE(calibration.rig);
  EXPECT_FLOAT_EQ(calibration.rig->focal_px, 994.978F);
  EXPECT_FLOAT_EQ(calibration.rig->cx_px, 311.193F);
  EXPECT_FLOAT_EQ(calibration.rig->cy_px, 254.877F);
  EXPECT_FLOAT_EQ(calibration.rig->baseline_m, 0.193001F);
  EXPECT_FLOAT_EQ(calibration.rig->doffs_px, 31.086F);
  EXPECT_EQ(calibration.image_size, (Size{741, 500}));
  EXPECT_EQ(calibration.num_disparities, 64);
}

TEST_F(CalibrationFiles, MiddleburysDoffsFollowsFromItsCamerasWhereItIsMissing) {
  EXPECT_NEAR(read(replaced(kMiddlebury, "doffs=31.086\n", "")).rig->doffs_px, 31.086, 1e-4);
}

TEST_F(CalibrationFiles, DamagedMiddleburyIsRefused) {
  EXPECT_TRUE(has(refused(replaced(kMiddlebury, "; 0 0 1]", "]")), {"cam0", "6 numbers", "9"}));
  EXPECT_TRUE(has(refused(replaced(kMiddlebury, "[994.978 0", "994.978 0")), {"cam0"}));
  EXPECT_TRUE(has(refused(replaced(kMiddlebury, "994.978", "x")), {"cam0", "'x'"}));
  EXPECT_TRUE(has(refused(replaced(kMiddlebury, "994.978", "0")), {"focal"}));
  EXPECT_TRUE(has(refused(replaced(kMiddlebury, "193.001", "-193")), {"baseline"}));
  EXPECT_TRUE(has(refused(replaced(kMiddlebury, "cam1=[994.978", "cam1=[1000")), {"cam1", "focal"}));
}

// ---- KITTI ----

TEST_F(CalibrationFiles, KittisColourPairComesFirst) {
  const io::Calibration calibration = read(kKittiRaw, "calib_cam_to_cam.txt");
  ASSERT_TRUE(calibration.rig);
  EXPECT_FLOAT_EQ(calibration.rig->focal_px, 720);
  EXPECT_FLOAT_EQ(calibration.rig->cx_px, 610);
  EXPECT_FLOAT_EQ(calibration.rig->cy_px, 173);
  EXPECT_FLOAT_EQ(calibration.rig->baseline_m, static_cast<float>((45.0 + 337.5) / 720));
  EXPECT_FLOAT_EQ(calibration.rig->doffs_px, 5);
  EXPECT_EQ(calibration.image_size, (Size{1242, 375}));
}

TEST_F(CalibrationFiles, KittisGreyPairIsUsedIfThereIsNoOther) {
  const std::string grey = replaced(kKittiRaw, "P_rect_03", "Q_rect_03");
  EXPECT_FLOAT_EQ(read(grey).rig->baseline_m, 0.5F);
}

TEST_F(CalibrationFiles, KittisGreyPairIsUsedForGreyImages) {
  const io::Calibration calibration =
      io::load_calibration(folder_.with("calib_cam_to_cam.txt", kKittiRaw), true);
  EXPECT_FLOAT_EQ(calibration.rig->focal_px, 700);
  EXPECT_FLOAT_EQ(calibration.rig->baseline_m, 0.5F);
}

TEST_F(CalibrationFiles, KittisShortFormIsRead) {
  const io::Calibration calibration = read(
      "P0: 700 0 600 0 0 700 170 0 0 0 1 0\nP1: 700 0 600 -350 0 700 170 0 0 0 1 0\n"
      "P2: 700 0 600 35 0 700 170 0 0 0 1 0\nP3: 700 0 600 -350 0 700 170 0 0 0 1 0\nTr: 1 0 0\n");
  EXPECT_FLOAT_EQ(calibration.rig->baseline_m, 0.55F);
  EXPECT_FALSE(calibration.image_size);
}

TEST_F(CalibrationFiles, DamagedKittiIsRefused) {
  EXPECT_TRUE(has(refused("P2: 700 0 600 35 0 700 170 0 0 0 1 0\n"), {"P2", "P3"}));
  EXPECT_TRUE(has(refused("P0: 700 0 600\nP1: 700 0\n"), {"P0", "3 numbers", "12"}));
  EXPECT_TRUE(has(refused(replaced(kKittiRaw, "-3.375000e+02", "-3.375000e+0x")), {"P_rect_03"}));
  EXPECT_TRUE(has(refused(replaced(kKittiRaw, "-3.375000e+02", "4.900000e+01")), {"baseline"}));
  EXPECT_TRUE(
      has(refused("P0: 7 0 6 0 0 7 1 0 0 0 1 0\nP1: 7 0 6 0 0 7 1 -9 0 0 1 0\n"), {"one above the other"}));
}

// ---- OpenCV ----

TEST_F(CalibrationFiles, OpenCvYamlXmlAndJsonAreEquivalent) {
  expect_common_rig(read(kOpenCvYaml, "stereo.yml"));
  expect_common_rig(read(kOpenCvXml, "stereo.xml"));
  expect_common_rig(read(R"({"P1": {"type_id": "opencv-matrix", "rows": 3, "cols": 4, "dt": "d",
    "data": [550.0, 0.0, 320.0, 0.0, 0.0, 550.0, 240.0, 0.0, 0.0, 0.0, 1.0, 0.0]},
    "P2": {"type_id": "opencv-matrix", "rows": 3, "cols": 4, "dt": "d",
    "data": [550.0, 0.0, 330.0, -66.0, 0.0, 550.0, 240.0, 0.0, 0.0, 0.0, 1.0, 0.0]}, "size": [640, 480]})",
                         "stereo.json"));
}

TEST_F(CalibrationFiles, MatricesMayBeListsOrRows) {
  expect_common_rig(
      read("%YAML:1.0\nP1: [550, 0, 320, 0, 0, 550, 240, 0, 0, 0, 1, 0]\n"
           "P2:[550, 0, 330, -66, 0, 550, 240, 0, 0, 0, 1, 0]\nsize: [640, 480]\n"));
  expect_common_rig(
      read("P1: [[550, 0, 320, 0], [0, 550, 240, 0], [0, 0, 1, 0]]\n"
           "P2: [[550, 0, 330, -66], [0, 550, 240, 0], [0, 0, 1, 0]]\nsize: [640, 480]\n"));
  expect_common_rig(
      read("left_rect:\n  P: [[550, 0, 320, 0], [0, 550, 240, 0], [0, 0, 1, 0]]\n  size: [640, 480]\n"
           "right_rect:\n  P: [[550, 0, 330, -66], [0, 550, 240, 0], [0, 0, 1, 0]]\n"));
  std::string tight(kOpenCvYaml);
  for (std::size_t at = 0; (at = tight.find("data: [")) != std::string::npos;) tight.erase(at + 5, 1);
  expect_common_rig(read(tight));
}

TEST_F(CalibrationFiles, OpenCvsQIsEnough) {
  expect_common_rig(read(
      "%YAML:1.0\n---\nQ: !!opencv-matrix\n   rows: 4\n   cols: 4\n   dt: d\n   data: [ 1., 0., 0., "
      "-3.2e+02, 0., 1., "
      "0., -2.4e+02, 0., 0., 0., 5.5e+02, 0., 0., 8.333333333, 83.33333333 ]\nimage_size: [640, 480]\n"));
}

TEST_F(CalibrationFiles, OpenCvWithoutRectificationIsRefused) {
  EXPECT_TRUE(has(
      refused(
          "%YAML:1.0\n---\nM1: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 1., 0., 1., 0., "
          "1., 1., 0., 0., 1. ]\n"),
      {"M1", "P1 and P2", "rectified"}));
  EXPECT_TRUE(
      has(refused("<?xml version=\"1.0\"?><opencv_storage><a>1</a></opencv_storage>"), {"P1 and P2"}));
}

TEST_F(CalibrationFiles, DamagedOpenCvIsRefused) {
  EXPECT_TRUE(has(refused(replaced(kOpenCvYaml, "cols: 4", "cols: 3")), {"P1", "3x4"}));
  EXPECT_TRUE(has(refused(replaced(kOpenCvYaml, "5.5e+02", ".Nan")), {"P1", ".Nan"}));
  EXPECT_TRUE(has(refused(replaced(kOpenCvYaml, "1., 0. ]", "1. ]")), {"P1"}));
  EXPECT_TRUE(has(refused(replaced(kOpenCvXml, "</P2>", "")), {"P2", "does not end"}));
  EXPECT_TRUE(has(refused(replaced(kOpenCvXml, "-->", "")), {"comment"}));
  EXPECT_TRUE(has(refused(replaced(kOpenCvXml, "-6.6e+01", "6.6e+01")), {"baseline", "-0.12"}));
  EXPECT_TRUE(has(refused(replaced(kOpenCvXml, "-6.6e+01", "zero")), {"P2", "zero"}));
}

// ---- ROS ----

TEST_F(CalibrationFiles, ARosPairIsFoundFromEitherOfItsFiles) {
  for (const auto& [left, right] :
       {std::pair{"left.yaml", "right.yaml"}, std::pair{"cam_left.yaml", "cam_right.yaml"},
        std::pair{"left_info.yml", "right_info.yml"}, std::pair{"CamLeft.yaml", "CamRight.yaml"},
        std::pair{"info_L.yaml", "info_R.yaml"}}) {
    const fs::path left_path = folder_.with(std::string("pair/") + left, kRosLeft);
    const fs::path right_path = folder_.with(std::string("pair/") + right, kRosRight);
    expect_common_rig(io::load_calibration(left_path));
    expect_common_rig(io::load_calibration(right_path));
    expect_common_rig(io::load_calibration(folder_.path() / "pair"));
    fs::remove_all(folder_.path() / "pair");
  }
}

TEST_F(CalibrationFiles, ARosPairMayBeInOneFile) {
  expect_common_rig(read(std::string(kRosLeft) + "---\n" + std::string(kRosRight), "both.yaml"));
  const auto indented = [](std::string_view text) {
    std::string out = "  ";
    for (const char c : text.substr(0, text.size() - 1))
      out += c == '\n' ? std::string("\n  ") : std::string(1, c);
    return out + "\n";
  };
  expect_common_rig(read("left:\n" + indented(kRosLeft) + "right:\n" + indented(kRosRight), "both.yaml"));
}

TEST_F(CalibrationFiles, PrintedMessagesMayEndWithASeparatorAndCommentsMayHaveEquals) {
  (void)folder_.with("right.yaml", std::string(kRosRight) + "---\n");
  expect_common_rig(read("# fx = fy\n" + std::string(kRosLeft) + "---\n", "left.yaml"));
  expect_common_rig(
      read("focal_px: 550  # fx = fy\ncx_px: 320\ncy_px: 240\nbaseline_m: 0.12\ndoffs_px: 10\n"
           "width: 640\nheight: 480\n"));
}

TEST_F(CalibrationFiles, ASingleRosCameraIsRefusedWithTheMissingName) {
  EXPECT_TRUE(has(refused(kRosLeft, "cam_left.yaml"), {"cam_right.yaml"}));
  EXPECT_TRUE(has(refused(kRosLeft, "camera.yaml"), {"left.yaml", "right.yaml"}));
  (void)folder_.with("right.yaml", "a: b\n");
  EXPECT_TRUE(has(refused(kRosLeft, "left.yaml"), {"left.yaml", "projection_matrix"}));
  (void)folder_.with("right.yaml", "");
  EXPECT_TRUE(has(refused(kRosLeft, "left.yaml"), {"right.yaml", "empty"}));
}

// ---- our own ----

TEST_F(CalibrationFiles, OurOwnYamlNamesItsUnits) {
  const io::Calibration calibration = read(
      "# rectified pair\nfocal_px: 550\ncx_px: 320\ncy_px: 240\nbaseline_m: 0.12\ndoffs_px: 10\nwidth: "
      "640\nheight: 480\nndisp: "
      "64\n",
      "calib.yaml");
  expect_common_rig(calibration);
  EXPECT_EQ(calibration.num_disparities, 64);
  EXPECT_FALSE(read("width: 640\nheight: 480\n", "calib.yaml").rig);
}

TEST_F(CalibrationFiles, OurOwnYamlRefusesUnknownKeys) {
  EXPECT_TRUE(has(refused("focal_px: 550\nbaseline: 0.12\n"), {"'baseline'", "baseline_m"}));
  EXPECT_TRUE(has(refused("focal_px: wide\n"), {"focal_px", "'wide'"}));
  EXPECT_TRUE(has(refused("focal_px: [1, 2]\n"), {"focal_px"}));
  EXPECT_TRUE(has(refused("focal_px: -550\nbaseline_m: 0.1\n"), {"focal", "-550"}));
}

// ---- anything ----

TEST_F(CalibrationFiles, RefusesFilesThatAreNotCalibrations) {
  EXPECT_TRUE(
      has(refusal([&] { io::load_calibration(folder_.path() / "none.txt"); }), {"none.txt", "No such file"}));
  EXPECT_TRUE(has(refusal([&] { io::load_calibration(folder_.path()); }), {"is a folder", "calib.txt"}));
  EXPECT_TRUE(has(refused(""), {"empty"}));
  EXPECT_TRUE(has(refused(" \n\t\n"), {"empty"}));
  EXPECT_TRUE(has(refused("hello world\n"), {"not a calibration", "hello world"}));
  EXPECT_TRUE(has(refused("- 1\n- 2\n"), {"not a calibration"}));
  EXPECT_TRUE(has(refused("{unfinished: [1,"), {"not YAML"}));
  EXPECT_TRUE(has(refused("lens=wide\n"), {"fx fy cx cy"}));
  EXPECT_TRUE(has(refused(std::string("fx=1\0", 5)), {"not text"}));
  EXPECT_TRUE(has(refused("\x89PNG\r\n\x1a\n"), {""}));
  EXPECT_TRUE(has(refused(std::string((1U << 20) + 1, 'x')), {"more than"}));
  EXPECT_TRUE(has(refused(std::string(50000, '[')), {""}));
  EXPECT_TRUE(has(refused("P1: {rows: 3, cols: 4, data: &d [*d]}\n"), {""}));
}

TEST_F(CalibrationFiles, AByteOrderMarkIsSkipped) {
  EXPECT_TRUE(read("\xef\xbb\xbf" + std::string(kKeyValue)).rig);
}

TEST_F(CalibrationFiles, DamagedFilesCauseNothingWorseThanAnError) {
  const auto load = [](const fs::path& path) { io::load_calibration(path); };
  for (const std::string_view text : {kKeyValue, kMiddlebury, kKittiRaw, kOpenCvYaml, kOpenCvXml}) {
    survives_damage(folder_, "calib", std::string(text), load, 3);
  }
  (void)folder_.with("right.yaml", kRosRight);
  survives_damage(folder_, "left.yaml", std::string(kRosLeft), load, 3);
}

TEST_F(CalibrationFiles, ACalibrationForAnotherImageSizeIsRefused) {
  io::Calibration calibration;
  (void)io::suited(calibration, {320, 240}, "calib.txt");
  calibration.image_size = Size{640, 480};
  (void)io::suited(calibration, {640, 480}, "calib.txt");
  EXPECT_EQ(
      refusal([&] {
        (void)io::suited(calibration, {320, 240}, "calib.txt");
      }),
      "calib.txt: the calibration is for 640x480, the images are 320x240 (--scale-calibration if they were "
      "only resized)");
}

TEST_F(CalibrationFiles, ACalibrationIsScaledOnRequest) {
  const io::Calibration full = read(kKeyValue);
  const io::Calibration half = io::suited(full, {160, 120}, "calib.txt", true);
  EXPECT_FLOAT_EQ(half.rig->focal_px, 135.75F);
  EXPECT_FLOAT_EQ(half.rig->cx_px, 79.5F);  // the middle between two pixels stays there
  EXPECT_FLOAT_EQ(half.rig->cy_px, 59.375F);
  EXPECT_FLOAT_EQ(half.rig->baseline_m, 0.108F);
  EXPECT_FLOAT_EQ(half.rig->doffs_px, 1.25F);
  EXPECT_EQ(half.num_disparities, 16);
  EXPECT_EQ(half.image_size, (Size{160, 120}));
  EXPECT_TRUE(has(refusal([&] {
                    (void)io::suited(full, {160, 90}, "calib.txt", true);
                  }),
                  {"calib.txt", "320x240", "160x90", "cut off"}));
}

constexpr std::string_view kPoints = "10,200,4,200;300,210,293,210;20,230,12,230;280,190,275,190";

TEST_F(CalibrationFiles, EveryFormatMayContainTheMounting) {
  const std::string lines =
      "ground_points=" + std::string(kPoints) + "\ncamera_height=0.5\ncamera_pitch=12\n";
  const std::string yaml =
      "ground_points: [[10, 200, 4, 200], [300, 210, 293, 210], [20, 230, 12, 230], [280, "
      "190, 275, 190]]\ncamera_height: 0.5\ncamera_pitch: 12\n";
  std::string xml(kOpenCvXml);
  xml.insert(xml.find("<imageSize>"), "<ground_points>" + std::string(kPoints) +
                                          "</ground_points><camera_height>0.5</camera_height>"
                                          "<camera_pitch>12</camera_pitch>");
  std::string kitti(kKittiRaw);
  kitti += "ground_points: " + std::string(kPoints) + "\ncamera_height: 0.5\ncamera_pitch: 12\n";
  for (const std::string& text :
       {lines, std::string(kKeyValue) + lines, std::string(kMiddlebury) + lines,
        std::string(kOpenCvYaml) + yaml, "focal_px: 500\ncx_px: 1\ncy_px: 2\nbaseline_m: 0.1\n" + yaml, xml,
        kitti}) {
    const io::Calibration calibration = read(text);
    ASSERT_EQ(calibration.ground.points.size(), 4U) << text;
    EXPECT_EQ(calibration.ground.points[1], (PointPair{300, 210, 293, 210}));
    EXPECT_EQ(calibration.ground.camera_height_m, 0.5F);
    EXPECT_EQ(calibration.ground.camera_pitch_deg, 12.0F);
    EXPECT_EQ(calibration.ground.camera_roll_deg, 0.0F);
  }
  EXPECT_EQ(read(kKeyValue).ground, KnownGround{});
}

TEST_F(CalibrationFiles, AnImpossibleMountingIsRefused) {
  EXPECT_TRUE(has(refused("ground_points=1,2,3\n"), {"ground_points", "3 numbers"}));
  EXPECT_TRUE(has(refused("ground_points=1,2,3,4;5,6,7,8\n"), {"ground_points", "at least 4"}));
  EXPECT_TRUE(has(refused("ground_points=10,60,5,60;20,60,15,60;30,60,25,60;40,60,35,60\n"),
                  {"ground_points", "no plane"}));
  EXPECT_TRUE(has(refused("ground_points=1,2,3,inf\n"), {"ground_points", "finite"}));
  EXPECT_TRUE(has(refused("camera_height=0\n"), {"camera_height is 0, expected 0.01 ... 100"}));
  EXPECT_TRUE(has(refused("fx=1\ncamera_pitch=90\n"), {"camera_pitch"}));
  EXPECT_TRUE(has(refused("fx=1\ncamera_roll=-90\n"), {"camera_roll"}));
}

}  // namespace
}  // namespace cairn
