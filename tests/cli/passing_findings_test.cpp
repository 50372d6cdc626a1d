// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/io/disparity_files.hpp>

#include "command.hpp"
#include "support/samples.hpp"

/// Findings that `cairn segment` prints on stderr.
namespace cairn::command {
namespace {

using Passing = CommandTest;

std::string picture(const std::string& sample, const char* side) {
  return (samples::folder(sample) / (std::string(side) + ".png")).string();
}

std::ptrdiff_t lines(const std::string& text) {
  return std::count(text.begin(), text.end(), '\n');
}

TEST_F(Passing, IsSilentOnGoodPairs) {
  for (const char* name : samples::kNames)
    EXPECT_EQ(run({"segment", samples::folder(name).string()}).err, "") << name;
}

TEST_F(Passing, ReportsSwappedCamerasLikeTheDoctor) {
  const Outcome outcome = run({"segment", picture("overlap", "right"), picture("overlap", "left")});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.err.find("cairn: broken: cameras swapped: 100 % of "), 0U) << outcome.err;
  EXPECT_NE(outcome.err.find(". Exchange the two images"), std::string::npos) << outcome.err;
  const std::string doctor = run({"doctor", picture("overlap", "right"), picture("overlap", "left")}).out;
  const std::string sentence = outcome.err.substr(15, outcome.err.find(". ") - 15);
  EXPECT_NE(doctor.find(sentence), std::string::npos) << sentence << "\n" << doctor;
}

TEST_F(Passing, ReportsATooShortRange) {
  const Outcome outcome =
      run({"segment", samples::folder("overlap").string(), "--set", "match.num_disparities=16"});
  EXPECT_EQ(outcome.err.find("cairn: warning: disparity range too small: "), 0U) << outcome.err;
  EXPECT_NE(outcome.err.find("0 ... 15 px"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("match.num_disparities=32"), std::string::npos) << outcome.err;
  EXPECT_EQ(lines(outcome.err), 1) << outcome.err;
}

TEST_F(Passing, ReportsWhyThereIsNoFloorUnlessDisabled) {
  const auto pair = pair_in("pair");
  const Outcome outcome = run(with("segment", pair));
  EXPECT_EQ(outcome.err.find("cairn: note: no floor: "), 0U) << outcome.err;
  EXPECT_EQ(lines(outcome.err), 1) << outcome.err;
  EXPECT_EQ(run(with("segment", pair, {"--set", "ground.source=off"})).err, "");
}

TEST_F(Passing, ReportsACalibrationOfAnotherSizeEvenIfTheFileHasNoSize) {
  write(at("large.txt"), "fx=300\nfy=300\ncx=640\ncy=480\nbaseline=0.1\nndisp=32\n");
  const Outcome outcome = run({"segment", samples::folder("overlap").string(), "--calib", path("large.txt")});
  EXPECT_EQ(outcome.err.find("cairn: broken: implausible calibration: the principal point (640"), 0U)
      << outcome.err;
}

/// Frames a … f, each the sample with levels from `least` to `most` where it had 0 to 255.
void toned_frames(const fs::path& folder, const char* names, int least, int most) {
  for (const char* name = names; *name != '\0'; ++name) {
    const fs::path frame = folder / std::string(1, *name);
    fs::create_directories(frame);
    for (const char* side : {"left", "right"}) {
      Image<Gray> image = io::load_picture(picture("overlap", side)).gray;
      for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x)
          image(x, y) = static_cast<Gray>(std::clamp(least + image(x, y) * (most - least) / 255, 0, 255));
      }
      io::save_png(frame / (std::string(side) + ".png"), image.view());
    }
  }
}

