// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/geometry.hpp>
#include <cairn/diagnosis/findings.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "command.hpp"
#include "support/samples.hpp"

namespace cairn::command {
namespace {

using Json = nlohmann::json;
using Doctor = CommandTest;

std::string sample(const std::string& name) {
  return samples::folder(name).string();
}

std::string last_line(const std::string& text) {
  if (text.empty()) return {};
  const std::size_t before = text.rfind('\n', text.size() - 2);
  return text.substr(before == std::string::npos ? 0 : before + 1, text.size() - before - 2);
}

TEST_F(Doctor, FindsNothingWrongInTheSamples) {
  const Outcome outcome = run({"doctor", sample(""), "--json", path("doctor.json")});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.err, "");
  EXPECT_EQ(last_line(outcome.out), "verdict: nothing wrong found");
  EXPECT_NE(outcome.out.find("not checked  synchrony: 4 pairs in a row, expected 8\n"), std::string::npos)
      << outcome.out;
  const Json j = Json::parse(content(at("doctor.json")));
  EXPECT_EQ(j["broken"], false);
  EXPECT_EQ(j["findings"].size(), 0U);
  ASSERT_EQ(j["pairs"].size(), 4U);
  EXPECT_EQ(j["pairs"][0]["name"], "dim_light");
  EXPECT_GT(j["pairs"][0]["measured"]["found_points"], 20);
  EXPECT_EQ(j["pairs"][0]["measured"]["rows_histogram"].size(), 17U);
}

TEST_F(Doctor, ReportsTheProblemAndTheRemedyAndExitsWithOne) {
  const fs::path folder = samples::folder("overlap");
  const Outcome outcome =
      run({"doctor", folder / "right.png", folder / "left.png", "--json", path("d.json")});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(outcome.err, "");
  EXPECT_NE(outcome.out.find("broken   cameras swapped: "), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("Exchange the two images"), std::string::npos) << outcome.out;
  EXPECT_EQ(last_line(outcome.out), "verdict: broken: cameras swapped");
  const Json j = Json::parse(content(at("d.json")));
  EXPECT_EQ(j["broken"], true);
  EXPECT_EQ(j["findings"][0]["finding"], "cameras swapped");
  EXPECT_EQ(j["findings"][0]["severity"], "broken");
  EXPECT_EQ(j["findings"][0]["unit"], "%");
  EXPECT_EQ(j["findings"][0]["pairs"], Json::array({"overlap"}));
}

TEST_F(Doctor, WarningsAloneExitWithZeroUnlessStrict) {
  const fs::path folder = samples::folder("overlap");
  const Outcome strict = run({"doctor", folder, "--strict", "--set", "match.num_disparities=16"});
  EXPECT_EQ(strict.code, 1);
  EXPECT_EQ(last_line(strict.out), "verdict: warning: disparity range too small");
  EXPECT_EQ(run({"doctor", folder, "--strict"}).code, 0);
  const Outcome outcome = run({"doctor", folder, "--set", "match.num_disparities=16"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_NE(outcome.out.find("warning  disparity range too small: "), std::string::npos) << outcome.out;
}

/// A folder with a pair of the samples, whose calibration has a key without meaning.
fs::path rig_folder(const fs::path& folder) {
  fs::create_directories(folder);
  for (const char* file : {"left.png", "right.png"})
    fs::copy_file(samples::folder("overlap") / file, folder / file);
  write(folder / "calib.txt",
        content(samples::folder("overlap") / "calib.txt") + "\nserial_xyz=SECRET-4711\n");
  return folder;
}

TEST_F(Doctor, ReportDescribesTheRig) {
  const fs::path rig = rig_folder(at("Jane Doe/my rig"));
  const Outcome outcome =
      run({"doctor", rig, "--set", "match.method=window", "--report", path("report.json"), "--threads", "1"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const std::string text = content(at("report.json"));
  const Json j = Json::parse(text);
  EXPECT_EQ("cairn " + j["cairn"].get<std::string>() + "\n", run({"--version"}).out);
  EXPECT_EQ(j["build"]["threads"], 1);
  EXPECT_TRUE(j["build"]["target"].is_string());
  EXPECT_TRUE(j["build"]["built_in"].contains("SIMD (Highway)"));
  EXPECT_NE(j["system"]["os"], "");
  EXPECT_GT(j["system"]["processors"], 0);
  EXPECT_EQ(j["calibration"]["file"], "calib.txt");
  const auto& keys = j["calibration"]["keys"];
  EXPECT_NE(std::find(keys.begin(), keys.end(), "serial_xyz"), keys.end()) << keys;
  EXPECT_GT(j["calibration"]["rig"]["baseline_m"], 0);
  EXPECT_GT(j["calibration"]["rig"]["focal_px"], 0);
  EXPECT_EQ(j["calibration"]["remarks"].size(), 1U) << j["calibration"];
  EXPECT_EQ(j["images"]["left"]["type"], ".png");
  EXPECT_EQ(j["images"]["left"]["size"], j["images"]["right"]["size"]);
  EXPECT_EQ(j["frame"]["changed_options"]["match.method"], "window") << j["frame"];
  EXPECT_GT(j["frame"]["total_ms"], 0);
  EXPECT_FALSE(j["frame"]["stages_ms"].empty());
  EXPECT_EQ(j["diagnosis"]["pairs"][0]["name"], "pair");
  EXPECT_GT(j["diagnosis"]["pairs"][0]["measured"]["found_points"], 20);
}

TEST_F(Doctor, ReportHasNoFolderAndNoImageUnlessAllowed) {
  const fs::path rig = rig_folder(at("Jane Doe/my rig"));
  write(rig / "calib.txt",
        "fx=-5\nfy=-5\nbaseline=0.1\ncx=10\ncy=10\nserial_xyz=SECRET-4711\n");  // its message has the path
  const Outcome outcome = run({"doctor", rig / "left.png", rig / "right.png", "--calib", rig / "calib.txt",
                               "--report", path("report.json")});
  EXPECT_EQ(outcome.code, 1) << outcome.err;
  const std::string text = content(at("report.json"));
  const Json j = Json::parse(text);
  EXPECT_EQ(j["diagnosis"]["broken"], true);
  EXPECT_TRUE(j["calibration"]["error"].get<std::string>().starts_with("calib.txt: ")) << j["calibration"];
  for (const std::string& word : {at("").string(), std::string("Jane"), std::string("my rig"),
                                  std::string("SECRET"), std::string("data:image"), std::string("\"png\"")})
    EXPECT_EQ(text.find(word), std::string::npos) << word << "\n" << text;

  const fs::path pair = rig_folder(at("pair"));
  EXPECT_EQ(run({"doctor", pair, "--report", path("with.json"), "--report-images"}).code, 0);
  const Json with = Json::parse(content(at("with.json")));
  for (const char* side : {"left", "right"})
    EXPECT_TRUE(with["images"][side]["png"].get<std::string>().starts_with("data:image/png;base64,iVBOR"));
}

TEST_F(Doctor, RefusesAReportThatCannotBeWrittenBeforeTheWork) {
  const std::string pair = sample("overlap");
  refuses({"doctor", pair, "--report", path("none/report.json")},
          {"none/report.json: cannot be written", "no such folder"});
  refuses({"doctor", pair, "--report", path("")}, {"is a folder, expected a file name"});
  refuses({"doctor", pair, "--report-images"}, {"--report"});
  // The missing input is not even looked at.
  refuses({"doctor", path("missing"), "--report", path("none/r.json")}, {"none/r.json: cannot be written"});
  const fs::path rig = rig_folder(at("rig"));
  refuses({"doctor", rig, "--report", (rig / "calib.txt").string()}, {"calib.txt: is read by this run"});
}

TEST_F(Doctor, DetectsImagesOfDifferentSizes) {
  const auto pair = pair_in("pair");
  const auto other = pair_in("other", {64, 48});
  const Outcome outcome = run({"doctor", pair[0], other[1]});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.out.find("broken   image sizes differ: the left image is 96x72, the right one 64x48"),
            std::string::npos)
      << outcome.out;
  EXPECT_EQ(outcome.out.find("measured"), std::string::npos) << outcome.out;
}

TEST_F(Doctor, DetectsPairsOfDifferentSizesInAFolder) {
  pair_in("rig/a");
  pair_in("rig/b", {128, 96});
  const Outcome outcome = run({"doctor", path("rig")});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_NE(outcome.out.find("note     image sizes differ: a is 96x72, b is 128x96"), std::string::npos)
      << outcome.out;
}

TEST_F(Doctor, DetectsANegativeBaselineAndACalibrationOfAnotherSize) {
  write(at("negative.txt"), "fx=300\nfy=300\ncx=160\ncy=120\nbaseline=-0.1\n");
  Outcome outcome = run({"doctor", sample("overlap"), "--calib", path("negative.txt")});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.out.find("broken   invalid calibration: "), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("-0.1"), std::string::npos) << outcome.out;
  write(at("large.txt"), "fx=300\nfy=300\ncx=640\ncy=480\nbaseline=0.1\nwidth=1280\nheight=960\n");
  outcome = run({"doctor", sample("overlap"), "--calib", path("large.txt")});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.out.find("the calibration is of 1280x960 images"), std::string::npos) << outcome.out;
}

TEST_F(Doctor, NamesTheBadPairsOfAFolder) {
  for (const char* name : {"one", "three", "two"}) {
    const fs::path folder = samples::folder("overlap");
    fs::create_directories(at("rig") / name);
    const bool is_swapped = name == std::string("two");
    fs::copy(folder / "left.png", at("rig") / name / (is_swapped ? "right.png" : "left.png"));
    fs::copy(folder / "right.png", at("rig") / name / (is_swapped ? "left.png" : "right.png"));
  }
  const Outcome outcome = run({"doctor", path("rig")});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.out.find("in 1 of 3 pairs (two)"), std::string::npos) << outcome.out;
}

TEST_F(Doctor, DetectsIdenticalImages) {
  const std::string picture = (samples::folder("overlap") / "left.png").string();
  const Outcome outcome = run({"doctor", picture, picture});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.out.find("broken   identical images: all pixels"), std::string::npos) << outcome.out;
}

