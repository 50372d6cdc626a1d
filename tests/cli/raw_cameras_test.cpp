// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/geometry.hpp>
#include <cairn/io/calibration_files.hpp>
#include <cairn/io/raw_calibration.hpp>
#include <cairn/io/stereo_calibration.hpp>
#include <support/drawn_boards.hpp>

#include "command.hpp"

/// cairn calibrate and cairn rectify, with a rendered checkerboard.
namespace cairn::command {
namespace {

constexpr int kPlaces = 12;  // poses of the board
static_assert(support::kBoardColumns == 9 && support::kBoardRows == 6 && support::kBoardSquare == 0.025);

bool is_built_in() {
  try {
    (void)io::calibrate_stereo({}, {}, {});
  } catch (const Error& error) {
    return std::string(error.what()).find("not built in") == std::string::npos;
  }
  return true;
}

/// Skips the test with a reason if it cannot run.
class RawCameras : public CommandTest {
 protected:
  void SetUp() override {
    if (!is_built_in()) GTEST_SKIP() << "built without OpenCV's calib3d";
  }

  /// The folder of left01.png, right01.png and so on.
  [[nodiscard]] fs::path draw_boards() const {
    fs::create_directories(at("boards"));
    for (int place = 0; place < kPlaces; ++place) {
      const std::string number = (place < 9 ? "0" : "") + std::to_string(place + 1);
      const auto [left, right] = support::drawn_board(place);
      io::save_png(at("boards/left" + number + ".png"), left.view());
      io::save_png(at("boards/right" + number + ".png"), right.view());
    }
    return at("boards");
  }
};

double number_after(const std::string& text, const std::string& words) {
  const std::size_t at = text.find(words);
  return at == std::string::npos ? std::nan("") : std::stod(text.substr(at + words.size()));
}

TEST_F(RawCameras, AreCalibratedRectifiedAndSegmented) {
  const fs::path boards = draw_boards();
  Outcome outcome =
      run({"calibrate", boards, "--board", "9x6", "--square", "0.025", "-o", path("calib.yaml")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_LT(number_after(outcome.out, "reprojection error  "), 0.5) << outcome.out;
  EXPECT_LT(number_after(outcome.out, "rows, rectified     "), 0.5) << outcome.out;
  EXPECT_NE(outcome.out.find("12 of 12"), std::string::npos) << outcome.out;

  // The raw pair is reported as unusable; after rectification its rows are aligned.
  const fs::path left = boards / "left01.png";
  const fs::path raw_right = boards / "right01.png";
  outcome = run({"doctor", left, raw_right});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.out.find("not rectified"), std::string::npos) << outcome.out;
  outcome = run({"rectify", "--calib", path("calib.yaml"), left, raw_right, "-o", path("pair")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  outcome = run({"doctor", path("pair"), "--set", "match.num_disparities=144"});
  EXPECT_EQ(outcome.code, 0) << outcome.out;
  EXPECT_EQ(outcome.out.find("rows misaligned"), std::string::npos) << outcome.out;
  EXPECT_EQ(outcome.out.find("not rectified"), std::string::npos) << outcome.out;

  // With its own calibration, the raw pair is recognised as raw, and the rectified one is not.
  for (const fs::path& from : {left, at("pair") / "left.png"}) {
    const fs::path other = from == left ? raw_right : at("pair") / "right.png";
    outcome = run({"segment", from, other, "--calib", path("calib.yaml")});
    EXPECT_EQ(outcome.code, 0);
    EXPECT_NE(outcome.err.find("calib.yaml: describes raw cameras"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("cairn rectify"), std::string::npos) << outcome.err;
    outcome =
        run({"doctor", from, other, "--calib", path("calib.yaml"), "--set", "match.num_disparities=144"});
    EXPECT_EQ(outcome.out.find("warning  calibration of raw cameras") != std::string::npos, from == left)
        << outcome.out;
  }

  // The calibration next to the pair agrees with that of the raw cameras.
  const auto beside = io::load_calibration(at("pair") / "calib.txt");
  const auto raw = io::load_calibration(at("calib.yaml"));
  ASSERT_TRUE(beside.rig && raw.rig);
  EXPECT_EQ(beside.rig->focal_px, raw.rig->focal_px);
  EXPECT_EQ(beside.rig->cx_px, raw.rig->cx_px);
  EXPECT_FLOAT_EQ(beside.rig->baseline_m, raw.rig->baseline_m);
  const support::Motion right = support::right_from_left();
  EXPECT_NEAR(static_cast<double>(beside.rig->baseline_m),
              std::hypot(right.translation_m.x, right.translation_m.y, right.translation_m.z), 0.001);
  const io::RawCalibration found = io::load_raw_calibration(at("calib.yaml"));
  EXPECT_NEAR(found.left.matrix[0], support::kRawFocal, 3);
  EXPECT_NEAR(found.right.matrix[4], support::kRawFocal, 3);
  EXPECT_NEAR(found.left.distortion.at(0), -0.27, 0.03);
  ASSERT_TRUE(found.rotation);
  for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR((*found.rotation)[i], right.rotation[i], 0.002) << i;
  outcome = run({"segment", path("pair"), "-o", path("result")});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  EXPECT_TRUE(fs::exists(at("result") / "objects.json"));
}

TEST_F(RawCameras, RefuseAMissingBoard) {
  pair_in("boards/a");
  pair_in("boards/b");
  refuses({"calibrate", path("boards"), "--board", "9x6", "--square", "0.025", "-o", path("c.yaml")},
          {"--board 9x6", "visible in 0 of 2 pairs", "10x7 squares"});
  refuses({"calibrate", path("boards"), "--board", "nine", "--square", "0.025"}, {"--board nine", "9x6"});
  refuses({"calibrate", path("boards"), "--board", "9x6", "--square", "0"}, {"--square", "metres"});
  refuses({"calibrate", path("boards"), "--board", "9x6", "--square", "25"},
          {"--square", "metres", "25 mm are 0.025"});
  fs::create_directories(at("empty"));
  refuses({"calibrate", path("empty"), "--board", "9x6", "--square", "1"}, {"left01.png and right01.png"});
}

TEST_F(RawCameras, RefuseACalibrationOfAnotherSize) {
  io::RawCalibration raw{{640, 480}, {}, {}, {}, {}};
  raw.left.matrix = raw.right.matrix = {500, 0, 320, 0, 500, 240, 0, 0, 1};
  raw.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  raw.translation_m = {-0.1, 0, 0};
  io::save_raw_calibration(at("raw.yaml"), raw, {});
  const auto pair = pair_in("pair");
  refuses({"rectify", "--calib", path("raw.yaml"), pair[0], pair[1], "-o", path("out")},
          {"raw.yaml", "640x480", "96x72"});
}

TEST_F(RawCameras, RefuseTheCalibrationOfARectifiedPair) {
  const auto pair = pair_in("pair");
  write(at("calib.txt"), "fx=60\ncx=48\ncy=36\nbaseline=0.1\n");
  refuses({"rectify", "--calib", path("calib.txt"), pair[0], pair[1], "-o", path("out")},
          {"calib.txt", "rectified pair", "raw cameras"});
}

using Rectify = CommandTest;

/// Cameras of 160 x 96 px that need no rectification.
io::RawCalibration aligned_cameras() {
  io::RawCalibration raw{{160, 96}, {}, {}, {}, {}};
  raw.left.matrix = raw.right.matrix = {200, 0, 79.5, 0, 200, 47.5, 0, 0, 1};
  raw.left.rotation = raw.right.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  raw.left.projection = {200, 0, 79.5, 0, 0, 200, 47.5, 0, 0, 0, 1, 0};
  raw.right.projection = {200, 0, 79.5, -20, 0, 200, 47.5, 0, 0, 0, 1, 0};
  return raw;
}

TEST_F(Rectify, WritesTheDisparitiesDownToTheNearestDistance) {
  if (!is_built_in()) GTEST_SKIP() << "built without OpenCV's calib3d";
  io::save_raw_calibration(at("raw.yaml"), aligned_cameras(), {});
  const auto pair = pair_in("raw", {160, 96});
  const auto range = [&](const std::vector<std::string>& more) {
    const Outcome outcome =
        run(with("rectify", pair, with("--calib", {path("raw.yaml"), "-o", path("out")}, more)));
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return io::load_calibration(at("out/calib.txt")).num_disparities.value_or(0);
  };
  EXPECT_EQ(range({}), 48);                      // 5 baselines: a fifth of 200 px
  EXPECT_EQ(range({"--nearest", "1"}), 32);      // 200 px · 0.1 m / 1 m = 20
  EXPECT_EQ(range({"--nearest", "0.05"}), 160);  // no more than the image width
  EXPECT_EQ(run({"segment", path("out")}).code, 0);
  refuses(with("rectify", pair, {"--calib", path("raw.yaml"), "--nearest", "0", "-o", path("other")}),
          {"--nearest"});
}

TEST_F(Rectify, KeepsTheStampsOfEurocAndOfAFile) {
  if (!is_built_in()) GTEST_SKIP() << "built without OpenCV's calib3d";
  io::save_raw_calibration(at("raw.yaml"), aligned_cameras(), {});
  const auto pair = pair_in("pair", {160, 96});
  const auto copy = [&](std::size_t side, const fs::path& to) {
    fs::create_directories(to.parent_path());
    fs::copy_file(pair.at(side), to);
  };
  const std::vector<std::string> stamps{"1403636579763555584", "1403636579813555456"};
  for (std::size_t i = 0; i < 2; ++i) {
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
      copy(side, at("mav0/cam" + std::to_string(side) + "/data/" + stamps[i] + ".png"));
      copy(side, at("named/" + std::to_string(i + 9)) / (side == 0 ? "left.png" : "right.png"));
    }
  }
  write(at("named/times.txt"), "1403636579.763555584\n1403636579.813555456\n");
  for (const char* source : {"mav0", "named"}) {
    const std::string rectified = path(std::string("of_") + source);
    Outcome outcome = run({"rectify", path(source), "--calib", path("raw.yaml"), "-o", rectified});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(content(fs::path(rectified) / "stamps.txt"), "# ns\n" + stamps[0] + "\n" + stamps[1] + "\n");
    const std::string out = path(std::string("out_") + source);
    outcome = run({"segment", rectified, "-o", out});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const std::string last = std::string(source) == "mav0" ? stamps[1] : "10";
    EXPECT_NE(content(fs::path(out) / last / "objects.json").find("\"stamp_ns\": " + stamps[1]),
              std::string::npos)
        << source;
  }
}

TEST(Rectifier, LeavesARectifiedPairUnchanged) {
  if (!is_built_in()) GTEST_SKIP() << "built without OpenCV's calib3d";
  io::RawCalibration raw{{64, 48}, {}, {}, {}, {}};
  raw.left.matrix = raw.right.matrix = {60, 0, 31.5, 0, 60, 23.5, 0, 0, 1};
  raw.left.rotation = raw.right.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  raw.left.projection = {60, 0, 31.5, 0, 0, 60, 23.5, 0, 0, 0, 1, 0};
  raw.right.projection = {60, 0, 31.5, -6, 0, 60, 23.5, 0, 0, 0, 1, 0};
  const io::Rectifier rectify(raw);
  EXPECT_FLOAT_EQ(rectify.rig().baseline_m, 0.1F);
  EXPECT_FLOAT_EQ(rectify.rig().focal_px, 60);
  std::mt19937 random(1);
  io::LoadedPair pair{{Image<Gray>(Size{64, 48}), {}}, {Image<Gray>(Size{64, 48}), {}}};
  for (Image<Gray>* image : {&pair.left.gray, &pair.right.gray}) {
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 64; ++x) (*image)(x, y) = static_cast<Gray>(random() % 256);
    }
  }
  const io::LoadedPair same = rectify(pair);
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      ASSERT_EQ(same.left.gray(x, y), pair.left.gray(x, y));
      ASSERT_EQ(same.right.gray(x, y), pair.right.gray(x, y));
    }
  }
}

/// A dot at a point in metres, in the image of a fisheye camera at (x_m, 0, 0).
Image<Gray> fisheye_dot(const io::RawCamera& camera, Size size, double x_m,
                        const std::array<double, 3>& point) {
  const double a = (point[0] - x_m) / point[2];
  const double b = point[1] / point[2];
  const double r = std::hypot(a, b);
  const double t = std::atan(r);
  const auto& k = camera.distortion;
  const double distorted =
      t * (1 + k[0] * std::pow(t, 2) + k[1] * std::pow(t, 4) + k[2] * std::pow(t, 6) + k[3] * std::pow(t, 8));
  const double u = camera.matrix[0] * distorted / r * a + camera.matrix[2];
  const double v = camera.matrix[4] * distorted / r * b + camera.matrix[5];
  Image<Gray> image(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x)
      image(x, y) = static_cast<Gray>(255 * std::exp(-(std::pow(x - u, 2) + std::pow(y - v, 2)) / 8));
  }
  return image;
}