TEST_F(Passing, ReportsAProblemOfManyFramesOnce) {
  toned_frames(at("frames"), "abcd", 0, 30);
  toned_frames(at("frames"), "e", 0, 255);
  const Outcome outcome = run({"segment", path("frames"), "--set", "match.num_disparities=32"});
  EXPECT_EQ(outcome.code, 0);
  const std::size_t dark = outcome.err.find("cairn: warning: low contrast: ");
  ASSERT_NE(dark, std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find(", in 4 of 5 frames (a, b, c, ...). Lengthen the exposure"), std::string::npos)
      << outcome.err;
  EXPECT_EQ(outcome.err.find("low contrast", dark + 30), std::string::npos) << outcome.err;
}

TEST_F(Passing, ReportsOverexposedImages) {
  toned_frames(at("frames"), "a", 120, 900);
  const Outcome outcome = run({"segment", path("frames/a"), "--set", "match.num_disparities=32"});
  EXPECT_NE(outcome.err.find("clipped exposure: in the left image "), std::string::npos) << outcome.err;
}

TEST_F(Passing, CountsSuspectFramesBeyondTheMeasuredOnes) {
  for (const char* name : {"a", "b", "c", "d", "e", "f", "g"}) {
    fs::create_directories(at("frames") / name);
    fs::copy_file(picture("overlap", "left"), at("frames") / name / "right.png");
    fs::copy_file(picture("overlap", "right"), at("frames") / name / "left.png");
  }
  const Outcome outcome = run({"segment", path("frames"), "--set", "match.num_disparities=32"});
  EXPECT_NE(outcome.err.find("cameras swapped"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("in 5 of 7 frames (a, b, c, ...)"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("cairn: note: 2 more frames have hardly any common rows"), std::string::npos)
      << outcome.err;
}

/// The true disparities of the sample, changed.
template <class Value>
void write_map(const fs::path& path, Value value) {
  const Image<float> truth = io::load_disparity(samples::folder("overlap") / "disp_left.png");
  Image<float> map(truth.size());
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) map(x, y) = value(truth, x, y);
  }
  io::save_disparity(path, map);
}

TEST_F(Passing, RefusesAMapThatIsNoDisparityOfTheImages) {
  const std::string sample = samples::folder("overlap").string();
  write_map(at("true.pfm"), [](const auto& truth, int x, int y) { return truth(x, y); });
  EXPECT_EQ(run({"segment", sample, "--disparity", path("true.pfm")}).err, "");
  write_map(at("mm.png"), [](const auto& truth, int x, int y) { return 20 / truth(x, y); });
  const Outcome depth = run({"segment", sample, "--disparity", path("mm.png")});
  EXPECT_EQ(depth.code, 2);
  EXPECT_EQ(depth.err.find("cairn: --disparity " + path("mm.png") + ": no disparity of these images: "), 0U)
      << depth.err;
  EXPECT_NE(depth.err.find("it looks like depth"), std::string::npos) << depth.err;
  EXPECT_EQ(lines(depth.err), 1) << depth.err;
  write_map(at("flipped.pfm"),
            [](const auto& truth, int x, int y) { return truth(x, truth.height() - 1 - y); });
  const Outcome flipped = run({"segment", picture("overlap", "left"), picture("overlap", "right"),
                               "--disparity", path("flipped.pfm")});
  EXPECT_EQ(flipped.code, 2);
  EXPECT_NE(flipped.err.find("upside down"), std::string::npos) << flipped.err;
  // Without the right image nothing can be compared.
  EXPECT_EQ(run({"segment", picture("overlap", "left"), "--disparity", path("flipped.pfm")}).code, 0);
}

TEST_F(Passing, RefusesEveryMapOfAFolderUntilOneFits) {
  toned_frames(at("frames"), "abcdefgh", 0, 255);
  fs::create_directories(at("maps"));
  for (const char* name : {"a", "b", "c", "d", "e", "f", "g", "h"}) {
    write_map(at("maps") / (std::string(name) + ".pfm"),
              [&](const auto& truth, int x, int y) { return *name < 'h' ? 16 * truth(x, y) : truth(x, y); });
  }
  const Outcome outcome = run({"segment", path("frames"), "--disparity", path("maps")});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.err.find("frame a is skipped: --disparity"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("cairn: 7 of 8 frames skipped"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace cairn::command