TEST_F(Doctor, DoesNotJudgeTheOrderByAFewAccidentalMatches) {
  for (const char* name : {"four_in_a_row", "glossy_floor"}) {
    const fs::path folder = samples::folder(name);
    const Image<Gray> right = io::load_picture(folder / "right.png").gray;
    Image<Gray> mirrored(right.size());
    for (int y = 0; y < right.height(); ++y)
      std::reverse_copy(right.row(y), right.row(y) + right.width(), mirrored.row(y));
    io::save_png(at("mirrored.png"), mirrored.view());
    const Outcome outcome =
        run({"doctor", folder / "left.png", path("mirrored.png"), "--json", path("d.json")});
    EXPECT_EQ(outcome.out.find("cameras swapped"), std::string::npos) << outcome.out;
    EXPECT_NE(outcome.out.find("cannot tell  order of the cameras and disparity range: "), std::string::npos)
        << outcome.out;
    EXPECT_NE(outcome.out.find("expected 30, or 80 % of them"), std::string::npos) << outcome.out;
    EXPECT_EQ(last_line(outcome.out).find("verdict: nothing wrong found; cannot tell: order of the cameras"),
              0U)
        << outcome.out;
    const Json order = Json::parse(content(at("d.json")))["not_checked"][0];
    EXPECT_EQ(order["check"], "order of the cameras and disparity range");
    EXPECT_EQ(order["cannot_tell"], true);
    EXPECT_EQ(order["pairs"].size(), 1U);
  }
}

