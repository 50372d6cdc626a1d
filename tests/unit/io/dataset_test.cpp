// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/io/calibration_files.hpp>
#include <cairn/io/dataset.hpp>

#include "support/collection.hpp"
#include "support/temporary_folder.hpp"

namespace cairn {
namespace {

namespace fs = std::filesystem;
using support::has;
using support::refusal;
using support::TemporaryFolder;

TEST(Dataset, AFolderWithALeftImageIsOneFrame) {
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

TEST(Dataset, TheNameIsTheFoldersHoweverThePathIsWritten) {
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

TEST(Dataset, FramesAreInTheOrderOfTheNumbersInTheirNames) {
  const TemporaryFolder folder;
  for (const char* name : {"f10/left.png", "f9/left.png", "f100/left.png", "f011/left.png"})
    (void)folder.with(name, "");
  std::vector<std::string> names;
  for (const auto& frame : io::find_frames(folder.path())) names.push_back(frame.name);
  EXPECT_EQ(names, (std::vector<std::string>{"f9", "f10", "f011", "f100"}));
}

TEST(Dataset, OtherwisePairsOfNamesShareTheFoldersCalibration) {
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

TEST(Dataset, TheRightImageOfTheSameFormatIsPreferred) {
  const TemporaryFolder folder;
  for (const char* name : {"left.ppm", "right.png", "right.ppm"}) (void)folder.with(name, "");
  EXPECT_EQ(io::find_frames(folder.path())[0].right, folder.path() / "right.ppm");
}

TEST(Dataset, TheCalibrationIsTheFramesOwnOrThatOfItsTruth) {
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
  EXPECT_TRUE(has(refusal([&] { io::find_frames(folder.path() / "none"); }), {"none", "no such folder"}));
  EXPECT_TRUE(has(refusal([&] { io::find_frames(folder.with("file", "")); }), {"not a folder"}));
  EXPECT_TRUE(has(refusal([&] { io::find_frames(""); }), {"no such folder"}));
}

TEST(Dataset, TruthIsInTheFrameOrNextToIt) {
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
  EXPECT_TRUE(has(refusal([&] { io::find_truth(folder.path() / "none"); }), {"no such folder"}));
}

// ---- data sets as they are downloaded ----

TEST(Dataset, AFolderOfMiddleburyOrEth3dIsOneFrame) {
  const TemporaryFolder folder;
  for (const char* name :
       {"motorcycle/im0.png",   "motorcycle/im1.png",   "motorcycle/im1E.png",  "motorcycle/calib.txt",
        "motorcycle/disp0.pfm", "motorcycle/disp1.pfm", "teddy/im0.ppm",        "teddy/im1.ppm",
        "teddy/im2.ppm",        "teddy/im6.ppm",        "teddy/disp2.pgm",      "teddy/disp6.pgm",
        "Art/view1.png",        "Art/view5.png",        "Art/disp1.png",        "Art/disp5.png",
        "map/im0.pgm",          "map/im1.pgm",          "map/im2.pgm",          "map/disp0.pgm",
        "delivery/im0.png",     "delivery/im1.png",     "delivery/disp0GT.pfm", "delivery/mask0nocc.png"}) {
    (void)folder.with(name, "");
  }
  const auto is = [&](const std::string& name, const char* left, const char* right, const char* truth) {
    const fs::path at = folder.path() / name;
    const auto frames = io::find_frames(at);
    ASSERT_EQ(frames.size(), 1U) << name;
    EXPECT_EQ(frames[0].name, name);
    EXPECT_EQ(frames[0].left, at / left);
    EXPECT_EQ(frames[0].right, at / right);
    EXPECT_EQ(io::find_truth(frames[0]).disparity, at / truth);
  };
  is("motorcycle", "im0.png", "im1.png", "disp0.pfm");
  is("teddy", "im2.ppm", "im6.ppm", "disp2.pgm");
  is("Art", "view1.png", "view5.png", "disp1.png");
  is("map", "im0.pgm", "im1.pgm", "disp0.pgm");
  is("delivery", "im0.png", "im1.png", "disp0GT.pfm");
  EXPECT_EQ(io::find_frames(folder.path()).size(), 5U);
  EXPECT_EQ(io::find_frames(folder.path() / "motorcycle")[0].calib, folder.path() / "motorcycle/calib.txt");
  EXPECT_EQ(io::find_truth(folder.path() / "delivery").occlusion->filename(), "mask0nocc.png");
}

TEST(Dataset, TheMissingImageOfAPairIsNamed) {
  const TemporaryFolder folder;
  (void)folder.with("Art/view1.png", "");
  const auto frames = io::find_frames(folder.path() / "Art");
  EXPECT_FALSE(frames[0].right);
  EXPECT_EQ(frames[0].expected_right, folder.path() / "Art/view5.png");
}

TEST(Dataset, KittisFoldersHoldFramesWithTheirOwnCalibrationAndTruth) {
  const TemporaryFolder folder;
  for (const char* name :
       {"training/image_2/000000_10.png", "training/image_3/000000_10.png", "training/image_2/000000_11.png",
        "training/image_3/000000_11.png", "training/image_2/000001_10.png", "training/image_0/000000_10.png",
        "training/calib_cam_to_cam/000000.txt", "training/disp_occ_0/000000_10.png",
        "training/disp_noc_0/000000_10.png", "odometry/image_0/000000.png", "odometry/image_1/000000.png",
        "odometry/calib.txt", "2012/colored_0/000000_10.png", "2012/colored_1/000000_10.png",
        "2012/calib/000000.txt", "2012/disp_occ/000000_10.png", "day/drive/image_02/data/0000000000.png",
        "day/drive/image_03/data/0000000000.png", "day/calib_cam_to_cam.txt"}) {
    (void)folder.with(name, "");
  }
  const fs::path training = folder.path() / "training";
  const auto frames = io::find_frames(training);
  ASSERT_EQ(frames.size(), 2U);  // 000001_10 has no right image
  EXPECT_EQ(frames[0].name, "000000_10");
  EXPECT_EQ(frames[1].right, training / "image_3/000000_11.png");
  EXPECT_EQ(frames[1].calib, training / "calib_cam_to_cam/000000.txt");
  EXPECT_FALSE(frames[0].grey_cameras);
  const io::TruthFiles truth = io::find_truth(frames[0]);
  EXPECT_EQ(truth.disparity, training / "disp_occ_0/000000_10.png");
  EXPECT_EQ(truth.occlusion, training / "disp_noc_0/000000_10.png");
  EXPECT_EQ(io::find_truth(training, "000000_10").disparity, truth.disparity);
  EXPECT_FALSE(io::names_truth(training, "000000_11"));

  const auto odometry = io::find_frames(folder.path() / "odometry");
  EXPECT_TRUE(odometry.at(0).grey_cameras);
  EXPECT_EQ(odometry[0].calib, folder.path() / "odometry/calib.txt");
  const auto of_2012 = io::find_frames(folder.path() / "2012");
  EXPECT_EQ(of_2012.at(0).calib, folder.path() / "2012/calib/000000.txt");
  EXPECT_EQ(io::find_truth(of_2012[0]).disparity, folder.path() / "2012/disp_occ/000000_10.png");
  const auto raw = io::find_frames(folder.path() / "day/drive");
  EXPECT_EQ(raw.at(0).calib, folder.path() / "day/calib_cam_to_cam.txt");
  // For a folder above several frame folders, the message names those.
  EXPECT_TRUE(has(refusal([&] { (void)io::find_frames(folder.path()); }), {"2012", "give that folder"}));
}

TEST(Dataset, EurocsRawImagesAreForRectifyOnly) {
  const TemporaryFolder folder;
  for (const char* name :
       {"MH_01/mav0/cam0/data/140.png", "MH_01/mav0/cam1/data/140.png", "MH_01/mav0/cam0/data/141.png"})
    (void)folder.with(name, "");
  for (const fs::path& at : {folder.path() / "MH_01", folder.path() / "MH_01/mav0"}) {
    EXPECT_TRUE(has(refusal([&] { (void)io::find_frames(at); }),
                    {"EuRoC", "raw", "cairn rectify " + at.string(), "cam0/sensor.yaml"}));
    const auto frames = io::find_frames(at, io::Cameras::raw);
    ASSERT_EQ(frames.size(), 1U);
    EXPECT_EQ(frames[0].right, folder.path() / "MH_01/mav0/cam1/data/140.png");
  }
}

TEST(Dataset, HiddenPixelsAreReadInTheFormatOfEachDataSet) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "disp_noc_0");
  const auto hidden = [&](const char* name, auto seen, auto not_seen) {
    Image<decltype(seen)> image({2, 1});
    image(0, 0) = seen;
    image(1, 0) = not_seen;
    io::save_png(folder.path() / name, image.view());
    const Image<std::uint8_t> read = io::load_hidden(folder.path() / name);
    EXPECT_EQ(read(0, 0), 0) << name;
    EXPECT_EQ(read(1, 0), 1) << name;
  };
  hidden("occlusion.png", std::uint8_t{0}, std::uint8_t{255});
  hidden("mask0nocc.png", std::uint8_t{255}, std::uint8_t{128});
  hidden("disp_noc_0/000000_10.png", std::uint16_t{2560}, std::uint16_t{0});
}

TEST(Dataset, EveryFrameOfTheCollectionIsFoundWithItsCalibration) {
  const fs::path data = collection();
  if (!fs::is_directory(data)) GTEST_SKIP() << "no collection of pairs here (CAIRN_DATA)";
  const auto stress = io::find_frames(data / "rendered/stress/base0");
  EXPECT_EQ(stress.size(), 21U);
  for (const auto& entry : fs::recursive_directory_iterator(data)) {
    if (entry.path().filename() != "left.png") continue;
    const auto frames = io::find_frames(entry.path().parent_path());
    ASSERT_TRUE(frames.at(0).right && frames[0].calib) << entry.path();
    const io::Calibration calibration = io::load_calibration(*frames[0].calib);
    EXPECT_TRUE(calibration.image_size && calibration.num_disparities) << entry.path();
  }
}

}  // namespace
}  // namespace cairn
