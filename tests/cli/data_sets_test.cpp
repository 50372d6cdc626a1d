// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <nlohmann/json.hpp>

#include "command.hpp"

/// Data sets in their downloaded layout, in miniature: from folders to evaluated results.
namespace cairn::command {
namespace {

using Json = nlohmann::json;

class DataSets : public CommandTest {
 protected:
  /// The pair of random dots under other names.
  void pair_as(const std::string& left, const std::string& right) const {
    const auto pair = pair_in("pair");
    for (const auto& [from, to] : {std::pair{pair[0], left}, {pair[1], right}}) {
      fs::create_directories(at(to).parent_path());
      fs::copy_file(from, at(to));
    }
  }
  /// stamp_ns in objects.json of this frame in out/.
  [[nodiscard]] Json stamp_of(const std::string& frame) const {
    return Json::parse(content(at("out/" + frame + "/objects.json"))).at("stamp_ns");
  }
  [[nodiscard]] double baseline_of(const std::string& result) const {
    return Json::parse(content(at(result + "/objects.json"))).at("rig").at("baseline_m").get<double>();
  }
};

constexpr const char* kProjections =
    "P0: 700 0 48 0 0 700 36 0 0 0 1 0\nP1: 700 0 48 -350 0 700 36 0 0 0 1 0\n"
    "P2: 700 0 48 0 0 700 36 0 0 0 1 0\nP3: 700 0 48 -420 0 700 36 0 0 0 1 0\n";

TEST_F(DataSets, KittiIsSegmentedAndEvaluated) {
  pair_as("training/image_2/000000_10.png", "training/image_3/000000_10.png");
  fs::copy(at("training/image_2/000000_10.png"), at("training/image_2/000003_10.png"));
  fs::copy(at("training/image_3/000000_10.png"), at("training/image_3/000003_10.png"));
  for (const char* name : {"calib_cam_to_cam", "disp_occ_0", "disp_noc_0"})
    fs::create_directories(at("training") / name);
  write(at("training/calib_cam_to_cam/000000.txt"), kProjections);
  Image<std::uint16_t> truth({96, 72}, 6 * 256, {});
  io::save_png(at("training/disp_occ_0/000000_10.png"), truth.view());
  for (int y = 0; y < 72; ++y) std::fill_n(truth.row(y), 16, std::uint16_t{0});
  io::save_png(at("training/disp_noc_0/000000_10.png"), truth.view());

  ASSERT_EQ(run({"segment", path("training"), "-o", path("out")}).code, 0);
  EXPECT_NEAR(baseline_of("out/000000_10"), 0.6, 1e-6);
  EXPECT_TRUE(Json::parse(content(at("out/000003_10/objects.json"))).at("rig").is_null());
  const Outcome outcome = run({"evaluate", path("out"), path("training"), "--html", path("page")});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("no truth            1 frame of the results: 000003_10"), std::string::npos)
      << outcome.out;
  EXPECT_NE(outcome.out.find("of 5760 pixels"), std::string::npos) << outcome.out;  // both cameras see
  EXPECT_NE(outcome.out.find("of 6912 pixels"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("bad-1 0.0 %"), std::string::npos) << outcome.out;

  ASSERT_EQ(run({"doctor", path("training")}).err, "");
  fs::remove(at("training/image_2/000003_10.png"));
  EXPECT_EQ(run({"tune", path("training"), "--truth", "--evaluations", "1", "-o", path("tuned.yaml")}).code,
            0);
  EXPECT_EQ(run({"disparity", path("training"), "-o", path("d.png")}).code, 0);
  EXPECT_EQ(run({"bench", path("training"), "--frames", "1", "--no-opencv", "--truth",
                 path("training/disp_occ_0/000000_10.png")})
                .code,
            0);
}

TEST_F(DataSets, KittisGreyCamerasHaveTheirOwnBaseline) {
  pair_as("00/image_0/000000.png", "00/image_1/000000.png");
  write(at("00/calib.txt"), kProjections);
  ASSERT_EQ(run({"segment", path("00"), "-o", path("out")}).code, 0);
  EXPECT_NEAR(baseline_of("out"), 0.5, 1e-6);
}

TEST_F(DataSets, MiddleburyIsSegmentedAndEvaluated) {
  pair_as("Motorcycle/im0.png", "Motorcycle/im1.png");
  write(at("Motorcycle/calib.txt"),
        "cam0=[100 0 48; 0 100 36; 0 0 1]\ncam1=[100 0 50; 0 100 36; 0 0 1]\ndoffs=2\nbaseline=193\n"
        "width=96\nheight=72\nndisp=16\nisint=0\nvmin=3\nvmax=12\ndyavg=0\ndymax=0\n");
  write(at("Motorcycle/disp0.pfm"), pfm({96, 72}, std::vector<float>(96 * 72, 6.0F)));
  ASSERT_EQ(run({"segment", path("Motorcycle"), "-o", path("out")}).code, 0);
  EXPECT_NEAR(baseline_of("out"), 0.193, 1e-6);
  const Outcome outcome = run({"evaluate", path("out"), path("Motorcycle")});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("bad-2 0.0 %"), std::string::npos) << outcome.out;
}

TEST_F(DataSets, ReportsMissingFilesInOneLine) {
  pair_as("training/image_2/000000_10.png", "elsewhere/image_3/000000_10.png");
  fs::copy(at("training/image_2/000000_10.png"), at("training/image_2/000001_10.png"));
  refuses({"segment", path("training")}, {"image_2/000000_10.png", "expected", "image_3/000000_10.png"});
  pair_as("Art/view1.png", "elsewhere/view5.png");
  refuses({"segment", path("Art")}, {"view1.png", "expected", "view5.png"});
  pair_as("MH_01/mav0/cam0/data/14.png", "MH_01/mav0/cam1/data/14.png");
  for (const char* command : {"segment", "disparity", "doctor", "bench", "tune"})
    refuses({command, path("MH_01")}, {"EuRoC", "raw", "cairn rectify", "mav0/cam0/sensor.yaml"});
}

TEST_F(DataSets, EurocIsRectifiedByItsSensors) {
  pair_as("mav0/cam0/data/14.png", "mav0/cam1/data/14.png");
  for (const auto& [camera, place] : {std::pair{"cam0", "0"}, {"cam1", "0.11"}}) {
    write(at("mav0") / camera / "sensor.yaml",
          std::string("sensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [1, 0, 0, ") + place +
              ", 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\nresolution: [96, 72]\ncamera_model: pinhole\n"
              "intrinsics: [100, 100, 48, 36]\ndistortion_model: radial-tangential\n"
              "distortion_coefficients: [0, 0, 0, 0]\n");
  }
  const Outcome outcome =
      run({"rectify", path("mav0"), "--calib", path("mav0/cam0/sensor.yaml"), "-o", path("out")});
  if (outcome.err.find("not built in") != std::string::npos) GTEST_SKIP() << outcome.err;
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(content(at("out/calib.txt")).find("baseline=0.11"), std::string::npos);
  EXPECT_EQ(run({"segment", path("out")}).code, 0);
}

TEST_F(DataSets, StampsOfAFolderAreInItsResults) {
  for (const std::string name : {"9", "10", "11"})
    pair_as("frames/" + name + "/left.png", "frames/" + name + "/right.png");
  ASSERT_EQ(run({"segment", path("frames"), "-o", path("out")}).code, 0);
  EXPECT_TRUE(stamp_of("9").is_null());
  write(at("frames/times.txt"), "1.5\n1.75\n1403715274.312143104\n");  // in natural order
  const Outcome outcome = run({"segment", path("frames"), "-o", path("out")});
  EXPECT_EQ(outcome.err.find("times.txt"), std::string::npos) << outcome.err;
  EXPECT_EQ(stamp_of("9"), 1'500'000'000);
  EXPECT_EQ(stamp_of("10"), 1'750'000'000);
  EXPECT_EQ(stamp_of("11"), 1'403'715'274'312'143'104);
}

TEST_F(DataSets, StampsThatDoNotFitAreReportedAndIgnored) {
  for (const std::string name : {"a", "b"})
    pair_as("frames/" + name + "/left.png", "frames/" + name + "/right.png");
  for (const auto& [stamps, word] : {std::pair{"1.5\n", "has 1 stamps"},
                                     {"1403715274\n1403715275\n", "less than 1 us"},
                                     {"2.5\nsoon\n", "times.txt:2"}}) {
    write(at("frames/times.txt"), stamps);
    const Outcome outcome = run({"segment", path("frames"), "-o", path("out")});
    EXPECT_EQ(outcome.code, 0) << stamps;
    EXPECT_TRUE(outcome.err.starts_with("cairn: " + path("frames/times.txt"))) << outcome.err;
    EXPECT_NE(outcome.err.find(word), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("; the results have no stamps\n"), std::string::npos) << outcome.err;
    EXPECT_TRUE(stamp_of("a").is_null()) << stamps;
  }
  // A clock that is set back says nothing against single frames.
  write(at("frames/times.txt"), "2.5\n1.5\n");
  const Outcome outcome = run({"segment", path("frames"), "-o", path("out")});
  EXPECT_EQ(outcome.err.find("times.txt"), std::string::npos) << outcome.err;
  EXPECT_EQ(stamp_of("a"), 2'500'000'000);
  EXPECT_EQ(stamp_of("b"), 1'500'000'000);
}

TEST_F(DataSets, StampsFromImageNamesAreInTheResults) {
  for (const std::string name : {"1403636579763555584", "1403636579813555456"}) {
    pair_as("kitti/image_2/" + name + ".png", "kitti/image_3/" + name + ".png");
    pair_as("folders/left/" + name + ".png", "folders/right/" + name + ".png");
    pair_as("frames/" + name + "/left.png", "frames/" + name + "/right.png");
  }
  pair_as("counted/0000000000000007/left.png", "counted/0000000000000007/right.png");
  for (const std::string in : {"kitti", "folders", "frames"}) {
    ASSERT_EQ(run({"segment", path(in), "-o", path("out")}).code, 0) << in;
    EXPECT_EQ(stamp_of("1403636579763555584"), 1'403'636'579'763'555'584) << in;
    EXPECT_EQ(stamp_of("1403636579813555456"), 1'403'636'579'813'555'456) << in;
  }
  ASSERT_EQ(run({"segment", path("counted"), "-o", path("out")}).code, 0);
  EXPECT_TRUE(stamp_of("0000000000000007").is_null());
}

}  // namespace
}  // namespace cairn::command