TEST_F(Doctor, ReportsWhatWasNotMeasured) {
  const auto pair = pair_in("pair", {24, 18});  // too small for 50 points
  const Outcome outcome = run({"doctor", pair[0], pair[1], "--json", path("d.json")});
  const std::size_t gain = outcome.out.find("gain, right to left ");
  ASSERT_NE(gain, std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.substr(gain, outcome.out.find('\n', gain) - gain).find("not measured"),
            std::string::npos)
      << outcome.out;
  const Json j = Json::parse(content(at("d.json")));
  EXPECT_TRUE(j["pairs"][0]["measured"]["gain"].is_null());
  EXPECT_TRUE(j["pairs"][0]["measured"]["brightness_difference"].is_null());
}

/// Noise that moves unevenly; from frame `lost` on the right camera is one frame late.
void write_sequence(const fs::path& folder, int frames, int lost) {
  std::mt19937 random(1);
  const Size size{120, 60};
  Image<Gray> noise({400, size.height});
  for (int y = 0; y < noise.height(); ++y) {
    for (int x = 0; x < noise.width(); ++x) noise(x, y) = static_cast<Gray>(random() % 256);
  }
  std::vector<int> places{10};
  for (int i = 0; i < frames; ++i) places.push_back(10 + static_cast<int>(random() % 200));
  for (int i = 0; i < frames; ++i) {
    const auto at = static_cast<std::size_t>(i + 1);
    const fs::path frame = folder / ("f" + std::to_string(100 + i));
    fs::create_directories(frame);
    // Only the upper rows move, more of them in some frames than in others.
    const auto cut = [&](std::size_t moment, int disparity) {
      Image<Gray> image(size);
      const int moving = 10 + places[moment] % 40;
      for (int y = 0; y < size.height; ++y)
        std::copy_n(noise.row(y) + (y < moving ? places[moment] : 50) + disparity, size.width, image.row(y));
      return image;
    };
    const Image<Gray> left = cut(at, 0);
    const Image<Gray> right = cut(i < lost ? at : at - 1, 5);
    io::save_png(frame / "left.png", left.view());
    io::save_png(frame / "right.png", right.view());
  }
}

