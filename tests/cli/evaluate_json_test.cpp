// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "command.hpp"

namespace cairn::command {
namespace {

using Json = nlohmann::json;

constexpr Size kSize{96, 72};

std::string text_of(const char* format, const Json& value, double factor = 1) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), format, factor * value.get<double>());
  return text.data();
}

std::string percent(const Json& share) {
  return text_of("%.1f %%", share, 100);
}

void fill(Image<std::uint16_t>& image, Rect box, std::uint16_t value) {
  for (int y = box.y; y < box.y + box.height; ++y) std::fill_n(image.row(y) + box.x, box.width, value);
}

/// Frame a: one true object of two found, a phantom, disparities with truth and occlusion. Frame b: partial
/// truth, found exactly. Frame c: no result.
class EvaluateJson : public CommandTest {
 protected:
  void SetUp() override {
    for (const char* name : {"truth/a", "truth/b", "truth/c", "result/a", "result/b"})
      fs::create_directories(at(name));
    write_objects_of_a();
    write_disparities_of_a();
    Image<std::uint16_t> ids(kSize, 0, {});
    fill(ids, {20, 20, 20, 20}, 3);
    save("truth/b/objects.png", ids);
    save("truth/c/objects.png", ids);
    write(at("truth/b/partial"), "");
    fill(ids, {20, 20, 20, 20}, 5);
    save("result/b/objects.png", ids);
    write(at("result/a/objects.json"),
          R"({"timings_ms": {"match": 10, "check": 2.5},
              "objects": [{"id": 1, "confidence": 0.9}, {"id": 2, "confidence": 0.85}]})");
    write(at("result/b/objects.json"),
          R"({"timings_ms": {"match": 20}, "objects": [{"id": 5, "confidence": 0.95}]})");
  }

  void save(const std::string& name, const Image<std::uint16_t>& image) const {
    io::save_png(at(name), image.view());
  }

  [[nodiscard]] std::vector<std::string> arguments(const std::string& file) const {
    return {"evaluate", path("result"), path("truth"), "--json", file};
  }

  /// The output files of the command, and its printed output.
  [[nodiscard]] std::pair<Json, std::string> evaluated() const {
    const Outcome outcome = run(arguments(path("all.json")));
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    return {Json::parse(content(at("all.json"))), outcome.out};
  }

 private:
  void write_objects_of_a() const {
    Image<std::uint16_t> ids(kSize, 0, {});
    fill(ids, {10, 10, 30, 30}, 1);
    fill(ids, {50, 10, 30, 50}, 7);
    save("truth/a/objects.png", ids);
    ids = Image<std::uint16_t>(kSize, 0, {});
    fill(ids, {10, 10, 30, 24}, 1);  // four fifths of the true object
    fill(ids, {10, 45, 30, 20}, 2);  // on no object
    save("result/a/objects.png", ids);
  }

  /// Upper half: correct. Lower half, hidden from the right camera: an error of 3 px, then a hole.
  void write_disparities_of_a() const {
    Image<std::uint16_t> disparity(kSize, 6 * 256, {});
    save("truth/a/disp_left.png", disparity);
    fill(disparity, {0, 36, 48, 36}, 9 * 256);
    fill(disparity, {48, 36, 48, 36}, 0);
    save("result/a/disparity.png", disparity);
    Image<std::uint8_t> occlusion(kSize, 0, {});
    for (int y = 36; y < 72; ++y) std::fill_n(occlusion.row(y), 96, std::uint8_t{255});
    io::save_png(at("truth/a/occlusion.png"), occlusion.view());
  }
};