std::array<double, 2> centre_of(const Image<Gray>& image) {
  std::array<double, 3> sums{};
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      sums[0] += image(x, y) * double{1} * x;
      sums[1] += image(x, y) * double{1} * y;
      sums[2] += image(x, y);
    }
  }
  return {sums[0] / sums[2], sums[1] / sums[2]};
}

TEST(Rectifier, FisheyePairsHaveEqualRowsAndTheRightDistance) {
  if (!is_built_in()) GTEST_SKIP() << "built without OpenCV's calib3d";
  constexpr Size kSize{320, 240};
  io::RawCalibration raw{kSize, {}, {}, {}, {}};
  raw.left.matrix = raw.right.matrix = {150, 0, 159.5, 0, 150, 119.5, 0, 0, 1};
  raw.left.distortion = raw.right.distortion = {-0.01, 0.02, -0.01, 0.002};
  raw.left.is_fisheye = raw.right.is_fisheye = true;
  raw.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  raw.translation_m = {-0.1, 0, 0};
  const io::Rectifier rectify(raw);
  EXPECT_NEAR(double{rectify.rig().baseline_m}, 0.1, 1e-6);
  for (const std::array<double, 3>& point :
       {std::array{0.1, 0.1, 1.0}, std::array{-0.5, 0.3, 1.2}, std::array{0.7, -0.4, 1.5}}) {
    const io::LoadedPair pair = rectify(
        {{fisheye_dot(raw.left, kSize, 0, point), {}}, {fisheye_dot(raw.right, kSize, 0.1, point), {}}});
    const auto [left_x, left_y] = centre_of(pair.left.gray);
    const auto [right_x, right_y] = centre_of(pair.right.gray);
    EXPECT_NEAR(left_y, right_y, 0.1);
    EXPECT_NEAR(left_x - right_x, double{rectify.rig().focal_px} * 0.1 / point[2], 0.1);
    EXPECT_NEAR(left_x, double{rectify.rig().focal_px} * point[0] / point[2] + double{rectify.rig().cx_px},
                0.3);
  }
}

