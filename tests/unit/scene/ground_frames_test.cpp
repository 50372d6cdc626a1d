// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>
#include <cairn/cairn.hpp>
#include <cairn/io/calibration_files.hpp>
#include <cairn/io/image_files.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <support/collection.hpp>
#include <support/samples.hpp>

/// The floor of the rendered frames, from the first half of each preset, unchanged.
namespace cairn {
namespace {

std::filesystem::path rendered() {
  return collection() / "rendered" / "dev";
}

/// a, b, c: the numbers in the file's last line.
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

Ground found_in(const std::filesystem::path& frame, const std::string& preset) {
  const auto images = io::load_pair(frame / "left.png", frame / "right.png");
  const auto calibration = io::load_calibration(frame / "calib.txt");
  Config config = Config::preset(preset);
  config.match.num_disparities = calibration.num_disparities.value_or(config.match.num_disparities);
  const auto pair = StereoPair::from(images.left.gray, images.right.gray, images.left.rgb);
  return estimate_disparity(pair, calibration.rig, config, {}).ground;
}

/// The largest error of a plane in the lower half of the image, px.
float off_px(const GroundPlane& found, const GroundPlane& should, Size size) {
  float most = 0;
  for (const int y : {size.height / 2, size.height - 1}) {
    for (const int x : {0, size.width - 1}) {
      const auto fx = static_cast<float>(x);
      const auto fy = static_cast<float>(y);
      most = std::max(most, std::abs(found.disparity_px(fx, fy) - should.disparity_px(fx, fy)));
    }
  }
  return most;
}

struct Frames {
  const char* preset;
  const char* size;
  float farthest_px;  // of the wrong floors that are not refused
};
class GroundFrames : public testing::TestWithParam<Frames> {};

TEST_P(GroundFrames, AreWithinHalfAPixelButForTwo) {
  const auto folder = rendered() / GetParam().size;
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no data at " << folder;
  int right = 0;
  int frames = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (!std::filesystem::exists(entry.path() / "ground.txt")) continue;
    ++frames;
    const Ground ground = found_in(entry.path(), GetParam().preset);
    if (!ground.plane) continue;
    const Size size = io::load_picture(entry.path() / "left.png").gray.size();
    const float off = off_px(*ground.plane, truth(entry.path() / "ground.txt"), size);
    // Two of the twelve floors have hardly any matches of their own.
    const bool is_hard = entry.path().filename() == "dev_s04" || entry.path().filename() == "dev_s08";
    EXPECT_LE(off, is_hard ? GetParam().farthest_px : 0.5F) << entry.path();
    right += off <= 0.5F ? 1 : 0;
  }
  EXPECT_GT(frames, 2) << folder;
  EXPECT_GE(right, frames - 2);
}

/// Floors of which a hundredth to a fifth of the pixels have a disparity of their own.
TEST(MirrorFloors, AreFoundByTheirReflections) {
  for (const char* frame : {"train_s17", "train_s84", "train_s116"}) {
    const auto folder = rendered().parent_path() / "train" / "320x240" / frame;
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no data at " << folder;
    const Ground ground = found_in(folder, "default");
    ASSERT_TRUE(ground.plane) << frame;
    const GroundPlane should = truth(folder / "ground.txt");
    EXPECT_NEAR(ground.plane->disparity_px(160, 239), should.disparity_px(160, 239), 1) << frame;
    EXPECT_NEAR(ground.plane->disparity_px(160, 120), should.disparity_px(160, 120), 1) << frame;
  }
}

/// A plain floor that shows little but mirror images, of which its own smooth disparities tell, too.
TEST(MirrorFloors, IsFoundInTheSample) {
  const auto folder = samples::folder("glossy_floor");
  const Ground ground = found_in(folder, "default");
  ASSERT_TRUE(ground.plane);
  EXPECT_LE(off_px(*ground.plane, truth(folder / "ground.txt"), {320, 240}), 1.0F);
}

// `paper` refuses dev_s08.
INSTANTIATE_TEST_SUITE_P(Presets, GroundFrames,
                         testing::Values(Frames{"paper", "320x240", 1}, Frames{"paper", "640x480", 1},
                                         Frames{"default", "320x240", 2.5F},
                                         Frames{"default", "640x480", 1.5F}),
                         [](const auto& test) {
                           return std::string(test.param.preset) + "Of" + test.param.size;
                         });

}  // namespace
}  // namespace cairn
