// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/io/config_files.hpp>
#include <cairn/io/disparity_files.hpp>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "command.hpp"

namespace cairn::command {
namespace {

using Json = nlohmann::json;

class Tune : public CommandTest {
 protected:
  static std::string samples() { return std::string(CAIRN_SOURCE_DIR) + "/data/samples"; }
  /// `tune FOLDER … --budget 10m -o tuned.yaml --json found.json`: the number of evaluations ends it,
  /// independent of the machine's speed.
  [[nodiscard]] Outcome tune(const std::string& folder, const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{
        "tune", folder, "--budget", "10m", "-o", path("tuned.yaml"), "--json", path("found.json")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }
  [[nodiscard]] Json found() const { return Json::parse(content(at("found.json"))); }
  [[nodiscard]] Config tuned() const {
    Config config;
    io::load_config(at("tuned.yaml"), config);
    return config;
  }
};

TEST_F(Tune, WritesAConfigThatIsReadBackAndATableOfBeforeAndAfter) {
  const Outcome outcome = tune(samples(), {"--truth", "--options", "objects.min_confidence,superpixels.*",
                                           "--evaluations", "8", "--set", "objects.min_confidence=0.9"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");  // no progress bar without a terminal
  for (const char* words :
       {"before", "after", "mean E", "found, IoU >= 0.5", "8 evaluations", "4 frames", "tuned.yaml"})
    EXPECT_NE(outcome.out.find(words), std::string::npos) << words << "\n" << outcome.out;

  const Json j = found();
  EXPECT_EQ(j.at("goal"), "objects");
  EXPECT_EQ(j.at("end"), "evaluations");
  EXPECT_EQ(j.at("evaluations"), 8);
  EXPECT_TRUE(j.at("held_out").is_null());
  const Json& loss = j.at("tuned_on").at("loss");
  EXPECT_LE(loss.at("after"), loss.at("before"));
  const Config config = tuned();
  const std::string least = j.at("found").contains("objects.min_confidence") && j.at("kept_because").is_null()
                                ? j.at("found").at("objects.min_confidence").at("after")
                                : "0.9";
  EXPECT_FLOAT_EQ(config.objects.min_confidence, std::stof(least));
  EXPECT_EQ(config.match.num_disparities, Config{}.match.num_disparities);
  EXPECT_EQ(content(at("tuned.yaml")).find("num_disparities"), std::string::npos)
      << "would undo what each frame's calibration says";
}

TEST_F(Tune, RepairsABadOption) {
  const Outcome outcome = tune(samples(), {"--truth", "--options", "objects.min_area,superpixels.count",
                                           "--evaluations", "12", "--set", "objects.min_area=10"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Json j = found();
  EXPECT_TRUE(j.at("kept_because").is_null()) << j;
  EXPECT_LT(j.at("tuned_on").at("loss").at("after"), j.at("tuned_on").at("loss").at("before")) << j;
  EXPECT_LT(tuned().objects.min_area, 9.0F);
}

TEST_F(Tune, ReportsTheLossThatEvaluateMeasuresWithItsConfig) {
  ASSERT_EQ(tune(samples(), {"--truth", "--options", "objects.min_confidence,left_right.max_diff",
                             "--evaluations", "6", "--set", "objects.min_confidence=0.9"})
                .code,
            0);
  ASSERT_EQ(run({"segment", samples(), "--config", path("tuned.yaml"), "-o", path("out")}).code, 0);
  ASSERT_EQ(run({"evaluate", path("out"), samples(), "--json", path("evaluation.json")}).code, 0);
  const Json measured = Json::parse(content(at("evaluation.json"))).at("summary").at("objects");
  const Json j = found();
  const char* const which = j.at("kept_because").is_null() ? "after" : "before";
  EXPECT_NEAR(measured.at("mean_error").get<double>(), j.at("tuned_on").at("loss").at(which).get<double>(),
              1e-9);
  EXPECT_NEAR(measured.at("recall_50").get<double>(),
              j.at("tuned_on").at("recall_50").at(which).get<double>(), 1e-9);
}

TEST_F(Tune, TheSameNumberOfEvaluationsGivesTheSameFileOnAnyNumberOfThreads) {
  std::vector<std::string> files;
  for (const char* threads : {"1", "3"}) {
    ASSERT_EQ(
        tune(samples(), {"--truth", "--options", "superpixels.*", "--evaluations", "6", "--threads", threads})
            .code,
        0);
    files.push_back(content(at("tuned.yaml")) + found().at("tuned_on").dump());
  }
  EXPECT_EQ(files[0], files[1]);
}

TEST_F(Tune, RepairsUnsteadyObjectsOfASequenceWithoutTruth) {
  for (int i = 0; i < 10; ++i) {
    const fs::path frame = at("in/" + std::to_string(i));
    fs::create_directories(frame);
    for (const char* file : {"left.png", "right.png", "calib.txt"})
      fs::copy_file(fs::path(samples()) / "four_in_a_row" / file, frame / file);
  }
  const Outcome outcome =
      run({"tune", path("in"), "--sequence", "--budget", "10m", "--evaluations", "6", "--holdout", "0",
           "--set", "objects.min_area=4", "--options", "objects.min_area", "-o", path("tuned.yaml")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("steadiness: 0"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("  objects.min_area: 4 -> "), std::string::npos) << outcome.out;
  EXPECT_LT(tuned().objects.min_area, 2.9F);  // the smaller object covers 2.9 %

  // A range beyond the width of 320 px is refused.
  const Outcome wide =
      run({"tune", path("in"), "--sequence", "--budget", "10m", "--evaluations", "4", "--set",
           "match.num_disparities=256", "--options", "match.num_disparities", "-o", path("wide.yaml")});
  EXPECT_EQ(wide.code, 0) << wide.err;

  for (int i = 2; i < 10; ++i) fs::remove_all(at("in/" + std::to_string(i)));
  refuses({"tune", path("in"), "--sequence", "-o", path("new.yaml")}, {"has 2 frames"});
  refuses({"tune", path("in"), "--sequence", "--json", path("found.json"), "-o", path("new.yaml")},
          {"--json", "--sequence"});
  EXPECT_FALSE(fs::exists(at("new.yaml")));
}

TEST_F(Tune, HoldsOutTheRequestedShareAndEvaluatesIt) {
  ASSERT_EQ(
      tune(samples(), {"--truth", "--options", "superpixels.count", "--evaluations", "3", "--holdout", "0.5"})
          .code,
      0);
  const Json j = found();
  EXPECT_EQ(j.at("held_out").at("frames"), 2);
  EXPECT_EQ(j.at("held_out_frames").size(), 2U);
  EXPECT_EQ(j.at("tuned_on").at("frames"), 2);
  EXPECT_GT(j.at("held_out").at("loss").at("before"), 0);
}

TEST_F(Tune, HoldsOutAQuarterOfEightFramesAndReportsTheUncertainty) {
  for (const char* name : {"a", "b", "c", "d", "e", "f", "g", "h"}) pair_in(std::string("frames/") + name);
  const std::vector<std::string> fast{
      "--options", "left_right.max_diff",      "--evaluations", "2",
      "--set",     "match.num_disparities=16", "--set",         "left_right.max_diff=-1"};
  const Outcome outcome = tune(path("frames"), fast);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Json j = found();
  EXPECT_EQ(j.at("held_out").at("frames"), 2);
  EXPECT_NE(outcome.out.find("\ngain, tuned on:  "), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("\ngain, held out:  "), std::string::npos) << outcome.out;
  EXPECT_LE(j.at("gain").at("held_out").at("low"), j.at("gain").at("held_out").at("mean"));
  EXPECT_NEAR(j.at("gain").at("tuned_on").at("mean").get<double>(),
              j.at("tuned_on").at("loss").at("before").get<double>() -
                  j.at("tuned_on").at("loss").at("after").get<double>(),
              1e-12);
  const Outcome none = tune(path("frames"), with("--holdout", {"0"}, fast));
  EXPECT_TRUE(found().at("held_out").is_null());
  EXPECT_TRUE(found().at("gain").at("held_out").is_null());
  EXPECT_NE(none.out.find("no frames held out"), std::string::npos) << none.out;
}

TEST_F(Tune, WithoutTruthItScoresDisparitiesByConsistency) {
  pair_in("frames/a");
  pair_in("frames/b");
  const Outcome outcome = tune(path("frames"), {"--evaluations", "10", "--set", "match.num_disparities=16",
                                                "--set", "left_right.max_diff=-1"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Json j = found();
  EXPECT_EQ(j.at("goal"), "consistency");
  EXPECT_EQ(j.at("sequence"), true);  // the same pair twice
  EXPECT_EQ(j.at("tuned_on").at("unsteady").at("before"), 0);
  EXPECT_LE(j.at("tuned_on").at("loss").at("after"), j.at("tuned_on").at("loss").at("before"));
  EXPECT_EQ(tuned().match.num_disparities, 16) << "the user said so";
}

TEST_F(Tune, WithOnlyTrueDisparitiesItScoresDisparities) {
  pair_in("frames/a");
  const Image<float> truth({96, 72}, 6.0F, {});
  io::save_disparity(at("frames/a/disp_left.png"), truth);
  ASSERT_EQ(tune(path("frames"), {"--truth", "--evaluations", "3", "--set", "match.num_disparities=16"}).code,
            0);
  EXPECT_EQ(found().at("goal"), "disparities");
  EXPECT_LT(found().at("tuned_on").at("loss").at("after"), 0.3);
}

TEST_F(Tune, RefusesATruthWithNothingToScore) {
  pair_in("frames/a");
  const Image<std::uint8_t> no_objects({96, 72}, std::uint8_t{0}, {});
  io::save_png(at("frames/a/objects.png"), no_objects.view());
  refuses({"tune", path("frames"), "--truth", "--set", "match.num_disparities=16"}, {"frames", "scored"});
}

TEST_F(Tune, SkipsContradictorySettings) {
  pair_in("frames/a");
  // Windows of 21 and 31 px do not fit 20 rows.
  pair_in("frames/b", {96, 20});
  const Outcome outcome =
      tune(path("frames"), {"--options", "match.window_size", "--set", "match.method=window", "--set",
                            "match.window_size=13", "--set", "match.num_disparities=16"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_LE(tuned().match.window_size, 19);
}

TEST_F(Tune, CtrlCKeepsTheBestSoFar) {
  pair_in("frames/a", {960, 720});  // too large for any machine to finish within a second
  // With --foreground, timeout signals only the process; otherwise also its group, and a second signal would
  // end the program.
  const std::string line = "timeout --foreground --preserve-status -s INT 1 '" CAIRN_COMMAND "' tune '" +
                           path("frames") + "' --options '*' --budget 1h -o '" + path("tuned.yaml") +
                           "' --json '" + path("found.json") + "' > '" + path("out") + "' 2> '" +
                           path("err") + "'";
  const int status = std::system(line.c_str());
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0) << content(at("err"));
  EXPECT_EQ(found().at("end"), "interrupted");
  EXPECT_GE(found().at("evaluations"), 1);
  EXPECT_NE(content(at("out")).find("interrupted"), std::string::npos) << content(at("out"));
  EXPECT_NO_THROW((void)tuned());
}

TEST_F(Tune, EndsWithItsTimeButNotBeforeTheStartIsMeasured) {
  pair_in("frames/a");
  const Outcome outcome = run({"tune", path("frames"), "--budget", "0.001s", "-o", path("tuned.yaml"),
                               "--set", "match.num_disparities=16"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("1 evaluation in"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("time limit reached"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("The options are unchanged"), std::string::npos) << outcome.out;
}

TEST_F(Tune, RefusesContradictoryArguments) {
  pair_in("frames/a");
  write(at("file"), "");
  const std::string frames = path("frames");
  refuses({"tune", path("none")}, {"none", "no such folder"});
  refuses({"tune", path("file")}, {"file"});
  refuses({"tune", frames, "--truth"}, {"frame a", "objects.png"});
  for (const char* budget : {"5x", "-3s", "0", "", "1e99h", "nans"})
    refuses({"tune", frames, "--budget", budget}, {"--budget", "60s"});
  refuses({"tune", frames, "--options", "match.windw_size"}, {"match.window_size"});
  refuses({"tune", frames, "--options", "superpixels.*"}, {"superpixels.*", "true objects"});
  refuses({"tune", frames, "--set", "match.num_disparities=16", "--holdout", "0.5"},
          {"holdout", "one frame"});
  refuses({"tune", frames, "--holdout", "1.5"}, {"--holdout"});
  refuses({"tune", frames, "--evaluations", "-1"}, {"--evaluations"});
  refuses({"tune", frames, "-o", path("no/such/tuned.yaml")}, {"no/such/tuned.yaml"});
  refuses({"tune", frames, "-o", frames}, {frames, "is a folder"});
  refuses({"tune", frames, "--json", path("no/found.json")}, {"found.json"});
  refuses({"tune", frames, "--set", "match.num_disparities=1000"}, {"frame a", "match.num_disparities"});
  refuses({"tune", frames, "--options", "match.window_size"},
          {"match.window_size has no effect with match.method=semi_global"});
}

}  // namespace
}  // namespace cairn::command
