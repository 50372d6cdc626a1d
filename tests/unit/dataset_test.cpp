// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cstdlib>
#include <io/calibration_files.hpp>
#include <io/dataset.hpp>

#include "support/temporary_folder.hpp"

namespace cairn {
namespace {

namespace fs = std::filesystem;
using support::has;
using support::refusal;
using support::TemporaryFolder;

TEST(Dataset, AFolderWithALeftPictureIsOneFrame) {
  const TemporaryFolder folder;
  const fs::path left = folder.with("one/left.png", "");
  const fs::path right = folder.with("one/right.png", "");
  const fs::path calib = folder.with("one/calib.txt", "");
  (void)folder.with("one/deeper/left.png", "");
  const auto frames = io::find_frames(folder.path() / "one");
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].name, "one");
  EXPECT_EQ(frames[0].left, left);
  EXPECT_EQ(frames[0].right, right);
  EXPECT_EQ(frames[0].calib, calib);
}

TEST(Dataset, TheNameIsTheFoldersHoweverItIsWritten) {
  const TemporaryFolder folder;
  (void)folder.with("one/left.png", "");
  EXPECT_EQ(io::find_frames(folder.path() / "one/")[0].name, "one");
  EXPECT_EQ(io::find_frames(folder.path() / "one/.")[0].name, "one");
  EXPECT_EQ(io::find_frames(folder.path() / "one/../one")[0].name, "one");
}

TEST(Dataset, OtherwiseEachSubFolderWithOneIsSortedByName) {
  const TemporaryFolder folder;
  for (const char* name : {"b/left.jpg", "b/right.jpg", "a/left.tif", "c/notes.txt", "gt/objects.png",
                           "010/left.pgm", "right.png"}) {
    (void)folder.with(name, "");
  }
  const auto frames = io::find_frames(folder.path());
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[0].name, "010");
  EXPECT_EQ(frames[1].name, "a");
  EXPECT_EQ(frames[2].name, "b");
  EXPECT_EQ(frames[2].right, folder.path() / "b/right.jpg");
  EXPECT_FALSE(frames[1].right);
}

TEST(Dataset, OtherwisePairsThatDifferInTheirNamesAloneAreWithTheFoldersCalibration) {
  const TemporaryFolder folder;
  for (const char* name : {"left01.png", "right01.png", "left02.png", "right02.png", "left03.png",
                           "calib.txt", "disp_left.png", "disp_right.png"}) {
    (void)folder.with(name, "");
  }
  const auto frames = io::find_frames(folder.path());
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[1].name, "left02");
  EXPECT_EQ(frames[1].right, folder.path() / "right02.png");
  EXPECT_EQ(frames[1].calib, folder.path() / "calib.txt");
  EXPECT_EQ(frames[1].folder, folder.path());
}

TEST(Dataset, TheRightPictureOfTheSameKindIsPreferred) {
  const TemporaryFolder folder;
  for (const char* name : {"left.ppm", "right.png", "right.ppm"}) (void)folder.with(name, "");
  EXPECT_EQ(io::find_frames(folder.path())[0].right, folder.path() / "right.ppm");
}

TEST(Dataset, TheCalibrationIsTheFramesOwnThenThatOfTheTruthBesideIt) {
  const TemporaryFolder folder;
  (void)folder.with("a/left.png", "");
  (void)folder.with("b/left.png", "");
  EXPECT_FALSE(io::find_frames(folder.path())[0].calib);
  (void)folder.with("gt/calib.txt", "");
  (void)folder.with("b/calib.yaml", "");
  const auto frames = io::find_frames(folder.path());
  EXPECT_EQ(frames[0].calib->lexically_normal().parent_path().filename(), "gt");
  EXPECT_EQ(frames[1].calib, folder.path() / "b/calib.yaml");
}

TEST(Dataset, RefusesFoldersWithoutFrames) {
  const TemporaryFolder folder;
  EXPECT_TRUE(has(refusal([&] { io::find_frames(folder.path()); }), {"left.png"}));
  EXPECT_TRUE(has(refusal([&] { io::find_frames(folder.path() / "none"); }), {"none", "not there"}));
  EXPECT_TRUE(has(refusal([&] { io::find_frames(folder.with("file", "")); }), {"no folder"}));
  EXPECT_TRUE(has(refusal([&] { io::find_frames(""); }), {"not there"}));
}

TEST(Dataset, TruthIsInTheFrameOrBesideIt) {
  const TemporaryFolder folder;
  for (const char* name : {"gt/objects.png", "gt/ground.txt", "gt/ground.png", "variant/left.png",
                           "own/disp_left.png", "own/occlusion.png", "own/partial", "own/calib.txt"}) {
    (void)folder.with(name, "");
  }
  const io::TruthFiles beside = io::find_truth(folder.path() / "variant");
  EXPECT_EQ(beside.objects->filename(), "objects.png");
  EXPECT_EQ(beside.folder.filename(), "gt");
  EXPECT_TRUE(beside.ground && beside.ground_plane);
  EXPECT_FALSE(beside.disparity || beside.occlusion || beside.calib || beside.partial);
  const io::TruthFiles own = io::find_truth(folder.path() / "own");
  EXPECT_EQ(own.disparity, folder.path() / "own/disp_left.png");
  EXPECT_TRUE(own.occlusion && own.calib && own.partial);
  EXPECT_FALSE(own.objects);
  EXPECT_EQ(io::find_truth(folder.path() / "gt").objects, folder.path() / "gt/objects.png");
}

TEST(Dataset, RefusesFoldersWithoutTruth) {
  const TemporaryFolder folder;
  (void)folder.with("a/left.png", "");
  EXPECT_TRUE(has(refusal([&] { io::find_truth(folder.path() / "a"); }), {"objects.png", "gt"}));
  EXPECT_TRUE(has(refusal([&] { io::find_truth(folder.path() / "none"); }), {"not there"}));
}

/// The shared collection of pairs, where this machine has it.
std::optional<fs::path> collection() {
  const char* named = std::getenv("CAIRN_DATA");
  const fs::path path = named != nullptr ? fs::path(named) : fs::path(CAIRN_SOURCE_DIR) / "../shared/data";
  if (!fs::is_directory(path)) return std::nullopt;
  return path;
}

TEST(Dataset, EveryFrameOfTheCollectionIsFoundWithItsCalibration) {
  const std::optional<fs::path> data = collection();
  if (!data) GTEST_SKIP() << "no collection of pairs here (CAIRN_DATA)";
  const auto stress = io::find_frames(*data / "rendered/stress/base0");
  EXPECT_EQ(stress.size(), 21U);
  for (const auto& entry : fs::recursive_directory_iterator(*data)) {
    if (entry.path().filename() != "left.png") continue;
    const auto frames = io::find_frames(entry.path().parent_path());
    ASSERT_TRUE(frames.at(0).right && frames[0].calib) << entry.path();
    const io::Calibration calibration = io::load_calibration(*frames[0].calib);
    EXPECT_TRUE(calibration.image_size && calibration.num_disparities) << entry.path();
  }
}

}  // namespace
}  // namespace cairn
