// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/image/binning.hpp>
#include <cairn/io/disparity_files.hpp>
#include <nlohmann/json.hpp>

#include "command.hpp"

namespace cairn::command {
namespace {

using Json = nlohmann::json;
using Command = CommandTest;

TEST_F(Command, ShowsHelpForEveryCommandAndForNone) {
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{},
                                                    {"--help"},
                                                    {"-h"},
                                                    {"segment", "--help"},
                                                    {"disparity", "--help"},
                                                    {"evaluate", "--help"},
                                                    {"bench", "--help"},
                                                    {"tune", "--help"},
                                                    {"doctor", "--help"},
                                                    {"calibrate", "--help"},
                                                    {"rectify", "--help"},
                                                    {"map", "--help"},
                                                    {"config", "--help"},
                                                    {"info", "--help"},
                                                    {"help", "--help"}}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 0);
    EXPECT_EQ(outcome.err, "");
    const std::string name = arguments.empty() || arguments[0].starts_with('-') ? "segment" : arguments[0];
    EXPECT_NE(outcome.out.find(name), std::string::npos) << outcome.out;
  }
  EXPECT_EQ(run({"--version"}).out.find("cairn "), 0U);
}

TEST_F(Command, InfoNamesInstructionSetsAndThreads) {
  const Outcome outcome = run({"info", "--target", "scalar", "--threads", "2"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_NE(outcome.out.find("active     scalar"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("compiled"), std::string::npos);
  EXPECT_NE(outcome.out.find("calibrate, rectify"), std::string::npos) << outcome.out;
}

TEST_F(Command, ConfigPrintsWhatItReadsBack) {
  const std::string changed = run({"config", "--preset", "paper", "--set", "match.window_size=11"}).out;
  EXPECT_NE(changed.find("window_size: 11"), std::string::npos) << changed;
  write(at("options.yaml"), changed);
  EXPECT_EQ(run({"config", "--config", path("options.yaml")}).out, changed);
  const Outcome markdown = run({"config", "--markdown"});
  EXPECT_EQ(markdown.code, 0);
  EXPECT_NE(markdown.out.find("| `match.window_size` |"), std::string::npos) << markdown.out;
}

TEST_F(Command, ConfigPrintsOnlyWhatThePresetReads) {
  const std::string ours = run({"config"}).out;
  EXPECT_NE(ours.find("penalty_small"), std::string::npos) << ours;
  EXPECT_EQ(ours.find("window_size"), std::string::npos) << ours;
  const std::string paper = run({"config", "--preset", "paper"}).out;
  EXPECT_EQ(paper.find("penalty_small"), std::string::npos) << paper;
  EXPECT_NE(paper.find("row_band"), std::string::npos) << paper;
  for (const std::string& text : {ours, paper}) {
    write(at("options.yaml"), text);
    for (const char* preset : {"default", "paper"}) {
      const Outcome outcome = run({"config", "--preset", preset, "--config", path("options.yaml")});
      EXPECT_EQ(outcome.out, text) << outcome.err;
    }
  }
}

TEST_F(Command, TheOrderOfSettingsDoesNotMatter) {
  const std::string cost = "match.cost=sad";
  const std::string method = "match.method=window";
  const std::string one = run({"config", "--set", cost, "--set", method}).out;
  EXPECT_NE(one.find("cost: sad"), std::string::npos) << one;
  EXPECT_EQ(run({"config", "--set", method, "--set", cost}).out, one);
  write(at("cost.yaml"), "match.cost: sad\n");
  EXPECT_EQ(run({"config", "--config", path("cost.yaml"), "--set", method}).out, one);
  EXPECT_EQ(run({"config", "--preset", "paper", "--config", path("cost.yaml")}).code, 0);
}

TEST_F(Command, ConfigPrintsOnlyChangedOptions) {
  const std::vector<std::string> changed_arguments{
      "config", "--changed", "--preset", "paper", "--set", "match.window_size=11", "--set", "match.cost=sad"};
  const std::string changed = run(changed_arguments).out;
  EXPECT_EQ(changed.find("preset: paper\nmatch:\n  cost: sad"), 0U) << changed;
  EXPECT_EQ(std::count(changed.begin(), changed.end(), '\n'), 4) << changed;
  write(at("options.yaml"), changed);
  EXPECT_EQ(run({"config", "--changed", "--config", path("options.yaml")}).out, changed);
  EXPECT_EQ(run({"config", "--changed"}).out, "preset: default\n");
  refuses({"config", "--changed", "--markdown"}, {"--changed", "--markdown"});
}

TEST_F(Command, SegmentPrintsATableAndWritesNothingWithoutAFolder) {
  const auto pair = pair_in("pair");
  const auto before = everything();
  const Outcome outcome = run(with("segment", pair));
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("object"), std::string::npos);
  EXPECT_EQ(everything(), before);
}

TEST_F(Command, SegmentReadsPairsOfNamesInOneFolder) {
  pair_in("pair");
  fs::create_directories(at("recording"));
  for (const char* number : {"01", "02"}) {
    fs::copy_file(at("pair/left.png"), at("recording") / ("left" + std::string(number) + ".png"));
    fs::copy_file(at("pair/right.png"), at("recording") / ("right" + std::string(number) + ".png"));
  }
  const Outcome outcome =
      run({"segment", path("recording"), "--set", "match.num_disparities=16", "-o", path("out")});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_TRUE(fs::exists(at("out/left01/objects.json")) && fs::exists(at("out/left02/objects.json")));
}

TEST_F(Command, FilesCalledLeftAndRightAreNamedAfterTheirFolder) {
  const auto pair = pair_in("kitchen");
  EXPECT_EQ(run(with("segment", pair)).out.find("kitchen: "), 0U);
  EXPECT_EQ(run({"segment", "left.png", "right.png"}, {}, "kitchen").out.find("kitchen: "), 0U);
  fs::copy_file(pair[0], at("near.png"));
  EXPECT_EQ(run({"segment", path("near.png"), pair[1]}).out.find("near: "), 0U);
}

TEST_F(Command, SegmentWritesAResultThatEvaluateReads) {
  const auto pair = pair_in("pair");
  ASSERT_EQ(run(with("segment", pair, {"-o", path("out")})).code, 0);
  for (const char* name : {"disparity.png", "reject.png", "confidence.png", "objects.png", "overlay.png",
                           "disparity_view.png", "objects.json"}) {
    EXPECT_TRUE(fs::exists(at("out") / name)) << name;
  }
  const Image<std::uint16_t> disparity({96, 72}, 6 * 256, {});
  fs::create_directories(at("truth"));
  io::save_png(at("truth/disp_left.png"), disparity.view());
  const Outcome outcome = run({"evaluate", path("out"), path("truth"), "--skip-left", "16"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("bad-1 0.0 %"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("matched pixels with truth, 100.0 % of them within 1 px"), std::string::npos)
      << outcome.out;
}

TEST_F(Command, DisparityWritesItsConfidence) {
  const auto pair = pair_in("pair");
  ASSERT_EQ(run(with("disparity", pair, {"--confidence", path("c.png")})).code, 0);
  const io::Labels confidence = io::load_labels(at("c.png"));
  EXPECT_EQ(confidence.bits, 8);
  EXPECT_GT(confidence.ids(60, 36), 200);
  EXPECT_EQ(confidence.ids(0, 36), 0);
  EXPECT_NE(run(with("disparity", pair, {"--confidence", path("c.pfm")})).err.find(".png"),
            std::string::npos);
}

TEST_F(Command, DisparityDrawsTheImageOfAResult) {
  const auto pair = pair_in("pair");
  ASSERT_EQ(run(with("disparity", pair, {"--view", path("view.png")})).code, 0);
  ASSERT_EQ(run(with("segment", pair, {"-o", path("out")})).code, 0);
  EXPECT_EQ(content(at("view.png")), content(at("out/disparity_view.png")));
  refuses(with("disparity", pair, {"--view", path("view.jpg")}), {"view.jpg", ".png"});
}

TEST_F(Command, HelpAnswersLikeTheOptionAndNamesTheNearestCommand) {
  EXPECT_EQ(run({"help"}).out, run({"--help"}).out);
  EXPECT_EQ(run({"help", "segment"}).out, run({"segment", "--help"}).out);
  refuses({"help", "segmnt"}, {"unknown command 'segmnt'", "did you mean 'segment'?"});
}

TEST_F(Command, EveryHelpShowsExamples) {
  for (const char* name : {"segment", "disparity", "evaluate", "bench", "tune", "doctor", "calibrate",
                           "rectify", "config", "info"}) {
    const std::string help = run({"help", name}).out;
    EXPECT_NE(help.find("Examples:\n  cairn " + std::string(name)), std::string::npos) << help;
  }
}

TEST_F(Command, SegmentReadsAFrameAndAFolderOfFrames) {
  pair_in("many/b");
  pair_in("many/a");
  ASSERT_EQ(run({"segment", path("many/a"), "-o", path("one")}).code, 0);
  EXPECT_TRUE(fs::exists(at("one/objects.json")));
  const Outcome outcome = run({"segment", path("many"), "-o", path("all")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_TRUE(fs::exists(at("all/a/objects.json")));
  EXPECT_TRUE(fs::exists(at("all/b/objects.json")));
  EXPECT_FALSE(fs::exists(at("all/objects.json")));
  EXPECT_LT(outcome.out.find("a:"), outcome.out.find("b:"));
  EXPECT_EQ(outcome.err.find("cairn: note: no floor: "), 0U);  // no progress bar, as stderr is no terminal
}

TEST_F(Command, SegmentBinsImagesAsIfTheyWereOfThatSize) {
  const std::string sample = std::string(CAIRN_SOURCE_DIR) + "/data/samples/overlap";
  const io::LoadedPair pair = io::load_pair(sample + "/left.png", sample + "/right.png");
  fs::create_directories(at("whole"));
  fs::create_directories(at("half"));
  io::save_png(at("whole/left.png"), pair.left.gray.view());
  io::save_png(at("whole/right.png"), pair.right.gray.view());
  const Image<Gray> left = binned(pair.left.gray, 2);
  const Image<Gray> right = binned(pair.right.gray, 2);
  io::save_png(at("half/left.png"), left.view());
  io::save_png(at("half/right.png"), right.view());
  const std::string calib = sample + "/calib.txt";
  const Outcome one = run({"segment", path("whole"), "--calib", calib, "--binning", "2", "-o", path("one")});
  const Outcome other =
      run({"segment", path("half"), "--calib", calib, "--scale-calibration", "-o", path("other")});
  ASSERT_EQ(one.code, 0) << one.err;
  ASSERT_EQ(other.code, 0) << other.err;
  for (const char* file : {"objects.png", "disparity.png", "space.png", "overlay.png"})
    EXPECT_EQ(content(at(std::string("one/") + file)), content(at(std::string("other/") + file))) << file;
  const Json objects = Json::parse(content(at("one/objects.json")));
  EXPECT_EQ(objects.at("objects"), Json::parse(content(at("other/objects.json"))).at("objects"));
  EXPECT_GT(objects.at("objects").size(), 0U);
  const Outcome refused = run({"segment", path("whole"), "--binning", "9"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("--binning: found 9, expected 1 to 8"), std::string::npos) << refused.err;
}

TEST_F(Command, SegmentBinsGivenDisparitiesAndTheRightImageThatChecksThem) {
  const std::string sample = std::string(CAIRN_SOURCE_DIR) + "/data/samples/overlap";
  ASSERT_EQ(run({"disparity", sample, "-o", path("whole.pfm")}).code, 0);
  const Outcome outcome = run({"segment", sample + "/left.png", sample + "/right.png", "--disparity",
                               path("whole.pfm"), "--binning", "2", "-o", path("out")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Image<float> whole = io::load_disparity(at("whole.pfm"));
  const Image<float> expected = binned_disparity(whole, 2);
  const Image<float> found = io::load_disparity(at("out/disparity.png"));
  ASSERT_EQ(found.size(), expected.size());
  int known = 0;
  for (int y = 0; y < found.height(); ++y) {
    for (int x = 0; x < found.width(); ++x) {
      if (std::isnan(found(x, y))) continue;  // refused
      ++known;
      EXPECT_NEAR(found(x, y), expected(x, y), 0.01F);
    }
  }
  EXPECT_GT(known, found.size().area() / 2);
}

TEST_F(Command, SegmentComparesPresets) {
  pair_in("many/a");
  pair_in("many/b");
  const Outcome outcome = run({"segment", path("many"), "--preset", "paper,default", "-o", path("out")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  for (const char* preset : {"paper", "default"}) {
    for (const char* frame : {"a", "b"}) {
      const Json result = Json::parse(content(at("out") / preset / frame / "objects.json"));
      EXPECT_EQ(result.at("preset"), preset);
    }
  }
  const std::size_t table = outcome.out.find("preset   frames");
  ASSERT_NE(table, std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("\npaper         2", table), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("\ndefault       2", table), std::string::npos) << outcome.out;

  const auto pair = pair_in("pair");
  ASSERT_EQ(run(with("segment", pair, {"--preset", "default,paper", "-o", path("one")})).code, 0);
  EXPECT_TRUE(fs::exists(at("one/paper/objects.json")));
  const auto refuses_presets = [&](const std::string& list, std::vector<std::string> more,
                                   const std::vector<std::string>& words) {
    more.insert(more.begin(), {"--preset", list});
    refuses(with("segment", pair, more), words);
  };
  refuses_presets("paper,default", {}, {"paper,default", "-o DIR"});
  refuses_presets("paper,default", {"-o", path("two"), "--json"}, {"--json", "one preset"});
  refuses_presets("paper,papre", {"-o", path("two")}, {"papre"});
  refuses_presets("paper,", {"-o", path("two")}, {"preset"});
  refuses_presets("paper,paper", {"-o", path("two")}, {"paper twice"});
  write(at("fixed.yaml"), "preset: paper\n");
  refuses_presets("paper,default", {"-o", path("two"), "--config", path("fixed.yaml")},
                  {"fixed.yaml", "preset: paper"});
}

TEST_F(Command, AFolderWithOneSubFolderIsStillAFolderOfFrames) {
  pair_in("many/a");
  ASSERT_EQ(run({"segment", path("many"), "-o", path("all")}).code, 0);
  EXPECT_TRUE(fs::exists(at("all/a/objects.json")));
}

TEST_F(Command, SegmentPrintsJson) {
  const Outcome outcome = run(with("segment", pair_in("pair"), {"--json"}));
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(Json::parse(outcome.out).at("image").at("width"), 96);
}

TEST_F(Command, LaterSettingsWin) {
  const auto pair = pair_in("pair");
  write(at("pair/calib.txt"), "fx=100\nfy=100\ncx=48\ncy=36\nbaseline=0.1\nndisp=24\n");
  write(at("options.yaml"), "match.num_disparities: 20\n");
  write(at("preset.yaml"), "preset: paper\n");
  const auto disparities = [&](const std::vector<std::string>& more) {
    const Outcome outcome = run(with("segment", with("--json", pair), more));
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return Json::parse(outcome.out).at("config").at("match").at("num_disparities").get<int>();
  };
  EXPECT_EQ(disparities({}), 24);  // the frame's own calibration
  EXPECT_EQ(disparities({"--preset", "paper"}), 24);
  EXPECT_EQ(disparities({"--config", path("preset.yaml")}), 24);  // a preset does not set it
  EXPECT_EQ(disparities({"--config", path("options.yaml")}), 20);
  EXPECT_EQ(disparities({"--config", path("options.yaml"), "--set", "match.num_disparities=16"}), 16);
  EXPECT_EQ(disparities({"--set", "match.num_disparities=16", "--set", "match.num_disparities=12"}), 12);
  write(at("other.txt"), "fx=100\nfy=100\ncx=48\ncy=36\nbaseline=0.1\nndisp=32\n");
  EXPECT_EQ(disparities({"--calib", path("other.txt")}), 32);
}

TEST_F(Command, FindsTheCalibrationInTheFolderOfTheTruth) {
  const auto pair = pair_in("base/variant");
  fs::create_directories(at("base/gt"));
  write(at("base/gt/calib.txt"), "fx=100\nfy=100\ncx=48\ncy=36\nbaseline=0.1\n");
  const Json from_folder = Json::parse(run({"segment", path("base/variant"), "--json"}).out);
  EXPECT_EQ(from_folder.at("rig").at("focal_px"), 100);
  const Json from_files = Json::parse(run(with("segment", pair, {"--json"})).out);
  EXPECT_EQ(from_files.at("rig"), from_folder.at("rig"));
}

TEST_F(Command, SegmentReadsADisparityMapInsteadOfTheRightImage) {
  const auto pair = pair_in("pair");
  fs::remove(pair[1]);
  std::vector<float> values(96 * 72, 4.0F);
  for (int y = 20; y < 50; ++y) std::fill_n(values.begin() + y * 96 + 30, 30, -9.0F);
  write(at("map.pfm"), pfm({96, 72}, values));
  for (const std::string& input : {pair[0], path("pair")}) {
    const Outcome outcome = run({"segment", input, "--disparity", path("map.pfm"), "-o", path("out")});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("disparity.pfm"), std::string::npos);  // warned: PNG cannot hold −9
    EXPECT_TRUE(fs::exists(at("out/disparity.pfm")));
    EXPECT_FALSE(fs::exists(at("out/confidence.png")));
    EXPECT_TRUE(Json::parse(content(at("out/objects.json"))).at("external_disparity").get<bool>());
  }
}

TEST_F(Command, SegmentReadsAFolderOfMapsByTheFramesNames) {
  for (const char* frame : {"a", "b", "c", "d"}) fs::remove(pair_in(std::string("many/") + frame)[1]);
  fs::create_directories(at("maps/c"));
  const auto flat = [](float px) { return pfm({96, 72}, std::vector<float>(96 * 72, px)); };
  write(at("maps/a.pfm"), flat(4));
  write(at("maps/c/disparity.pfm"), flat(5));
  std::string header = "{'descr': '<f4', 'fortran_order': False, 'shape': (72, 96), }";
  header.resize(117, ' ');
  const std::string pixels = flat(3);
  write(at("maps/b.npy"), std::string("\x93NUMPY\x01\x00\x76\x00", 10) + header + "\n" +
                              pixels.substr(pixels.size() - 96 * 72 * sizeof(float)));
  const Outcome outcome = run({"segment", path("many"), "--disparity", path("maps"), "-o", path("out")});
  EXPECT_EQ(outcome.code, 2);  // for d
  EXPECT_NE(outcome.err.find("frame d is skipped: --disparity " + path("maps")), std::string::npos)
      << outcome.err;
  EXPECT_EQ(io::load_disparity(at("out/a/disparity.png"))(50, 36), 4);
  EXPECT_EQ(io::load_disparity(at("out/b/disparity.png"))(50, 36), 3);
  EXPECT_EQ(io::load_disparity(at("out/c/disparity.png"))(50, 36), 5);
  EXPECT_FALSE(fs::exists(at("out/d")));
}

TEST_F(Command, DisparityWritesTheFormatOfTheExtension) {
  const auto pair = pair_in("pair");
  ASSERT_EQ(run(with("disparity", pair, {"-o", path("d.png"), "--set", "match.num_disparities=16"})).code, 0);
  ASSERT_EQ(run(with("disparity", pair, {"-o", path("d.pfm"), "--set", "match.num_disparities=16"})).code, 0);
  const Image<float> png = io::load_disparity(at("d.png"));
  const Image<float> map = io::load_disparity(at("d.pfm"));
  int valid = 0;
  for (int y = 0; y < 72; ++y) {
    for (int x = 0; x < 96; ++x) {
      ASSERT_EQ(std::isnan(png(x, y)), std::isnan(map(x, y)));
      if (std::isnan(map(x, y))) continue;
      ++valid;
      EXPECT_NEAR(png(x, y), map(x, y), 1 / 256.0);
    }
  }
  EXPECT_GT(valid, 96 * 72 / 2);
}

TEST_F(Command, DisparityFillsHolesIfRefined) {
  const std::string sample = std::string(CAIRN_SOURCE_DIR) + "/data/samples/dim_light";
  ASSERT_EQ(run({"disparity", sample, "-o", path("d.png")}).code, 0);
  const Outcome some = run({"disparity", sample, "--refined", "-o", path("r.png"), "--confidence",
                            path("c.png"), "--view", path("v.png")});
  ASSERT_EQ(some.code, 0) << some.err;
  EXPECT_NE(some.out.find("\nunlikely "), std::string::npos) << some.out;
  ASSERT_EQ(run({"disparity", sample, "--refined", "--min-confidence", "0", "-o", path("all.pfm")}).code, 0);
  const auto holes = [&](const char* name) {
    const Image<float> map = io::load_disparity(at(name));
    int count = 0;
    for (int y = 0; y < map.height(); ++y)
      count += static_cast<int>(
          std::count_if(map.row(y), map.row(y) + map.width(), [](float d) { return std::isnan(d); }));
    return count;
  };
  EXPECT_LT(holes("r.png"), holes("d.png") / 2);
  EXPECT_LT(holes("all.pfm"), 320 * 240 / 500) << "only groups too small to be judged";
  const Image<float> refined = io::load_disparity(at("r.png"));
  const io::Labels confidence = io::load_labels(at("c.png"));
  for (int y = 0; y < refined.height(); ++y) {
    for (int x = 0; x < refined.width(); ++x) ASSERT_EQ(std::isnan(refined(x, y)), confidence.ids(x, y) == 0);
  }
  refuses({"disparity", sample, "--refined", "--preset", "paper"},
          {"--refined", "pipeline.method", "region_tree"});
  refuses({"disparity", sample, "--refined", "--min-confidence", "nan"}, {"--min-confidence", "0 … 1"});
  refuses({"disparity", sample, "--refined", "--min-confidence", "1.5"}, {"--min-confidence", "1.5"});
  refuses({"disparity", sample, "--min-confidence", "0.5"}, {"--refined"});
}

TEST_F(Command, TablesListTheReasonsInForceAndMissingTexture) {
  const auto pair = pair_in("pair");
  for (const char* side : {"pair/left.png", "pair/right.png"}) {  // a plain wall next to the dots
    Image<Gray> image = io::load_picture(at(side)).gray;
    for (int y = 0; y < 72; ++y) std::fill_n(image.row(y) + 48, 48, Gray{9});
    io::save_png(at(side), image.view());
  }
  const std::vector<std::string> range{"--set", "match.num_disparities=16"};
  const std::string ours = run(with("disparity", pair, range)).out;
  EXPECT_NE(ours.find("left_right"), std::string::npos) << ours;
  EXPECT_EQ(ours.find("no_texture"), std::string::npos) << ours;
  EXPECT_NE(ours.find("of it too dark or without texture"), std::string::npos) << ours;
  const std::string paper = run(with("disparity", pair, with("--preset", {"paper"}, range))).out;
  const std::size_t row = paper.find("\nno_texture ");
  ASSERT_NE(row, std::string::npos) << paper;
  EXPECT_NE(paper.substr(row, paper.find('\n', row + 1) - row).find("100.0 %"), std::string::npos) << paper;
  EXPECT_EQ(paper.find("no_data"), std::string::npos) << paper;
  const std::string segmented = run(with("segment", pair, with("--preset", {"paper"}, range))).out;
  const std::size_t line = segmented.find("\nrefused: ");
  ASSERT_NE(line, std::string::npos) << segmented;
  EXPECT_NE(segmented.find("% of it too dark or without texture)", line), std::string::npos) << segmented;
}

TEST_F(Command, ThreadsAndTargetsChangeNoBitOfAResult) {
  const auto pair = pair_in("pair");
  ASSERT_EQ(run(with("segment", pair, {"-o", path("one"), "--threads", "1", "--target", "scalar"})).code, 0);
  ASSERT_EQ(run(with("segment", pair, {"-o", path("two"), "--threads", "3"})).code, 0);
  for (const char* name : {"disparity.png", "reject.png", "confidence.png", "objects.png", "overlay.png",
                           "disparity_view.png"}) {
    EXPECT_EQ(content(at("one") / name), content(at("two") / name)) << name;
  }
}

/// Two frames with truth, and a third without a result: `evaluate` with results equal to the truth.
TEST_F(Command, EvaluateFindsNoErrorInTheTruth) {
  Image<std::uint16_t> ids({96, 72}, 0, {});
  for (int y = 10; y < 40; ++y) std::fill_n(ids.row(y) + 10, 30, std::uint16_t{1});
  for (int y = 10; y < 60; ++y) std::fill_n(ids.row(y) + 50, 30, std::uint16_t{7});
  for (const char* name : {"a", "b", "c"}) {
    fs::create_directories(at("truth") / name);
    io::save_png(at("truth") / name / "objects.png", ids.view());
  }
  for (const char* name : {"a", "b"}) {
    fs::create_directories(at("result") / name);
    io::save_png(at("result") / name / "objects.png", ids.view());
  }
  const Outcome outcome = run({"evaluate", path("result"), path("truth")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  for (const char* text :
       {"E1 %", "E7 %", "2/2", "4 true ones of at least 200 px in 2 frames", "IoU >= 0.5: 100.0 %",
        "mean 0.0 %   median 0.0 %", "phantoms            0.00 per frame", "1 frame of the truth: c"}) {
    EXPECT_NE(outcome.out.find(text), std::string::npos) << text << "\n" << outcome.out;
  }
  write(at("truth/a/partial"), "");
  write(at("truth/b/partial"), "");
  EXPECT_NE(run({"evaluate", path("result"), path("truth")}).out.find("precision           undefined"),
            std::string::npos);
}

TEST_F(Command, EvaluateFindsTheTruthOfVariantsInTheSiblingFolder) {
  const Image<std::uint16_t> disparity({96, 72}, 6 * 256, {});
  for (const char* name : {"base/gt", "base/dim", "base/noisy", "out/dim", "out/noisy"})
    fs::create_directories(at(name));
  io::save_png(at("base/gt/disp_left.png"), disparity.view());
  io::save_png(at("out/dim/disparity.png"), disparity.view());
  io::save_png(at("out/noisy/disparity.png"), disparity.view());
  const Outcome outcome = run({"evaluate", path("out"), path("base")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("noisy"), std::string::npos);
  EXPECT_NE(outcome.out.find("no occlusion.png"), std::string::npos) << outcome.out;
  EXPECT_EQ(outcome.out.find("no result"), std::string::npos) << outcome.out;
}

TEST_F(Command, EvaluateReads255AsDontCareInEightBitsOnly) {
  Image<std::uint16_t> ours({96, 72}, 0, {});
  for (int y = 10; y < 40; ++y) std::fill_n(ours.row(y) + 10, 30, std::uint16_t{255});
  Image<std::uint8_t> eight({96, 72}, 0, {});
  for (int y = 10; y < 40; ++y) std::fill_n(eight.row(y) + 10, 30, std::uint8_t{255});
  fs::create_directories(at("result"));
  fs::create_directories(at("truth"));
  io::save_png(at("result/objects.png"), ours.view());
  io::save_png(at("truth/objects.png"), ours.view());
  EXPECT_NE(run({"evaluate", path("result"), path("truth")}).out.find("1 true ones"), std::string::npos);
  io::save_png(at("truth/objects.png"), eight.view());
  const std::string out = run({"evaluate", path("result"), path("truth")}).out;
  EXPECT_NE(out.find("0 true ones"), std::string::npos) << out;
  EXPECT_NE(out.find("phantoms            0.00"), std::string::npos) << out;
}

}  // namespace
}  // namespace cairn::command