TEST_F(Doctor, NamesTheFirstFrameOutOfSync) {
  write_sequence(at("rig"), 26, 26);
  Outcome outcome = run({"doctor", path("rig"), "--frames", "2"});
  EXPECT_EQ(outcome.out.find("not synchronised"), std::string::npos) << outcome.out;
  write_sequence(at("rig"), 26, 14);
  outcome = run({"doctor", path("rig"), "--frames", "2", "--json", path("d.json")});
  EXPECT_EQ(outcome.code, 1);
  const Json j = Json::parse(content(at("d.json")));
  const std::string from = j["synchrony"]["change"]["from"];
  EXPECT_TRUE(from == "f113" || from == "f114" || from == "f115") << from;
  EXPECT_EQ(j["synchrony"]["change"]["after"], 1);
  EXPECT_NE(outcome.out.find("from frame " + from + " on"), std::string::npos) << outcome.out;
}

TEST_F(Doctor, DetectsLateLossOfSyncInALongFolder) {
  write_sequence(at("rig"), 90, 70);
  const Outcome outcome = run({"doctor", path("rig"), "--frames", "1", "--json", path("d.json")});
  EXPECT_EQ(outcome.code, 1);
  const Json j = Json::parse(content(at("d.json")));
  const std::string from = j["synchrony"]["change"]["from"];
  EXPECT_TRUE(from == "f169" || from == "f170" || from == "f171") << from;
}

TEST_F(Doctor, NamesAnUnreadablePairAndProcessesTheOthers) {
  for (const char* name : {"a", "b", "c"}) pair_in(std::string("rig/") + name);
  write(at("rig/a/right.png"), "no image");
  const Outcome outcome = run({"doctor", path("rig"), "--json", path("d.json")});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.err.find("cairn: frame a is skipped: "), 0U) << outcome.err;
  EXPECT_NE(outcome.err.find("\ncairn: 1 of 3 frames skipped\n"), std::string::npos) << outcome.err;
  const Json j = Json::parse(content(at("d.json")));
  EXPECT_EQ(j["left_out"], Json::array({"a"}));
  EXPECT_EQ(j["pairs"].size(), 2U);
}