TEST_F(EvaluateJson, ReportsTheScoreOfEachObject) {
  const Json frames = evaluated().first.at("frames");
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[0].at("name"), "a");
  const Json& a = frames[0].at("objects");
  EXPECT_EQ(a.at("partial"), false);
  EXPECT_EQ(a.at("counts"), Json::parse(R"({"scored": 2, "found_50": 1, "found_75": 1, "ours": 2,
                                            "right_50": 1, "right_75": 1, "phantoms": 1})"));
  ASSERT_EQ(a.at("true").size(), 2U);
  const Json& found = a.at("true")[0];
  EXPECT_EQ(found.at("id"), 1);
  EXPECT_EQ(found.at("area_px"), 900);
  EXPECT_EQ(found.at("ours"), 1);
  EXPECT_DOUBLE_EQ(found.at("iou"), 0.8);
  EXPECT_DOUBLE_EQ(found.at("error"), 0.25);
  // Boundaries of 116 and 104 px; 78 of each are within 1 px of the other.
  EXPECT_NEAR(found.at("boundary_f"), 2.0 * 78 / (116 + 104), 1e-9);
  const Json& missed = a.at("true")[1];
  EXPECT_EQ(missed.at("id"), 7);
  EXPECT_EQ(missed.at("area_px"), 1500);
  EXPECT_TRUE(missed.at("ours").is_null());
  EXPECT_TRUE(missed.at("error").is_null());  // infinite
  EXPECT_EQ(missed.at("iou"), 0);
  ASSERT_EQ(a.at("ours").size(), 2U);
  EXPECT_EQ(a.at("ours")[0].at("true"), 1);
  EXPECT_EQ(a.at("ours")[0].at("phantom"), false);
  EXPECT_DOUBLE_EQ(a.at("ours")[0].at("confidence"), 0.9);
  EXPECT_TRUE(a.at("ours")[1].at("true").is_null());
  EXPECT_EQ(a.at("ours")[1].at("phantom"), true);

  const Json& b = frames[1].at("objects");
  EXPECT_EQ(b.at("partial"), true);
  EXPECT_EQ(b.at("true")[0].at("ours"), 5);
  EXPECT_EQ(b.at("true")[0].at("error"), 0);
  EXPECT_EQ(b.at("counts").at("ours"), 1);
  EXPECT_TRUE(b.at("counts").at("right_50").is_null());  // undefined for a partial truth
  EXPECT_TRUE(b.at("counts").at("phantoms").is_null());
}

TEST_F(EvaluateJson, ReportsDisparityErrorsAndTheirPixels) {
  const Json whole = evaluated().first;
  const Json& a = whole.at("frames")[0].at("disparity");
  const Json& all = a.at("all");
  EXPECT_EQ(all.at("known_px"), 96 * 72);
  EXPECT_EQ(all.at("matched_px"), 96 * 54);
  EXPECT_DOUBLE_EQ(all.at("density"), 0.75);
  EXPECT_DOUBLE_EQ(all.at("bad_of_matched").at("0.5"), 1.0 / 3);
  EXPECT_DOUBLE_EQ(all.at("bad_of_matched").at("2"), 1.0 / 3);
  EXPECT_DOUBLE_EQ(all.at("bad_of_matched").at("4"), 0);
  EXPECT_DOUBLE_EQ(all.at("bad_of_known").at("1"), 0.5);
  EXPECT_DOUBLE_EQ(all.at("bad_of_known").at("4"), 0.25);
  EXPECT_DOUBLE_EQ(all.at("mean_absolute_px"), 1);
  EXPECT_DOUBLE_EQ(all.at("root_mean_square_px"), std::sqrt(3.0));
  EXPECT_DOUBLE_EQ(all.at("sigma_px"), 0);
  EXPECT_EQ(a.at("both_cameras").at("known_px"), 96 * 36);
  EXPECT_DOUBLE_EQ(a.at("both_cameras").at("bad_of_known").at("1"), 0);
  EXPECT_TRUE(whole.at("frames")[1].at("disparity").is_null());
  EXPECT_EQ(whole.at("summary").at("disparity").at("frames"), 1);
  EXPECT_EQ(whole.at("summary").at("disparity").at("all"), all);
}

