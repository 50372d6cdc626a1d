// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/io/disparity_files.hpp>
#include <nlohmann/json.hpp>

#include "command.hpp"

namespace cairn::command {
namespace {

using Json = nlohmann::json;

class Bench : public CommandTest {
 protected:
  /// The --json output of a run that must succeed.
  [[nodiscard]] Json measured(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "bench");
    arguments.insert(arguments.end(), {"--json", path("bench.json")});
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    return Json::parse(content(at("bench.json")), nullptr, false);
  }
};

std::vector<std::string> names_of(const Json& list) {
  std::vector<std::string> names;
  for (const Json& entry : list) names.push_back(entry.at("name"));
  return names;
}

TEST_F(Bench, RendersAPairIfNoneIsGivenAndSaysSo) {
  const auto before = everything();
  const Outcome outcome = run({"bench", "--size", "160x120", "--frames", "2", "--no-opencv"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  for (const char* words :
       {"rendered room, 160x120", "median ms", "p99 ms", "match", "frames per second", "image buffers",
        "supported: scalar", "bad-2", "2 frames after a warm-up frame"}) {
    EXPECT_NE(outcome.out.find(words), std::string::npos) << words << "\n" << outcome.out;
  }
  EXPECT_EQ(everything(), before);
}

TEST_F(Bench, BudgetFindsSizesThatReachARate) {
  const Json all = measured({"--size", "160x120", "--budget", "0.1", "--threads", "1"});
  ASSERT_EQ(all.at("trials").size(), 2U) << "the full size is fast enough";
  EXPECT_EQ(all.at("trials")[0].at("preset"), "default");
  EXPECT_EQ(all.at("trials")[1].at("preset"), "paper");
  for (const Json& trial : all.at("trials")) {
    EXPECT_EQ(trial.at("width"), 160);
    EXPECT_EQ(trial.at("is_within"), true);
    EXPECT_GT(trial.at("median_ms"), 0);
    EXPECT_LE(trial.at("median_ms"), trial.at("p99_ms"));
  }
  const Json none = measured({"--size", "96x72", "--budget", "10000", "--set", "match.num_disparities=40"});
  ASSERT_EQ(none.at("trials").size(), 6U)
      << "two presets at 1, 3/4 and 1/2 of the size; smaller ones are not tried";
  EXPECT_EQ(none.at("trials")[1].at("height"), 54);
  EXPECT_EQ(none.at("trials")[1].at("num_disparities"), 30);
  EXPECT_EQ(none.at("trials")[5].at("is_within"), false);
  const Outcome outcome = run({"bench", "--size", "64x48", "--budget", "0.1"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("default: 64x48 with 64 disparities"), std::string::npos) << outcome.out;
}

TEST_F(Bench, JsonListsEveryStageInOrderWithItsTimes) {
  const Json found = measured({"--size", "160x120", "--frames", "4", "--threads", "1", "--no-opencv"});
  EXPECT_EQ(found.at("frames"), 4);
  EXPECT_EQ(found.at("pair").at("drawn"), true);
  EXPECT_EQ(found.at("pair").at("width"), 160);
  EXPECT_EQ(found.at("machine").at("threads"), 1);
  EXPECT_EQ(found.at("config").at("match").at("num_disparities"), 64);
  EXPECT_TRUE(found.at("opencv").is_null());

  const std::vector<std::string> names = names_of(found.at("stages"));
  const auto position = [&](const char* name) { return std::find(names.begin(), names.end(), name); };
  EXPECT_LT(position("match"), position("fit_ground"));
  EXPECT_LT(position("fit_ground"), position("measure"));
  ASSERT_NE(position("measure"), names.end());
  for (const char* costly : {"noise_sigma", "fit_background", "cut_superpixels", "hint_objects",
                             "grow_merge_tree", "choose_objects"})
    EXPECT_LT(position(costly), position("measure")) << costly;
  EXPECT_EQ(position("fuse"), names.end()) << "the hierarchy does not need it";
  double disparity_ms = 0;
  for (const Json& stage : found.at("stages")) {
    const Json& wall = stage.at("wall_ms");
    EXPECT_LE(wall.at("least"), wall.at("median")) << stage;
    EXPECT_LE(wall.at("median"), wall.at("p99")) << stage;
    EXPECT_LE(wall.at("median"), found.at("frame").at("wall_ms").at("p99")) << stage;
    if (stage.at("for_disparity").get<bool>()) disparity_ms += wall.at("least").get<double>();
  }
  EXPECT_GT(disparity_ms, 0);
  EXPECT_LE(disparity_ms, found.at("disparity").at("wall_ms").at("least").get<double>() + 1e-3);
  EXPECT_LT(found.at("disparity").at("wall_ms").at("least"), found.at("frame").at("wall_ms").at("least"));
  EXPECT_GT(found.at("memory").at("pool_bytes"), 160 * 120);
  EXPECT_GT(found.at("memory").at("first_frame_allocations"), 0);
  EXPECT_EQ(found.at("memory").at("later_allocations"), 0);
}

TEST_F(Bench, AReportHoldsBothPresetsAtThreeSizes) {
  const Outcome outcome =
      run({"bench", "--report", path("board.json"), "--frames", "1", "--no-opencv", "--threads", "1"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const Json found = Json::parse(content(at("board.json")), nullptr, false);
  ASSERT_EQ(found.at("runs").size(), 6U);
  EXPECT_EQ(found.at("runs").at(5).at("preset"), "paper");
  EXPECT_EQ(found.at("runs").at(5).at("pair").at("width"), 1280);
  EXPECT_GT(found.at("runs").at(0).at("frame").at("wall_ms").at("median"), 0);
}

TEST_F(Bench, FramesOverlapWithSeveralThreads) {
  const Json found = measured({"--size", "160x120", "--frames", "3", "--no-opencv", "--threads", "2"});
  EXPECT_GT(found.at("overlapping").at("frames_per_second"), 0);
  EXPECT_GT(found.at("overlapping").at("pool_bytes"), found.at("memory").at("pool_bytes"));
  EXPECT_FALSE(measured({"--size", "160x120", "--frames", "2", "--no-opencv", "--threads", "1"})
                   .contains("overlapping"));
}

TEST_F(Bench, StagesNeededOnlyForObjectsAreNotCountedAsDisparity) {
  const Json found = measured({"--size", "160x120", "--frames", "1", "--no-opencv", "--preset", "paper"});
  int seen = 0;
  for (const Json& stage : found.at("stages")) {
    const std::string name = stage.at("name");
    const bool matching = name == "match" || name == "reject_speckles";
    if (!matching && name != "segment_intensity" && name != "fuse") continue;
    EXPECT_EQ(stage.at("for_disparity"), matching) << name;
    ++seen;
  }
  EXPECT_EQ(seen, 4);
}

TEST_F(Bench, EvaluatesOursAndOpenCvsMatchersGivenTruth) {
  const auto pair = pair_in("pair", {160, 72});
  const Image<float> truth({160, 72}, 6.0F, {});
  io::save_disparity(at("truth.pfm"), truth);
  const Json found = measured(with(pair[0], {pair[1], "--truth", path("truth.pfm"), "--frames", "1", "--set",
                                             "match.num_disparities=32"}));
  EXPECT_EQ(found.at("accuracy").at("from_column"), 32);
  EXPECT_EQ(found.at("accuracy").at("both_cameras"), false);
  const Json& rows = found.at("accuracy").at("matchers");
  EXPECT_EQ(rows.at(0).at("name"), "cairn");
  // Random dots of one disparity: every matcher that finds a match is correct.
  for (const Json& row : rows) {
    EXPECT_EQ(row.at("known_px"), (160 - 32) * 72);
    EXPECT_GT(row.at("density"), 0.5) << row;
    EXPECT_LT(row.at("bad_of_matched").at("1"), 0.05) << row;
  }
  if (found.at("opencv").is_null()) {
    EXPECT_EQ(rows.size(), 1U);
    GTEST_SKIP() << "OpenCV's matchers are not built in";
  }
  EXPECT_EQ(rows.size(), 4U);
  for (const Json& matcher : found.at("opencv").at("matchers")) {
    EXPECT_TRUE(matcher.at("refusal").is_null()) << matcher;
    EXPECT_GT(matcher.at("wall_ms").at("median"), 0) << matcher;
  }
}

TEST_F(Bench, ReadsAFolderWithItsTruthAndExcludesHiddenPixels) {
  pair_in("pair", {160, 72});
  const Image<float> truth({160, 72}, 6.0F, {});
  io::save_disparity(at("pair/disp_left.png"), truth);
  Image<std::uint8_t> occlusion({160, 72}, std::uint8_t{0}, {});
  std::fill_n(occlusion.row(10) + 150, 10, std::uint8_t{255});
  io::save_png(at("pair/occlusion.png"), View<const std::uint8_t>(occlusion));
  const Json found = measured({path("pair"), "--truth", path("pair"), "--frames", "1", "--no-opencv"});
  EXPECT_EQ(found.at("accuracy").at("both_cameras"), true);
  EXPECT_EQ(found.at("accuracy").at("matchers").at(0).at("known_px"), (160 - 64) * 72 - 10);
}

TEST_F(Bench, SaysWhyOpenCvCannotMatchThePair) {
  const Outcome outcome = run({"bench", "--size", "70x40", "--frames", "1"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_TRUE(outcome.out.find("StereoBM cannot match this pair") != std::string::npos ||
              outcome.out.find("not built in") != std::string::npos)
      << outcome.out;
}

TEST_F(Bench, StopsWhenTheTimeIsUp) {
  const Json found =
      measured({"--size", "64x48", "--seconds", "0", "--set", "match.num_disparities=16", "--no-opencv"});
  EXPECT_EQ(found.at("frames"), 3);
}

TEST_F(Bench, RefusesContradictoryArguments) {
  const auto pair = pair_in("pair");
  write(at("small.pfm"), pfm({2, 1}, {1, 2}));
  pair_in("many/a");
  pair_in("many/b");
  refuses({"bench", "--size", "640"}, {"--size 640", "640x480"});
  refuses({"bench", "--size", "9x9999"}, {"--size 9x9999", "16 to 8192"});
  refuses({"bench", "--size", "20x20x20"}, {"--size 20x20x20"});
  refuses(with("bench", pair, {"--size", "64x64"}), {"--size 64x64", "LEFT"});
  refuses({"bench", "--truth", path("small.pfm")}, {"--truth", "LEFT"});
  refuses({"bench", "--calib", path("none.txt")}, {"--calib", "LEFT"});
  refuses(with("bench", pair, {"--truth", path("small.pfm")}), {"small.pfm", "2x1", "96x72"});
  refuses(with("bench", pair, {"--truth", path("none.pfm")}), {"none.pfm"});
  refuses({"bench", path("many")}, {"2 frames", "one"});
  refuses({"bench", pair[0]}, {"left.png", "right"});
  refuses({"bench", ""}, {"LEFT", "empty"});
  refuses(with("bench", pair, {"--budget", "10"}), {"--budget", "LEFT"});
  refuses({"bench", "--budget", "0"}, {"--budget"});
  refuses(with("bench", pair, {"--report", path("a.json")}), {"--report", "LEFT"});
  refuses({"bench", "--report", path("a.json"), "--preset", "paper"}, {"--report", "--preset"});
  refuses({"bench", "--report", path("a.json"), "--size", "64x48"}, {"--report", "--size"});
  refuses({"bench", "--frames", "0"}, {"--frames"});
  refuses({"bench", "--seconds", "-1"}, {"--seconds"});
  refuses({"bench", "--set", "match.no_such=1"}, {"match.no_such"});
  refuses({"bench", "--no-opencb"}, {"--no-opencv"});
  refuses({"bench", "--size", "32x32", "--frames", "1"}, {"match.num_disparities"});
  refuses({"bench", "--size", "96x72", "--frames", "1", "--json", path("no/such/folder/x.json")}, {"x.json"});
}

}  // namespace
}  // namespace cairn::command