TEST(Calibration, RecoversSimulatedCameras) {
  if (!is_built_in()) GTEST_SKIP() << "built without OpenCV's calib3d";
  // Corners of a board in eight poses, seen by two cameras without distortion, 0.2 m apart.
  const io::Board board{7, 5, 0.04};
  constexpr double kFocal = 600;
  std::vector<io::BoardDetection> sightings;
  for (int place = 0; place < 8; ++place) {
    const double turn = 0.5 * std::sin(place * 2.0);
    const double tilt = 0.5 * std::cos(place * 3.0);
    io::BoardDetection sighting;
    for (int row = 0; row < board.rows; ++row) {
      for (int column = 0; column < board.columns; ++column) {
        const double u = board.square_m * (column - 3);
        const double v = board.square_m * (row - 2);
        const double x = u * std::cos(turn) - v * std::sin(turn) * std::sin(tilt) + 0.05 * (place % 3);
        const double y = v * std::cos(tilt) - 0.04 * (place % 2);
        const double z = 0.9 + 0.05 * place + u * std::sin(turn) + v * std::cos(turn) * std::sin(tilt);
        const auto seen = [&](double camera_x) {
          return std::array{static_cast<float>(320 + kFocal * (x - camera_x) / z),
                            static_cast<float>(240 + kFocal * y / z)};
        };
        sighting.left.push_back(seen(0));
        sighting.right.push_back(seen(0.2));
      }
    }
    sightings.push_back(std::move(sighting));
  }
  const auto found = io::calibrate_stereo(sightings, board, {640, 480});
  EXPECT_LT(found.error_px, 0.01);
  EXPECT_LT(found.rows_error_px, 0.01);
  EXPECT_EQ(found.pair_error_px.size(), sightings.size());
  EXPECT_NEAR(found.raw.left.matrix[0], kFocal, 1);
  EXPECT_NEAR(found.raw.right.matrix[2], 320, 1);
  EXPECT_NEAR((*found.raw.translation_m)[0], -0.2, 0.001);
}

}  // namespace
}  // namespace cairn::command