TEST_F(EvaluateJson, ReportsTheTimesInTheResults) {
  const Json whole = evaluated().first;
  EXPECT_EQ(whole.at("frames")[0].at("timings_ms"), Json::parse(R"({"match": 10.0, "check": 2.5})"));
  EXPECT_EQ(whole.at("summary").at("timings_ms"),
            Json::parse(R"({"frames": 2, "total": {"mean": 16.25, "median": 16.25},
                            "stages": {"match": {"mean": 15.0, "median": 15.0},
                                       "check": {"mean": 2.5, "median": 2.5}}})"));
  fs::remove(at("result/a/objects.json"));
  write(at("result/b/objects.json"), R"({"objects": []})");
  const Json without = evaluated().first;
  EXPECT_TRUE(without.at("frames")[0].at("timings_ms").is_null());
  EXPECT_TRUE(without.at("summary").at("timings_ms").is_null());
  EXPECT_TRUE(without.at("summary").at("objects").at("confident").is_null());
}

TEST_F(EvaluateJson, AgreesWithTheTable) {
  const auto [whole, table] = evaluated();
  EXPECT_EQ(table, run({"evaluate", path("result"), path("truth")}).out);
  const auto prints = [&printed = table](const std::string& text) {
    EXPECT_NE(printed.find(text), std::string::npos) << "no '" << text << "' in\n" << printed;
  };
  const Json& s = whole.at("summary").at("objects");
  prints("objects             " + s.at("scored").dump() + " true ones of at least " +
         whole.at("options").at("min_area_px").dump() + " px in " + s.at("frames").dump() + " frames");
  prints("found               IoU >= 0.5: " + percent(s.at("recall_50")) +
         "   IoU >= 0.75: " + percent(s.at("recall_75")));
  prints("precision           IoU >= 0.5: " + percent(s.at("precision_50")) + "   IoU >= 0.75: " +
         percent(s.at("precision_75")) + "   of " + s.at("ours").dump() + " reported objects");
  prints("phantoms            " + text_of("%.2f", s.at("phantoms_per_frame")));
  prints("E                   mean " + percent(s.at("mean_error")) + "   median " +
         percent(s.at("median_error")));
  prints("; " + s.at("at_error_cap").dump() + " reach that");
  prints("IoU                 mean " + text_of("%.3f", s.at("mean_iou")));
  prints("boundary F          mean " + text_of("%.3f", s.at("mean_boundary_f")) + "   of those found " +
         text_of("%.3f", s.at("mean_boundary_f_found")));
  prints("over: " + s.at("over_segmented").dump() + "   under: " + s.at("under_segmented").dump());
  const Json& confident = s.at("confident");
  prints("confidence >= 0.8   " + confident.at("ours").dump() + " reported objects, " +
         percent(confident.at("precision_50")));
  for (const char* pixels : {"both_cameras", "all"}) {
    const Json& d = whole.at("summary").at("disparity").at(pixels);
    prints("density           " + percent(d.at("density")) + " of " + d.at("known_px").dump() + " pixels");
    prints("bad-0.5 " + percent(d.at("bad_of_matched").at("0.5")) + "   bad-1 " +
           percent(d.at("bad_of_matched").at("1")));
    prints("with holes        bad-0.5 " + percent(d.at("bad_of_known").at("0.5")));
    prints("mean " + text_of("%.3f px", d.at("mean_absolute_px")) + "   RMS " +
           text_of("%.3f px", d.at("root_mean_square_px")) + "   within 1 px RMS " +
           text_of("%.3f px", d.at("sigma_px")));
  }
  EXPECT_EQ(whole.at("without_result"), Json({"c"}));
  // Also checks the summary's numbers, in case both were wrong in the same way.
  EXPECT_DOUBLE_EQ(s.at("recall_50"), 2.0 / 3);
  EXPECT_DOUBLE_EQ(s.at("precision_50"), 0.5);
  EXPECT_DOUBLE_EQ(s.at("mean_error"), 0.75);
  EXPECT_DOUBLE_EQ(s.at("median_error"), 0.25);
  EXPECT_EQ(confident, Json::parse(R"({"at_least": 0.8, "ours": 2, "right_50": 1, "precision_50": 0.5})"));
}

