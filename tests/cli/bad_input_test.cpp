// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// Every bad input ends with exit code 2 and one line on stderr that names file or option, and writes nothing.
#include <cairn/pipeline/config.hpp>
#include <limits>

#include "command.hpp"

namespace cairn::command {
namespace {

using BadInput = CommandTest;

TEST_F(BadInput, RefusesInvalidImages) {
  const auto good = pair_in("good");
  const std::string png = content(good[0]);
  write(at("empty.png"), "");
  write(at("text.png"), "this is not an image\n");
  write(at("cut.png"), png.substr(0, png.size() / 2));
  write(at("header.png"), png.substr(0, 20));
  write(at("cut.pgm"), "P5\n96 72\n255\nabc");
  write(at("huge.pgm"), "P5\n2000000000 2000000000\n255\nabc");
  write(at("cut.jpg"), std::string("\xff\xd8\xff\xe0\x00\x10JFIF", 10));  // NOLINT: JPEG begins so
  for (const char* bad :
       {"missing.png", "empty.png", "text.png", "cut.png", "header.png", "cut.pgm", "huge.pgm", "cut.jpg"}) {
    refuses({"segment", good[0], path(bad)}, {bad});
    refuses({"disparity", good[0], path(bad), "-o", path("d.png")}, {bad});
    refuses({"segment", path(bad), good[1], "-o", path("out")}, {bad});
  }
  refuses({"segment", path("good"), good[1]}, {"good"});  // a folder instead of an image
}

TEST_F(BadInput, RefusesInvalidPairs) {
  const auto pair = pair_in("pair");
  const auto other = pair_in("other", {90, 72});
  refuses({"segment", pair[0], other[1]}, {"96x72", "90x72"});
  refuses({"segment", pair[0]}, {pair[0], "right"});
  refuses({"segment", pair[0], pair[1], pair[1]}, {pair[1]});
  fs::remove(pair[1]);
  refuses({"segment", path("pair")}, {"pair", "right"});
}

TEST_F(BadInput, RefusesAMissingPath) {
  for (const char* command : {"segment", "disparity", "doctor"})
    refuses({command, path("nowhere")}, {"nowhere", "no such file or folder"});
}

TEST_F(BadInput, RefusesImagesTooSmallForTheMethod) {
  const auto one = pair_in("one", {1, 1});
  const auto small = pair_in("small", {8, 8});
  const auto narrow = pair_in("narrow", {40, 40});
  refuses(with("segment", one), {"match.method", "3x3", "1x1"});
  refuses(with("disparity", one, {"--preset", "paper"}), {"match.window_size", "1x1"});
  refuses(with("segment", small, {"--preset", "paper", "--set", "match.window_size=9"}),
          {"match.window_size", "8x8"});
  refuses(with("segment", narrow, {"--set", "match.num_disparities=41"}), {"match.num_disparities", "40"});
  refuses(with("segment", narrow, {"--set", "match.min_disparity=40", "--set", "match.num_disparities=10"}),
          {"match.min_disparity"});
}

TEST_F(BadInput, RefusesUnknownAndOutOfRangeOptions) {
  const auto pair = pair_in("pair");
  const auto refuses_set = [&](const std::string& assignment, const std::vector<std::string>& words) {
    refuses({"config", "--set", assignment}, words);
  };
  refuses(with("segment", pair, {"--set", "match.window_size=8"}), {"match.window_size", "8", "odd"});
  refuses_set("match.window_size=8", {"match.window_size", "8", "odd"});
  refuses_set("match.window_size=99", {"match.window_size", "99", "31"});
  refuses_set("match.window_size=nine", {"match.window_size", "nine"});
  refuses_set("match.window_size=", {"match.window_size"});
  refuses_set("match.windowsize=9", {"match.windowsize", "match.window_size"});
  refuses_set("match.cost=zncd", {"match.cost", "zncd", "zncc"});
  refuses_set("left_right.max_diff=nan", {"left_right.max_diff", "nan"});
  refuses_set("ground.label_floor=maybe", {"ground.label_floor", "maybe"});
  refuses_set("match.window_size", {"--set", "match.window_size", "NAME=VALUE"});
  refuses_set("=9", {"--set", "NAME=VALUE"});
  refuses(with("segment", pair, {"--preset", "papre"}), {"papre", "paper"});
  refuses({"config", "--preset", "papre"}, {"papre", "paper"});
  refuses(with("segment", pair, {"--theads", "2"}), {"--theads", "--threads"});
  refuses({"segment", "--theads"}, {"--theads", "--threads"});
  refuses({"evaluate", "--min-aera=3"}, {"--min-aera", "--min-area"});
  refuses(with("segment", pair, {"-x"}), {"-x"});
  refuses(with("segment", pair, {"--threads", "-2"}), {"--threads", "-2"});
  refuses(with("segment", pair, {"--threads", "two"}), {"--threads", "two"});
  refuses(with("segment", pair, {"--threads"}), {"--threads"});
  refuses(with("segment", pair, {"--target", "sse5"}), {"--target", "sse5", "scalar"});
  refuses({"segmnt"}, {"segmnt", "segment"});
  refuses({"quux"}, {"quux"});
  refuses({"segment"}, {"LEFT"});
  refuses({"segment", "", ""}, {"LEFT", "empty"});
  refuses({"--no-such-option"}, {"--no-such-option"});
}

TEST_F(BadInput, RefusesOptionsWithoutEffect) {
  const auto pair = pair_in("pair");
  const Outcome outcome = run(with("segment", pair, {"--set", "match.cost=sad"}));
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.err,
            "cairn: match.cost has no effect with match.method=semi_global; set match.method=window first\n");
  for (const std::string& preset : preset_names()) {
    for (const OptionInfo& option : options(Config::preset(preset))) {
      if (option.active) continue;
      // Even its current value: setting an option implies that it matters.
      refuses({"config", "--preset", preset, "--set", option.name + "=" + option.value},
              {option.name + " has no effect with ", "; set ", " first"});
      write(at("dead.yaml"), option.name + ": " + option.value + "\n");
      refuses({"config", "--preset", preset, "--config", path("dead.yaml")},
              {"dead.yaml: line 1: " + option.name + " has no effect with "});
    }
  }
  refuses({"config", "--preset", "paper", "--set", "match.method=semi_global", "--set", "match.row_band=2"},
          {"match.row_band has no effect with match.method=semi_global"});
}

TEST_F(BadInput, TheEnvironmentsTargetIsCheckedLikeTheOption) {
  const auto pair = pair_in("pair");
  setenv("CAIRN_TARGET", "sse5", 1);
  refuses(with("segment", pair), {"CAIRN_TARGET", "sse5"});
  EXPECT_EQ(run(with("segment", pair, {"--target", "scalar"})).code, 0);  // the option wins
  unsetenv("CAIRN_TARGET");
}

TEST_F(BadInput, RefusesInvalidCalibrations) {
  const auto pair = pair_in("pair");
  const auto refuses_calib = [&](const std::string& text, const std::vector<std::string>& words) {
    write(at("bad.txt"), text);
    refuses(with("segment", pair, {"--calib", path("bad.txt"), "-o", path("out")}), words);
  };
  const auto lines = [](const std::string& fx, const std::string& baseline) {
    return "fx=" + fx + "\nfy=" + fx + "\ncx=48\ncy=36\nbaseline=" + baseline + "\n";
  };
  refuses_calib(lines("nan", "0.1"), {"bad.txt"});
  refuses_calib(lines("inf", "0.1"), {"bad.txt"});
  refuses_calib(lines("0", "0.1"), {"bad.txt"});
  refuses_calib(lines("-400", "0.1"), {"bad.txt"});
  refuses_calib(lines("400", "nan"), {"bad.txt"});
  refuses_calib(lines("400", "0"), {"bad.txt"});
  refuses_calib(lines("400", "-0.1"), {"bad.txt"});
  refuses_calib("", {"bad.txt"});
  refuses_calib("hello world\n", {"bad.txt"});
  refuses_calib(std::string("\0\1\2\3", 4), {"bad.txt"});
  refuses_calib(lines("400", "0.1") + "width=640\nheight=480\n", {"bad.txt", "640x480", "96x72"});
  refuses_calib(lines("400", "0.1") + "ndisp=5000\n", {"bad.txt"});
  refuses(with("segment", pair, {"--calib", path("missing.txt")}), {"missing.txt"});
  refuses(with("segment", pair, {"--calib", path("pair")}), {"pair"});
}

TEST_F(BadInput, RefusesTooFewOrCollinearGroundPoints) {
  const auto pair = pair_in("pair");
  const auto refuses_points = [&](const std::string& points) {
    write(at("points.txt"), "ground_points=" + points + "\n");
    refuses(with("segment", pair, {"--calib", path("points.txt"), "--set", "ground.source=points"}),
            {"ground_points"});
  };
  refuses_points("");
  refuses(with("segment", pair, {"--set", "ground.source=points"}), {"ground.source", "ground_points"});
  refuses_points("10,60,5,60;80,60,75,60;40,70,30,70");
  refuses_points("10,60,5,60;20,60,15,60;30,60,25,60;40,60,35,60");
  refuses_points("10,10,5,10;20,20,15,20;30,30,25,30;40,40,35,40;50,50,45,50");
  refuses_points("10,60,5");
  refuses(with("segment", pair, {"--set", "ground.source=pose"}),
          {"ground.source", "camera_height", "calib"});
}

TEST_F(BadInput, RefusesInvalidDisparityMaps) {
  const auto pair = pair_in("pair");
  const Size size{96, 72};
  const auto pixels = static_cast<std::size_t>(size.area());
  const std::string good = pfm(size, std::vector<float>(pixels, 5.0F));
  write(at("cut.pfm"), good.substr(0, good.size() - 3));
  write(at("long.pfm"), good + "abc");
  write(at("other.pfm"), pfm({10, 10}, std::vector<float>(100, 5.0F)));
  write(at("holes.pfm"), pfm(size, std::vector<float>(pixels, std::numeric_limits<float>::infinity())));
  write(at("far.pfm"), pfm(size, std::vector<float>(pixels, 1e6F)));
  write(at("text.pfm"), "no map\n");
  for (const char* bad :
       {"cut.pfm", "long.pfm", "other.pfm", "text.pfm", "missing.pfm", "holes.pfm", "far.pfm"}) {
    refuses({"segment", pair[0], "--disparity", path(bad), "-o", path("out")}, {bad});
  }
  refuses({"segment", path("missing.png"), "--disparity", path("cut.pfm")}, {"missing.png"});
  write(at("good.pfm"), good);
  pair_in("many/a");
  pair_in("many/b");
  refuses({"segment", path("many"), "--disparity", path("good.pfm")}, {"--disparity", "2 frames"});
  fs::create_directories(at("maps"));
  refuses({"segment", path("many"), "--disparity", path("maps")}, {"maps", "frame a", "a.png", ".npy"});
  refuses({"segment", pair[0], "--disparity", path("maps")}, {"maps", "frame pair", "pair.png", ".npy"});
}

TEST_F(BadInput, RefusesImpossibleOutputs) {
  const auto pair = pair_in("pair");
  write(at("file"), "mine");
  refuses(with("segment", pair, {"-o", path("file")}), {"file"});
  refuses(with("segment", pair, {"-o", path("file/out")}), {"file"});
  refuses(with("segment", pair, {"-o", "/proc/no_such_folder/out"}), {"/proc/no_such_folder"});
  refuses(with("disparity", pair, {"-o", path("file/d.png")}), {"file"});
  refuses(with("disparity", pair, {"-o", path("no_such_folder/d.png")}), {"no_such_folder"});
  refuses(with("disparity", pair, {"-o", path("d.jpg")}), {"d.jpg", ".png", ".pfm"});
  refuses(with("disparity", pair, {"-o", path("d")}), {".png", ".pfm"});
  refuses(with("disparity", pair, {"-o", path("d.png"), "--set", "match.min_disparity=-8"}),
          {"d.png", "-8", ".pfm"});
  refuses(with("disparity", pair, {"-o", path("d.png"), "--set", "match.min_disparity=250"}),
          {"d.png", ".pfm"});
  EXPECT_EQ(content(at("file")), "mine");
}

TEST_F(BadInput, AFullDiskIsReported) {
  const auto pair = pair_in("pair");
  fs::create_symlink("/dev/full", at("full.pfm"));
  refuses(with("disparity", pair, {"-o", path("full.pfm")}), {"full.pfm"});
  const Outcome outcome = run({"config"}, "/dev/full");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(outcome.err, "cairn: standard output: cannot be written\n");
}

TEST_F(BadInput, RefusesInvalidConfigFiles) {
  const auto pair = pair_in("pair");
  const auto refuses_config = [&](const std::string& text, const std::vector<std::string>& words) {
    write(at("bad.yaml"), text);
    refuses({"config", "--config", path("bad.yaml")}, words);
  };
  write(at("bad.yaml"), "match: [");
  refuses(with("segment", pair, {"--config", path("bad.yaml")}), {"bad.yaml"});
  refuses_config("match: [", {"bad.yaml"});
  refuses_config("match:\n  window_size: 8\n", {"bad.yaml", "line 2", "window_size"});
  refuses_config("match:\n  windw_size: 9\n", {"bad.yaml", "line 2", "match.window_size"});
  refuses_config("mathc.window_size: 9\n", {"bad.yaml", "match.window_size"});
  refuses_config("preset: papre\n", {"bad.yaml", "paper"});
  refuses_config("just words\n", {"bad.yaml"});
  refuses(with("segment", pair, {"--config", path("pair")}), {"pair", "folder"});
  refuses(with("segment", pair, {"--config", path("missing.yaml")}), {"missing.yaml"});
}

TEST_F(BadInput, RefusesFoldersWithoutFrames) {
  fs::create_directories(at("none/inside"));
  refuses({"segment", path("none")}, {"none", "left"});
  refuses({"segment", path("none"), "-o", path("out")}, {"none"});
  refuses({"segment", path("missing")}, {"missing"});
  pair_in("many/a");
  pair_in("many/b");
  refuses({"disparity", path("many")}, {"many", "2 frames"});
}

TEST_F(BadInput, RefusesEvaluationsWithoutResults) {
  pair_in("frame");
  fs::create_directories(at("none"));
  refuses({"evaluate", path("missing"), path("frame")}, {"missing"});
  refuses({"evaluate", path("frame"), path("missing")}, {"missing"});
  refuses({"evaluate", path("none"), path("frame")}, {"none"});
  refuses({"evaluate", path("frame")}, {"TRUTH"});

  const Image<std::uint16_t> ids({96, 72}, 1, {});
  const Image<std::uint16_t> others({95, 72}, 1, {});
  fs::create_directories(at("result"));
  fs::create_directories(at("truth"));
  io::save_png(at("result/objects.png"), ids.view());
  refuses({"evaluate", path("result"), path("truth")}, {"truth"});
  io::save_png(at("truth/objects.png"), others.view());
  refuses({"evaluate", path("result"), path("truth")}, {"96x72", "95x72"});
  write(at("truth/objects.png"), "no image");
  refuses({"evaluate", path("result"), path("truth")}, {"objects.png"});
  io::save_png(at("truth/objects.png"), ids.view());
  write(at("result/objects.json"), "{");
  refuses({"evaluate", path("result"), path("truth")}, {"objects.json"});
  fs::create_directories(at("results/a"));
  io::save_png(at("results/a/objects.png"), ids.view());
  refuses({"evaluate", path("results"), path("truth")}, {"truth"});
}

TEST_F(BadInput, ABadFrameOfAFolderIsNamedAndSkipped) {
  pair_in("many/a");
  const auto bad = pair_in("many/b");
  pair_in("many/c");
  ASSERT_EQ(run({"segment", path("many"), "-o", path("out")}).code, 0);
  ASSERT_TRUE(fs::exists(at("out/b/objects.json")));
  write(bad[1], "no image");
  const Outcome outcome = run({"segment", path("many"), "--html", "-o", path("out")});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 3) << outcome.err;
  EXPECT_EQ(outcome.err.find("cairn: frame b is skipped: " + bad[1]), 0U) << outcome.err;
  EXPECT_NE(outcome.err.find("\ncairn: note: no floor: "), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("\ncairn: 1 of 3 frames skipped\n"), std::string::npos) << outcome.err;
  EXPECT_TRUE(fs::exists(at("out/a/objects.json")));
  EXPECT_FALSE(fs::exists(at("out/b"))) << "the result of the run before";
  EXPECT_TRUE(fs::exists(at("out/c/objects.json")));
  EXPECT_TRUE(fs::exists(at("out/segment.html")));
}

