// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>
#include <cairn/cairn.hpp>
#include <io/calibration_files.hpp>
#include <io/image_files.hpp>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <support/collection.hpp>

/// The floor of the rendered frames, by the whole first half of the preset `paper`.
namespace cairn {
namespace {

std::filesystem::path rendered() {
  return collection() / "rendered" / "dev";
}

/// a, b, c: the numbers of the file's last line.
GroundPlane truth(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string last;
  for (std::string line; std::getline(stream, line);) {
    if (!line.empty()) last = line;
  }
  GroundPlane plane;
  std::istringstream(last) >> plane.a >> plane.b >> plane.c;
  return plane;
}

Ground found_in(const std::filesystem::path& frame) {
  const auto pictures = io::load_pair(frame / "left.png", frame / "right.png");
  const auto calibration = io::load_calibration(frame / "calib.txt");
  Config config = Config::paper();
  config
      .texture = {};  // checks as strict as the stages' own defaults: fewer matches, and fewer mirrored ones
  config.uniqueness = {};
  config.match.num_disparities = calibration.num_disparities.value_or(config.match.num_disparities);
  const auto pair = StereoPair::from(pictures.left.gray, pictures.right.gray);
  return estimate_disparity(pair, calibration.rig, config, {}).ground;
}

class GroundFrames : public testing::TestWithParam<const char*> {};

TEST_P(GroundFrames, AreWithinHalfAPixelOrRefused) {
  const auto folder = rendered() / GetParam();
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no data at " << folder;
  int found = 0;
  int frames = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (!std::filesystem::exists(entry.path() / "ground.txt")) continue;
    ++frames;
    const Ground ground = found_in(entry.path());
    if (!ground.plane) continue;
    ++found;
    const GroundPlane should = truth(entry.path() / "ground.txt");
    const Size size = io::load_picture(entry.path() / "left.png").gray.size();
    for (const int y : {size.height / 2, size.height - 1}) {
      for (const int x : {0, size.width - 1}) {
        const auto fx = static_cast<float>(x);
        const auto fy = static_cast<float>(y);
        EXPECT_NEAR(ground.plane->disparity_px(fx, fy), should.disparity_px(fx, fy), 0.5F) << entry.path();
      }
    }
  }
  EXPECT_GT(frames, 2) << folder;
  // Two of the twelve floors, plain and mirroring, have hardly a match of their own: those are refused.
  EXPECT_GE(found, frames - 2);
}

/// Floors of which a hundredth to a fifth of the pixels have a disparity of their own.
TEST(MirrorFloors, AreFoundByWhatTheyMirror) {
  for (const char* frame : {"train_s17", "train_s84", "train_s116"}) {
    const auto folder = rendered().parent_path() / "train" / "320x240" / frame;
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no data at " << folder;
    const auto pictures = io::load_pair(folder / "left.png", folder / "right.png");
    const auto calibration = io::load_calibration(folder / "calib.txt");
    Config config;
    config.match.num_disparities = calibration.num_disparities.value_or(config.match.num_disparities);
    const auto pair = StereoPair::from(pictures.left.gray, pictures.right.gray, pictures.left.rgb);
    const Ground ground = estimate_disparity(pair, calibration.rig, config, {}).ground;
    ASSERT_TRUE(ground.plane) << frame;
    const GroundPlane should = truth(folder / "ground.txt");
    EXPECT_NEAR(ground.plane->disparity_px(160, 239), should.disparity_px(160, 239), 1) << frame;
    EXPECT_NEAR(ground.plane->disparity_px(160, 120), should.disparity_px(160, 120), 1) << frame;
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, GroundFrames, testing::Values("320x240", "640x480"),
                         [](const auto& test) { return "Of" + std::string(test.param); });

}  // namespace
}  // namespace cairn