TEST_F(EvaluateJson, WritesNullForUnknownValues) {
  fs::remove_all(at("result/a"));
  const Json s = evaluated().first.at("summary").at("objects");
  for (const char* key : {"ours", "right_50", "precision_50", "phantoms", "phantoms_per_frame", "confident"})
    EXPECT_TRUE(s.at(key).is_null()) << key;
  EXPECT_EQ(s.at("recall_50"), 1);
  fs::remove(at("truth/b/partial"));
  save("truth/b/objects.png", Image<std::uint16_t>(kSize, 0, {}));
  const Json whole = evaluated().first;
  for (const char* key : {"recall_50", "mean_error", "median_error", "mean_iou", "mean_boundary_f"})
    EXPECT_TRUE(whole.at("summary").at("objects").at(key).is_null()) << key;
  EXPECT_TRUE(whole.at("summary").at("disparity").is_null());
  fs::remove(at("truth/b/objects.png"));
  fs::rename(at("result/b/objects.png"), at("result/b/disparity.png"));
  save("truth/b/disp_left.png", Image<std::uint16_t>(kSize, 0, {}));
  const Json nothing = evaluated().first;
  EXPECT_TRUE(nothing.at("summary").at("objects").is_null());
  EXPECT_TRUE(nothing.at("frames")[0].at("disparity").at("all").at("density").is_null());
  EXPECT_TRUE(nothing.at("frames")[0].at("disparity").at("both_cameras").is_null());  // no occlusion.png
}

TEST_F(EvaluateJson, ReplacesAnOlderFileAndLeavesNoTemporary) {
  write(at("all.json"), "old");
  const auto before = everything();
  const Json first = evaluated().first;
  EXPECT_EQ(everything(), before);
  EXPECT_EQ(evaluated().first, first);
}

TEST_F(EvaluateJson, IsWrittenForAFolderWithANonTextName) {
  fs::rename(at("result/a"), at("result/\xff"));
  fs::rename(at("truth/a"), at("truth/\xff"));
  EXPECT_EQ(evaluated().first.at("frames").size(), 2U);
}

TEST_F(EvaluateJson, NamesSkippedFrames) {
  for (const char* json : {"{", R"({"objects": [], "timings_ms": {"match": "soon"}})", "[]"}) {
    write(at("result/b/objects.json"), json);
    const Outcome outcome = run(arguments(path("new.json")));
    EXPECT_EQ(outcome.code, 2);
    EXPECT_NE(outcome.err.find("objects.json"), std::string::npos) << outcome.err;
    const Json j = Json::parse(content(at("new.json")));
    EXPECT_EQ(j["left_out"], Json::array({"b"}));
    EXPECT_EQ(j["frames"].size(), 1U);
  }
}

// ---- comparison of runs ----

/// Cells of a CSV without quotes, row by row, by the names in its first line.
std::vector<std::map<std::string, std::string>> rows_of(const std::string& csv) {
  const auto split = [](const std::string& text, char at) {
    std::vector<std::string> parts;
    std::istringstream in(text);
    for (std::string part; std::getline(in, part, at);) parts.push_back(part);
    return parts;
  };
  const auto lines = split(csv, '\n');
  const auto names = split(lines.at(0), ',');
  std::vector<std::map<std::string, std::string>> rows;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const auto cells = split(lines[i] + ",.", ',');  // so that an empty last cell counts
    EXPECT_EQ(cells.size(), names.size() + 1) << lines[i];
    rows.emplace_back();
    for (std::size_t c = 0; c < names.size(); ++c) rows.back()[names[c]] = cells.at(c);
  }
  return rows;
}

