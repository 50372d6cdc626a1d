// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/io/calibration_files.hpp>

#include "command.hpp"

/// cairn record: its output is readable as the same sequence.
namespace cairn::command {
namespace {

class Record : public CommandTest {
 protected:
  void frames(int count) const {
    for (int i = 0; i < count; ++i) {
      const std::string name = "in/" + std::to_string(i);
      pair_in(name, {48, 36});
      write(at(name + "/calib.txt"),
            "fx=60.25\nfy=60.25\ncx=24\ncy=18\nbaseline=0.1\ndoffs=1.5\nndisp=32\ncamera_height=0.8\n"
            "camera_pitch=12.5\nground_points=10,20,4,20;30,21,23,21;20,23,12,23;28,19,18,19\n");
    }
  }

 private:
  void pair_in(const std::string& folder, Size size) const {
    fs::create_directories(at(folder));
    Image<Rgb> left(size);
    Image<Gray> right(size);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        const auto value = static_cast<std::uint8_t>(7 * x + 13 * y + static_cast<int>(folder.back()));
        left(x, y) = {value, static_cast<std::uint8_t>(3 * value), static_cast<std::uint8_t>(x)};
        right(x, y) = value;
      }
    }
    io::save_png(at(folder) / "left.png", left.view());
    io::save_png(at(folder) / "right.png", right.view());
  }
};

TEST_F(Record, WritesIdenticalPixelsStampsAndCalibration) {
  frames(3);
  write(at("in/stamps.txt"), "5.0\n5.125\n7.5\n");
  const Outcome outcome = run({"record", path("in"), "-o", path("out")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.err.find("cairn: note: too little texture: "), 0U) << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  EXPECT_NE(outcome.out.find("recorded 3 frames"), std::string::npos) << outcome.out;
  EXPECT_EQ(content(at("out/stamps.txt")), "# ns\n5000000000\n5125000000\n7500000000\n");
  for (int i = 0; i < 3; ++i) {
    const fs::path written = at("out") / ("00000" + std::to_string(i));
    EXPECT_EQ(content(written / "left.png"), content(at("in/" + std::to_string(i) + "/left.png")));
    EXPECT_EQ(content(written / "right.png"), content(at("in/" + std::to_string(i) + "/right.png")));
    const auto calibration = io::load_calibration(written / "calib.txt");
    ASSERT_TRUE(calibration.rig);
    EXPECT_EQ(calibration.rig->focal_px, 60.25F);
    EXPECT_EQ(calibration.rig->doffs_px, 1.5F);
    EXPECT_EQ(calibration.num_disparities, 32);
    EXPECT_EQ(calibration.image_size, (Size{48, 36}));
    EXPECT_EQ(calibration.ground, io::load_calibration(at("in/0/calib.txt")).ground);
  }
  // The output is a source.
  ASSERT_EQ(run({"record", path("out"), "-o", path("again")}).code, 0);
  for (const auto& entry : fs::recursive_directory_iterator(at("out"))) {
    if (entry.is_regular_file()) {
      EXPECT_EQ(content(entry.path()), content(at("again") / fs::relative(entry.path(), at("out"))));
    }
  }
}

TEST_F(Record, HonoursARangeAndARate) {
  frames(5);
  Outcome outcome = run({"record", path("in"), "-o", path("out"), "--frames", "1:5:2", "--rate", "5"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(content(at("out/stamps.txt")), "# ns\n200000000\n600000000\n");
  outcome = run({"record", path("in"), "-o", path("two"), "--frames", "2"});
  EXPECT_NE(outcome.out.find("recorded 2 frames"), std::string::npos) << outcome.out;
}

TEST_F(Record, CountsUnreadableFramesAndKeepsTheOthers) {
  frames(4);
  write(at("in/1/left.png"), content(at("in/1/left.png")).substr(0, 70));
  fs::remove(at("in/2/right.png"));
  const Outcome outcome = run({"record", path("in"), "-o", path("out")});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.out.find("recorded 2 frames"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.err.find("cannot be read: 1 frame skipped"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("without a right one: 1 frame skipped, the first is 2"), std::string::npos)
      << outcome.err;
}

TEST_F(Record, KeepsCompleteFramesIfTheSourceChangesItsSize) {
  frames(3);
  const Image<Gray> other(Size{20, 20}, Gray{5}, Pool{});
  io::save_png(at("in/2/left.png"), other.view());
  io::save_png(at("in/2/right.png"), other.view());
  const Outcome outcome = run({"record", path("in"), "-o", path("out")});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.err.find("2/left.png: is 20x20, expected 48x36"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("keeps the 2 frames before"), std::string::npos) << outcome.err;
  EXPECT_EQ(run({"record", path("out"), "-o", path("again")}).code, 0);
}

TEST_F(Record, RefusesWithoutWritingAnything) {
  frames(2);
  refuses({"record", path("nowhere"), "-o", path("out")}, {"nowhere", "not found"});
  refuses({"record", path("in"), "-o", path("in")}, {"is not empty"});
  refuses({"record", path("in"), "-o", path("in/0/left.png")}, {"is not a folder"});
  refuses({"record", path("in"), "-o", path("out"), "--frames", "5:4"}, {"--frames 5:4"});
  refuses({"record", path("in"), "-o", path("out"), "--frames", "7:"}, {"has 2 frames", "--frames"});
  refuses({"record", path("in"), "-o", path("out"), "--rate", "-1"}, {"--rate"});
  refuses({"record", path("in"), "-o", path("out"), "--layout", "side_by_side"}, {"--layout"});
  refuses({"record", path("in"), "-o", path("out"), "--calib", path("none.txt")}, {"none.txt"});
  refuses({"record", path("in"), "-o", path("out"), "--rectify"}, {"calib.txt", "raw cameras"});
  write(at("in/stamps.txt"), "1.0\n");
  refuses({"record", path("in"), "-o", path("out")}, {"stamps.txt", "has 1 stamps", "2 frames"});
  write(at("clip.mp4"), "no video");
  refuses({"record", path("clip.mp4"), "-o", path("out")}, {"clip.mp4"});
  refuses({"record", path("clip.mp4"), "--layout", "side_by_side", "-o", path("out")}, {"clip.mp4"});
  refuses({"record", path("in")}, {"--output"});
}

}  // namespace
}  // namespace cairn::command
