// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// --html, --ply and --ply-objects of the commands: locations of the files, and refusals. For their content
// see unit/output/html_page_test.cpp, unit/io/point_cloud_test.cpp, cli/page_in_browser.py.
#include <gtest/gtest.h>

#include <cairn/output/results.hpp>
#include <cstring>
#include <map>
#include <support/samples.hpp>

#include "command.hpp"

namespace cairn::command {
namespace {

class PageAndCloudTest : public CommandTest {
 protected:
  static constexpr const char* kCalibration = "fx=80\nfy=80\ncx=48\ncy=36\nbaseline=0.1\nndisp=16\n";
};

TEST_F(PageAndCloudTest, OneFrameHasBothInItsFolder) {
  pair_in("frame");
  write(at("frame") / "calib.txt", kCalibration);
  const Outcome outcome = run({"segment", path("frame"), "--html", "--ply", "-o", path("out")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_TRUE(content(at("out") / "segment.html").starts_with("<!doctype html>"));
  EXPECT_TRUE(content(at("out") / "cloud.ply").starts_with("ply\nformat binary_little_endian"));
}

TEST_F(PageAndCloudTest, AFolderOfFramesHasOnePageAndACloudForEach) {
  for (const std::string name : {"a", "b"}) {
    pair_in("frames/" + name);
    write(at("frames/" + name) / "calib.txt", kCalibration);
  }
  const Outcome outcome = run({"segment", path("frames"), "--html", "--ply", "-o", path("out")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const std::string page = content(at("out") / "segment.html");
  EXPECT_NE(page.find("id=\"facts-1\""), std::string::npos);
  EXPECT_EQ(page.find("id=\"facts-2\""), std::string::npos);
  EXPECT_TRUE(fs::exists(at("out/a/cloud.ply")));
  EXPECT_TRUE(fs::exists(at("out/b/cloud.ply")));
  EXPECT_FALSE(fs::exists(at("out/a/segment.html")));
}

/// The points of a .ply file of cairn, each with its stored colour; of a whole cloud only those of objects,
/// by id.
std::map<std::int32_t, std::vector<std::string>> points_by_object(const std::string& ply) {
  constexpr std::size_t kPoint = 15;  // bytes: three floats, three colours
  const std::size_t end = ply.find("end_header\n") + 11;
  const std::size_t vertex = ply.find("property int object") < end ? kPoint + 4 : kPoint;
  std::map<std::int32_t, std::vector<std::string>> points;
  for (std::size_t at = end; at + vertex <= ply.size(); at += vertex) {
    std::int32_t object = -1;  // for a file without ids
    if (vertex > kPoint) std::memcpy(&object, ply.data() + at + kPoint, sizeof object);
    if (object != 0) points[object].push_back(ply.substr(at, kPoint));
  }
  return points;
}

TEST_F(PageAndCloudTest, CloudsOfObjectsPartitionTheLabelledPointsOfTheWhole) {
  const std::string in = samples::folder("four_in_a_row").string();
  ASSERT_EQ(run({"segment", in, "--ply", "--ply-objects", "-o", path("out")}).code, 0);
  const auto whole = points_by_object(content(at("out/cloud.ply")));
  ASSERT_GE(whole.size(), 2U);
  for (const auto& [object, points] : whole) {
    const auto own = points_by_object(content(at("out/objects") / (std::to_string(object) + ".ply")));
    ASSERT_EQ(own.size(), 1U) << object;
    EXPECT_EQ(own.at(-1), points) << object;
  }
  const auto files = std::distance(fs::directory_iterator(at("out/objects")), fs::directory_iterator());
  EXPECT_EQ(static_cast<std::size_t>(files), output::load_confidences(at("out/objects.json")).size());
}

TEST_F(PageAndCloudTest, CloudsOfObjectsOfAnOlderResultAreRemovedAndOtherFilesStay) {
  const std::string in = samples::folder("four_in_a_row").string();
  ASSERT_EQ(run({"segment", in, "--ply-objects", "-o", path("out")}).code, 0);
  EXPECT_FALSE(fs::exists(at("out/cloud.ply")));
  const auto before = everything();
  write(at("out/objects/900.ply"), "of an older result");
  ASSERT_EQ(run({"segment", in, "--ply-objects", "-o", path("out")}).code, 0);
  EXPECT_EQ(everything(), before);
  write(at("out/objects/chair.ply"), "mine");
  ASSERT_EQ(run({"segment", in, "-o", path("out")}).code, 0);
  EXPECT_EQ(content(at("out/objects/chair.ply")), "mine");
  EXPECT_FALSE(fs::exists(at("out/objects/1.ply")));
  fs::remove(at("out/objects/chair.ply"));
  ASSERT_EQ(run({"segment", in, "--ply-objects", "-o", path("out")}).code, 0);
  ASSERT_EQ(run({"segment", in, "-o", path("out")}).code, 0);
  EXPECT_FALSE(fs::exists(at("out/objects")));
}

TEST_F(PageAndCloudTest, CloudsOfObjectsNeedAFolderOfTheirOwn) {
  const std::string in = samples::folder("four_in_a_row").string();
  ASSERT_EQ(run({"segment", in, "-o", path("out")}).code, 0);
  write(at("out/objects"), "a file");
  refuses({"segment", in, "--ply-objects", "-o", path("out")},
          {path("out/objects"), "is a file, expected a folder"});
  write(at("file"), "");
  refuses({"segment", in, "--ply-objects", "-o", path("file")},
          {path("file"), "is a file, expected a folder"});
  ASSERT_EQ(run({"segment", in, "-o", path("out")}).code, 0);
  EXPECT_EQ(content(at("out/objects")), "a file");
}

TEST_F(PageAndCloudTest, APageHasTheRightImageIfOneWasMatched) {
  pair_in("frame");
  write(at("given.pfm"), pfm({96, 72}, std::vector<float>(96 * 72, 6.0F)));
  ASSERT_EQ(run({"segment", path("frame"), "--html", "-o", path("matched")}).code, 0);
  ASSERT_EQ(
      run({"segment", path("frame"), "--disparity", path("given.pfm"), "--html", "-o", path("given")}).code,
      0);
  EXPECT_NE(content(at("matched/segment.html")).find(R"("right":"data:image/jpeg)"), std::string::npos);
  EXPECT_NE(content(at("given/segment.html")).find(R"("right":"")"), std::string::npos);
}

TEST_F(PageAndCloudTest, ANewResultRemovesOlderOnes) {
  pair_in("frame");
  write(at("frame") / "calib.txt", kCalibration);
  ASSERT_EQ(run({"segment", path("frame"), "--html", "--ply", "-o", path("out")}).code, 0);
  ASSERT_EQ(run({"segment", path("frame"), "-o", path("out")}).code, 0);
  EXPECT_FALSE(fs::exists(at("out") / "segment.html"));
  EXPECT_FALSE(fs::exists(at("out") / "cloud.ply"));
  EXPECT_TRUE(fs::exists(at("out") / "objects.json"));
}

TEST_F(PageAndCloudTest, BothNeedAFolderToWriteInto) {
  pair_in("frame");
  refuses({"segment", path("frame"), "--html"}, {"--html", "-o DIR"});
  refuses({"segment", path("frame"), "--ply"}, {"--ply", "-o DIR"});
  refuses({"segment", path("frame"), "--ply-objects"}, {"--ply-objects", "-o DIR"});
}

TEST_F(PageAndCloudTest, ACloudNeedsACalibration) {
  const auto pair = pair_in("frame");
  for (const char* flag : {"--ply", "--ply-objects"})
    refuses({"segment", path("frame"), flag, "-o", path("out")}, {flag, "left.png", "--calib"});
  refuses(with("disparity", pair, {"--ply", path("cloud.ply")}), {"--ply", "--calib"});
}

TEST_F(PageAndCloudTest, DisparityWritesACloudWithoutObjects) {
  const auto pair = pair_in("frame");
  write(at("frame") / "calib.txt", kCalibration);
  refuses(with("disparity", pair, {"--ply", path("cloud.pcd")}), {"cloud.pcd", ".ply"});
  ASSERT_EQ(run(with("disparity", pair, {"--ply", path("cloud.ply")})).code, 0);
  const std::string cloud = content(at("cloud.ply"));
  EXPECT_TRUE(cloud.starts_with("ply\n"));
  EXPECT_EQ(cloud.find("object"), std::string::npos);
}

TEST_F(PageAndCloudTest, EvaluateWritesAPageOfIncompleteResults) {
  pair_in("frame");
  ASSERT_EQ(
      run({"segment", path("frame"), "--set", "match.num_disparities=16", "-o", path("out/frame")}).code, 0);
  // No image next to the truth, and a result of which only the disparity is left.
  fs::create_directories(at("truth/frame"));
  write(at("truth/frame") / "disp_left.pfm", pfm({96, 72}, std::vector<float>(96 * 72, 6.0F)));
  ASSERT_EQ(run({"evaluate", path("out"), path("truth"), "--html", path("new/page")}).code, 0);
  EXPECT_TRUE(content(at("new/page") / "evaluation.html").starts_with("<!doctype html>"));
  write(at("out/frame") / "objects.json", R"({"timings_ms": {}, "objects": [7]})");
  refuses({"evaluate", path("out"), path("truth"), "--html", path("other")}, {"objects.json"});
  for (const char* lost : {"objects.json", "objects.png", "reject.png", "confidence.png", "space.png"}) {
    fs::remove(at("out/frame") / lost);
  }
  EXPECT_EQ(run({"evaluate", path("out"), path("truth"), "--html", path("new/page")}).code, 0);
}

TEST_F(PageAndCloudTest, ReasonsOfEightBitsAreReadAsEarlierVersionsWroteThem) {
  pair_in("frame");
  ASSERT_EQ(
      run({"segment", path("frame"), "--set", "match.num_disparities=16", "-o", path("out/frame")}).code, 0);
  fs::create_directories(at("truth/frame"));
  write(at("truth/frame") / "disp_left.pfm", pfm({96, 72}, std::vector<float>(96 * 72, 6.0F)));
  ASSERT_EQ(run({"evaluate", path("out"), path("truth"), "--html", path("now")}).code, 0);
  const io::Labels wide = io::load_labels(at("out/frame/reject.png"));
  EXPECT_EQ(wide.bits, 16);
  Image<std::uint8_t> narrow(wide.ids.size());
  for (int y = 0; y < narrow.height(); ++y) {
    for (int x = 0; x < narrow.width(); ++x) narrow(x, y) = static_cast<std::uint8_t>(wide.ids(x, y));
  }
  io::save_png(at("out/frame/reject.png"), View<const std::uint8_t>(narrow));
  ASSERT_EQ(run({"evaluate", path("out"), path("truth"), "--html", path("earlier")}).code, 0);
  EXPECT_EQ(content(at("earlier/evaluation.html")), content(at("now/evaluation.html")));
}

TEST_F(PageAndCloudTest, EvaluateWritesNoPageOfMapsOfDifferentSizes) {
  pair_in("frame");
  ASSERT_EQ(
      run({"segment", path("frame"), "--set", "match.num_disparities=16", "-o", path("out/frame")}).code, 0);
  fs::create_directories(at("truth/frame"));
  write(at("truth/frame") / "disp_left.pfm", pfm({96, 72}, std::vector<float>(96 * 72, 6.0F)));
  pair_in("other", {50, 40});
  fs::copy_file(at("other/left.png"), at("truth/frame/left.png"));
  refuses({"evaluate", path("out"), path("truth"), "--html", path("page")}, {"left.png", "50x40", "96x72"});
  EXPECT_EQ(run({"evaluate", path("out"), path("truth")}).code, 0);
  refuses({"evaluate", path("out"), path("truth"), "--html", path("other/left.png")}, {"left.png"});
}

}  // namespace
}  // namespace cairn::command