TEST_F(EvaluateJson, EachRunIsARowWithTheSameNumbers) {
  fs::create_directories(at("other/b"));
  fs::copy(at("result/b"), at("other/b"));
  const Outcome outcome =
      run({"evaluate", path("result"), path("other"), path("truth"), "--csv", path("runs.csv")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto rows = rows_of(content(at("runs.csv")));
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].at("run"), path("result"));
  EXPECT_EQ(rows[1].at("run"), path("other"));
  const Json summary = evaluated().first.at("summary");
  EXPECT_EQ(rows[0].at("objects.recall_50"), summary.at("objects").at("recall_50").dump());
  EXPECT_EQ(rows[0].at("objects.confident.precision_50"),
            summary.at("objects").at("confident").at("precision_50").dump());
  EXPECT_EQ(rows[0].at("disparity.both_cameras.bad_of_matched.1"),
            summary.at("disparity").at("both_cameras").at("bad_of_matched").at("1").dump());
  EXPECT_EQ(rows[0].at("timings_ms.total.median"), summary.at("timings_ms").at("total").at("median").dump());
  // With partial truth and no disparity everything is unknown.
  EXPECT_EQ(rows[1].at("objects.frames"), "1");
  EXPECT_EQ(rows[1].at("objects.recall_50"), "1.0");
  EXPECT_EQ(rows[1].at("objects.precision_50"), "");
  EXPECT_EQ(rows[1].at("disparity.all.density"), "");
  for (const std::string& text :
       {std::string("run "), path("other"), std::string("66.7"), std::string("100.0"),
        "not the same frames in " + path("result") + " and " + path("other")})
    EXPECT_NE(outcome.out.find(text), std::string::npos) << text << "\n" << outcome.out;
}

TEST_F(EvaluateJson, ASingleRunIsARowOfCsvToo) {
  fs::rename(at("result"), at("with, comma"));
  const Outcome outcome = run({"evaluate", path("with, comma"), path("truth"), "--csv", path("one.csv")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("boundary F"), std::string::npos);  // the table of one run, as ever
  const std::string csv = content(at("one.csv"));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 2);
  EXPECT_NE(csv.find("\n\"" + path("with, comma") + "\",2,"), std::string::npos) << csv;
}

TEST_F(EvaluateJson, SeveralRunsHaveNeitherAPageNorAJson) {
  refuses({"evaluate", path("result"), path("result"), path("truth"), "--json", path("all.json")},
          {"--json", "one run", "2", "--csv"});
  refuses({"evaluate", path("result"), path("result"), path("truth"), "--html", path("page")}, {"--html"});
  refuses({"evaluate", path("result"), path("missing"), path("truth"), "--csv", path("runs.csv")},
          {"missing"});
}

TEST_F(EvaluateJson, IsNotWrittenForBadInput) {
  fs::remove_all(at("result/a"));
  write(at("old.json"), "old");
  const auto refuses_both = [this](const std::vector<std::string>& words) {
    refuses(arguments(path("new.json")), words);
    refuses(arguments(path("old.json")), words);
    EXPECT_EQ(content(at("old.json")), "old");
  };
  for (const char* json : {"{", R"({"objects": [], "timings_ms": {"match": "soon"}})", "[]"}) {
    write(at("result/b/objects.json"), json);
    refuses_both({"objects.json"});
  }
  save("result/b/objects.png", Image<std::uint16_t>({95, 72}, 1, {}));
  refuses_both({"96x72", "95x72"});
  fs::remove_all(at("truth/b"));
  refuses_both({"truth/b"});
}

TEST_F(EvaluateJson, RefusesAFileThatCannotBeWritten) {
  refuses(arguments(path("missing/all.json")), {"missing/all.json", "cannot be written"});
  refuses(arguments(path("truth")), {"truth", "cannot be written"});
  refuses(arguments(path("truth/a/objects.png/all.json")), {"cannot be written"});
  refuses(arguments("/dev/full"), {"/dev/full", "cannot be written"});
  refuses({"evaluate", path("result"), path("truth"), "--json"}, {"--json"});
}

}  // namespace
}  // namespace cairn::command