TEST_F(Doctor, ExplainsEveryFindingWithoutAPair) {
  const Outcome outcome = run({"doctor", "--explain"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.err, "");
  for (const FindingInfo& known : kFindings) {
    EXPECT_NE(outcome.out.find(known.name), std::string::npos) << known.name;
    EXPECT_NE(outcome.out.find(known.remedy), std::string::npos) << known.remedy;
  }
  EXPECT_NE(outcome.out.find("warn_rows"), std::string::npos);
}

TEST_F(Doctor, RefusesBadInput) {
  const auto pair = pair_in("pair");
  refuses({"doctor", path("none.png"), pair[1]}, {"none.png"});
  refuses({"doctor", pair[0]}, {"left.png", "right"});
  refuses({"doctor", pair[0], pair[1], "--calib", path("none.txt")}, {"none.txt"});
  refuses({"doctor", pair[0], pair[1], "--frames", "0"}, {"--frames"});
  refuses({"doctor", pair[0], pair[1], "--set", "match.num_disparities=0"}, {"match.num_disparities"});
  write(at("noise.txt"), "no calibration at all");
  refuses({"doctor", pair[0], pair[1], "--calib", path("noise.txt")}, {"noise.txt"});
}

using Pixels = Image<Rgb>;

Pixels clockwise(const Pixels& image) {
  Pixels result({image.height(), image.width()});
  for (int y = 0; y < result.height(); ++y)
    for (int x = 0; x < result.width(); ++x) result(x, y) = image(y, image.height() - 1 - x);
  return result;
}

std::string calibration_text(const StereoRig& rig, const io::Calibration& from) {
  return "fx=" + std::to_string(rig.focal_px) + "\nfy=" + std::to_string(rig.focal_px) +
         "\ncx=" + std::to_string(rig.cx_px) + "\ncy=" + std::to_string(rig.cy_px) +
         "\nbaseline=" + std::to_string(rig.baseline_m) +
         "\nndisp=" + std::to_string(from.num_disparities.value()) + "\n";
}

std::vector<double> distances(const std::string& objects_json) {
  std::vector<double> all;
  const Json document = Json::parse(objects_json);
  for (const Json& object : document["objects"]) all.push_back(object["position_m"].back());
  return all;
}

/// docs/use_your_own_camera.md, "Cameras one above the other": the finding names the rotation, and by the page's
/// formulas the calibration follows.
TEST_F(Doctor, AVerticalHeadIsUsableAfterTheRotationThatItNames) {
  const samples::Sample side_by_side = samples::load("four_in_a_row");
  const StereoRig rig = *side_by_side.calibration.rig;
  // The head stands upright: what was left is up.
  const Pixels upper = clockwise(side_by_side.images.left.rgb);
  const Pixels lower = clockwise(side_by_side.images.right.rgb);
  io::save_png(at("upper.png"), upper.view());
  io::save_png(at("lower.png"), lower.view());
  const Outcome vertical = run({"doctor", path("upper.png"), path("lower.png")});
  EXPECT_EQ(vertical.code, 1);
  EXPECT_NE(vertical.out.find("cameras one above the other"), std::string::npos) << vertical.out;
  EXPECT_NE(vertical.out.find("rotate both images by 90 degrees counter-clockwise"), std::string::npos);
  StereoRig upright = rig;
  upright.cx_px = static_cast<float>(side_by_side.images.left.gray.height() - 1) - rig.cy_px;
  upright.cy_px = rig.cx_px;

  // Counter-clockwise is three times clockwise; cx and cy by the page's table.
  fs::create_directories(at("turned"));
  for (const auto& [name, image] :
       {std::pair{"turned/left.png", &upper}, std::pair{"turned/right.png", &lower}}) {
    const Pixels back = clockwise(clockwise(clockwise(*image)));
    io::save_png(at(name), back.view());
  }
  StereoRig turned = upright;
  turned.cx_px = upright.cy_px;
  turned.cy_px = static_cast<float>(upper.width() - 1) - upright.cx_px;
  write(at("turned/calib.txt"), calibration_text(turned, side_by_side.calibration));
  const Outcome doctor = run({"doctor", path("turned")});
  EXPECT_EQ(doctor.code, 0) << doctor.out;
  const std::vector<double> expected = distances(run({"segment", sample("four_in_a_row"), "--json"}).out);
  ASSERT_GE(expected.size(), 4U);
  EXPECT_EQ(distances(run({"segment", path("turned"), "--json"}).out), expected);
}

TEST_F(Doctor, PortraitImagesAreSegmented) {
  const samples::Sample whole = samples::load("four_in_a_row");
  const Size size{whole.images.left.gray.width() * 5 / 8, whole.images.left.gray.height()};
  ASSERT_LT(size.width, size.height);
  fs::create_directories(at("portrait"));
  const int from = whole.images.left.gray.width() / 4;
  for (const auto& [name, image] :
       {std::pair{"left.png", &whole.images.left.rgb}, std::pair{"right.png", &whole.images.right.rgb}}) {
    Pixels part(size);
    for (int y = 0; y < size.height; ++y) std::copy_n(image->row(y) + from, size.width, part.row(y));
    io::save_png(at("portrait") / name, part.view());
  }
  StereoRig rig = *whole.calibration.rig;
  rig.cx_px -= static_cast<float>(from);
  write(at("portrait/calib.txt"), calibration_text(rig, whole.calibration));
  EXPECT_EQ(run({"doctor", path("portrait")}).code, 0);
  const Outcome outcome = run({"segment", path("portrait"), "--json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const std::vector<double> all = distances(run({"segment", sample("four_in_a_row"), "--json"}).out);
  const std::vector<double> found = distances(outcome.out);
  ASSERT_GE(found.size(), 2U);
  for (const double distance : found) {
    EXPECT_TRUE(std::ranges::any_of(all, [&](double other) {
      return std::abs(distance - other) < 0.05 * other;
    })) << distance;
  }
}

/// The two images of a pair in one.
Pixels joined(const Pixels& left, const Pixels& right, bool side_by_side) {
  const Size size = left.size();
  Pixels both(side_by_side ? Size{2 * size.width, size.height} : Size{size.width, 2 * size.height});
  for (int y = 0; y < size.height; ++y) {
    std::copy_n(left.row(y), size.width, both.row(y));
    std::copy_n(right.row(y), size.width,
                side_by_side ? both.row(y) + size.width : both.row(y + size.height));
  }
  return both;
}

TEST_F(Doctor, StillsWithBothImagesNeedTheirLayout) {
  const samples::Sample pair = samples::load("four_in_a_row");
  fs::create_directories(at("stills"));
  fs::copy_file(samples::folder("four_in_a_row") / "calib.txt", at("stills/calib.txt"));
  const std::string expected = run({"segment", sample("four_in_a_row"), "--json"}).out;
  for (const std::string layout : {"side_by_side", "top_bottom"}) {
    const Pixels both = joined(pair.images.left.rgb, pair.images.right.rgb, layout == "side_by_side");
    for (const char* name : {"stills/1.png", "stills/2.png"}) io::save_png(at(name), both.view());
    const Outcome outcome = run({"segment", path("stills/1.png"), "--layout", layout, "--json"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(Json::parse(outcome.out)["objects"], Json::parse(expected)["objects"]);
    EXPECT_EQ(run({"doctor", path("stills"), "--layout", layout}).code, 0);
    EXPECT_EQ(run({"segment", path("stills"), "--layout", layout, "-o", path("result")}).code, 0);
    EXPECT_EQ(content(at("result/2/objects.png")), content(at("result/1/objects.png")));
    EXPECT_EQ(run({"disparity", path("stills/1.png"), "--layout", layout, "-o", path("d.png")}).code, 0);
  }
  refuses({"segment", path("stills/1.png"), path("stills/2.png"), "--layout", "top_bottom"},
          {"--layout top_bottom", "stills/2.png"});
  refuses({"segment", path("stills/1.png"), "--layout", "diagonal"}, {"--layout", "diagonal", "top_bottom"});
  Pixels odd({33, 20});
  io::save_png(at("odd.png"), odd.view());
  refuses({"segment", path("odd.png"), "--layout", "side_by_side"}, {"odd.png", "is 33x20", "even width"});
}

}  // namespace
}  // namespace cairn::command
