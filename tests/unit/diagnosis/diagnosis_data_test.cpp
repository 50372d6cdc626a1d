// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/diagnosis/diagnose.hpp>
#include <cairn/diagnosis/given_disparity.hpp>
#include <cairn/diagnosis/synchrony.hpp>
#include <cairn/io/calibration_files.hpp>
#include <cairn/io/dataset.hpp>
#include <cairn/io/disparity_files.hpp>
#include <cairn/io/image_files.hpp>
#include <cairn/pipeline/config.hpp>
#include <cairn/pipeline/segment.hpp>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <support/collection.hpp>
#include <vector>

/// The doctor finds no fault in good pairs, real and rendered.
namespace cairn {
namespace {

namespace fs = std::filesystem;

/// Every folder below with a left image.
std::vector<fs::path> pairs_below(const fs::path& folder) {
  std::vector<fs::path> pairs;
  if (!fs::exists(folder)) return pairs;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.path().filename() == "left.png") pairs.push_back(entry.path().parent_path());
  return pairs;
}

// A painting behind things, a poster and a wall; and a hedge with more support than the path in front of it.
TEST(RealGrounds, OfBackgroundsAreNoFloors) {
  const auto ground_of = [](const fs::path& folder) {
    Config config = Config::preset("default");
    const auto images = io::load_pair(folder / "left.png", folder / "right.png");
    std::optional<StereoRig> rig;
    if (fs::exists(folder / "calib.txt")) {
      const auto calibration = io::load_calibration(folder / "calib.txt");
      rig = calibration.rig;
      config.match.num_disparities = calibration.num_disparities.value_or(config.match.num_disparities);
    }
    return segment(StereoPair::from(images.left.gray, images.right.gray, images.left.rgb), rig, config, {})
        .ground;
  };
  for (const char* name : {"middlebury2001/barn2", "middlebury2001/poster", "middlebury2006/Lampshade2"}) {
    const fs::path folder = collection() / "real" / name;
    if (!fs::exists(folder)) GTEST_SKIP() << "no collection of pairs here (CAIRN_DATA)";
    const Ground ground = ground_of(folder);
    EXPECT_FALSE(ground.plane) << name;
    EXPECT_EQ(ground.refusal, Refusal::unlikely) << name;
  }
  const Ground path = ground_of(collection() / "rendered/train_outdoor/320x240/out_s19");
  ASSERT_TRUE(path.plane);
  EXPECT_GT(path.plane->disparity_px(160, 239), 12);  // of the hedge: 2
}

class GoodPairs : public testing::TestWithParam<const char*> {};

TEST_P(GoodPairs, HaveNoFindings) {
  const auto pairs = pairs_below(collection() / GetParam());
  if (pairs.empty()) GTEST_SKIP() << "no collection of pairs here (CAIRN_DATA)";
  for (const fs::path& folder : pairs) {
    const auto frame = io::find_frames(folder).front();
    const auto images = io::load_pair(frame.left, *frame.right);
    io::Calibration calibration;
    if (frame.calib) calibration = io::load_calibration(*frame.calib);
    MatchConfig range = Config{}.match;
    range.num_disparities = calibration.num_disparities.value_or(range.num_disparities);
    const auto measures = measure_pair(StereoPair::from(images.left.gray, images.right.gray), {});
    for (const Finding& finding : diagnose(measures, calibration.rig, range, {}))
      ADD_FAILURE() << folder << ": " << info(finding.kind).name << ": " << finding.says;
  }
}

TEST_P(GoodPairs, FitTheirTrueDisparities) {
  for (const fs::path& folder : pairs_below(collection() / GetParam())) {
    if (!fs::exists(folder / "disp_left.png")) continue;
    const auto images = io::load_pair(folder / "left.png", folder / "right.png");
    const Image<float> truth = io::load_disparity(folder / "disp_left.png");
    if (truth.size() != images.left.gray.size()) continue;
    const auto finding =
        check_given_disparity(truth, StereoPair::from(images.left.gray, images.right.gray), std::nullopt, {});
    EXPECT_FALSE(finding) << folder << ": " << finding->says;
  }
}

INSTANTIATE_TEST_SUITE_P(Collections, GoodPairs,
                         testing::Values("rendered/dev/320x240", "rendered/dev/640x480",
                                         "real/middlebury2001", "real/middlebury2003", "real/middlebury2005",
                                         "real/middlebury2006", "real/middlebury2014", "real/rc_tabletop",
                                         "real/kitti_pairs", "real/boofcv_bumblebee2", "real/indoor_pairs"),
                         [](const auto& test) {
                           std::string name = test.param;
                           for (char& c : name) c = c == '/' ? '_' : c;
                           return name;
                         });

class GoodSequences : public testing::TestWithParam<const char*> {};

TEST_P(GoodSequences, AreSynchronousAndAShiftIsDetected) {
  if (!fs::exists(collection() / GetParam())) GTEST_SKIP() << "no sequences here (CAIRN_DATA)";
  const auto frames = io::find_frames(collection() / GetParam());
  std::vector<io::LoadedPair> images;
  for (const auto& frame : frames) images.push_back(io::load_pair(frame.left, *frame.right));
  for (const int late : {0, 1}) {
    std::vector<StereoPair> pairs;
    for (std::size_t i = 0; i + 1 < images.size(); ++i) {
      pairs.push_back(
          StereoPair::from(images[i + static_cast<std::size_t>(late)].left.gray, images[i].right.gray));
    }
    const Synchrony measured = measure_synchrony(pairs, Exec::with_threads(2));
    EXPECT_EQ(measured.lag(), late);
    EXPECT_FALSE(measured.change);
    EXPECT_TRUE(measured.tells());
  }
}

TEST_P(GoodSequences, AShiftFromTheMiddleOnIsDetected) {
  if (!fs::exists(collection() / GetParam())) GTEST_SKIP() << "no sequences here (CAIRN_DATA)";
  const auto frames = io::find_frames(collection() / GetParam());
  std::vector<io::LoadedPair> images;
  for (const auto& frame : frames) images.push_back(io::load_pair(frame.left, *frame.right));
  std::vector<StereoPair> pairs;  // the left camera loses an image
  for (std::size_t i = 0; i + 1 < images.size(); ++i) {
    const std::size_t late = i < images.size() / 2 ? 0 : 1;
    pairs.push_back(StereoPair::from(images[i + late].left.gray, images[i].right.gray));
  }
  const Synchrony measured = measure_synchrony(pairs, Exec::with_threads(2));
  ASSERT_TRUE(measured.change);
  EXPECT_EQ(measured.change->from, static_cast<int>(images.size() / 2));
  EXPECT_EQ(measured.change->before, 0);
  EXPECT_EQ(measured.change->after, 1);
}

TEST(SlowSequence, IsNotJudgedSynchronous) {
  const fs::path folder = collection() / "real/sequences/conveyor_box";
  if (!fs::exists(folder)) GTEST_SKIP() << "no sequences here (CAIRN_DATA)";
  std::vector<io::LoadedPair> images;
  for (const auto& frame : io::find_frames(folder)) images.push_back(io::load_pair(frame.left, *frame.right));
  std::vector<StereoPair> pairs;
  for (const auto& pair : images) pairs.push_back(StereoPair::from(pair.left.gray, pair.right.gray));
  const auto finding = diagnose(measure_synchrony(pairs, Exec::with_threads(2)));
  ASSERT_TRUE(finding);
  EXPECT_EQ(static_cast<int>(finding->severity), static_cast<int>(Severity::note)) << finding->says;
}

INSTANTIATE_TEST_SUITE_P(Collections, GoodSequences,
                         testing::Values("rendered/dev/sequences/dev_seqA",
                                         "rendered/dev/sequences/dev_seqB"),
                         [](const auto& test) { return std::string(test.param).substr(23); });

}  // namespace
}  // namespace cairn