TEST_F(BadInput, AnErrorCommonToAllFramesEndsTheRunAtOnce) {
  pair_in("many/a");
  pair_in("many/b");
  refuses({"segment", path("many"), "-o", path("out"), "--calib", path("none.txt")}, {"none.txt"});
  refuses({"segment", path("many"), "-o", "/proc/no_such_folder/out"}, {"frame a", "/proc/no_such_folder"});
}

TEST_F(BadInput, ABadResultOfAFolderIsNamedAndSkipped) {
  for (const char* name : {"a", "b", "c"}) pair_in(std::string("many/") + name);
  ASSERT_EQ(run({"segment", path("many"), "-o", path("results")}).code, 0);
  ASSERT_EQ(run({"segment", path("many"), "-o", path("truth")}).code, 0);
  const Outcome swapped = run({"evaluate", path("results"), path("truth")});
  EXPECT_NE(swapped.err.find("truth/a: has an objects.json"), std::string::npos) << swapped.err;
  for (const char* name : {"a", "b", "c"}) fs::remove(at("truth") / name / "objects.json");
  write(at("results/b/objects.png"), "no image");
  const Outcome outcome = run({"evaluate", path("results"), path("truth"), "--json", path("e.json")});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.err.find("cairn: frame b is skipped: "), 0U) << outcome.err;
  EXPECT_NE(outcome.err.find("\ncairn: 1 of 3 frames skipped\n"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.out.find("in 2 frames"), std::string::npos) << outcome.out;
  EXPECT_NE(content(at("e.json")).find("\"left_out\": [\n  \"b\"\n ]"), std::string::npos);
  for (const char* name : {"a", "c"}) write(at("results") / name / "objects.png", "no image");
  fs::remove(at("e.json"));
  EXPECT_EQ(run({"evaluate", path("results"), path("truth"), "--json", path("e.json")}).code, 2);
  EXPECT_FALSE(fs::exists(at("e.json")));
}

TEST_F(BadInput, AFailedRunKeepsTheOlderResult) {
  const auto pair = pair_in("pair");
  ASSERT_EQ(run(with("segment", pair, {"-o", path("out")})).code, 0);
  const std::string before = content(at("out/objects.json"));
  refuses(with("segment", pair, {"-o", path("out"), "--set", "match.window_size=8"}), {"match.window_size"});
  write(pair[1], "no image");
  refuses(with("segment", pair, {"-o", path("out")}), {"right.png"});
  EXPECT_EQ(content(at("out/objects.json")), before);
}

}  // namespace
}  // namespace cairn::command
