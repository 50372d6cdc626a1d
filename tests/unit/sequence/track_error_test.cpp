// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/core/image.hpp>
#include <cairn/sequence/track_error.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <support/collection.hpp>

namespace cairn {
namespace {

using Ids = std::vector<std::int64_t>;

/// n frames with one true object each (id 1), found under the ids in `ours`; 0 = not found.
std::vector<ScoredFrame> one_object(const Ids& ours, double similarity = 1) {
  std::vector<ScoredFrame> frames;
  for (const std::int64_t id : ours)
    frames.push_back(id == 0 ? ScoredFrame{{1}, {}, {}} : ScoredFrame{{1}, {id}, {similarity}});
  return frames;
}

TEST(TrackError, APerfectResultScoresOne) {
  const TrackErrors e = track_errors(one_object({5, 5, 5, 5}));
  for (const double share : {e.hota, e.det_a, e.det_re, e.det_pr, e.ass_a, e.ass_re, e.ass_pr, e.loc_a,
                             e.mota, e.motp, e.id_f1, e.id_precision, e.id_recall})
    EXPECT_NEAR(share, 1, 1e-12);
  EXPECT_EQ(e.right, 4);
  EXPECT_EQ(e.mostly_tracked, 1);
  EXPECT_EQ(e.switches + e.fragments + e.missed + e.wrong, 0);
}

TEST(TrackError, AnIdSwitchHalfwayHalvesTheAssociation) {
  const TrackErrors e = track_errors(one_object({5, 5, 8, 8}));
  EXPECT_NEAR(e.det_a, 1, 1e-12);
  EXPECT_NEAR(e.ass_a, 0.5, 1e-12);  // each track covers 2 of 4 frames
  EXPECT_NEAR(e.ass_re, 0.5, 1e-12);
  EXPECT_NEAR(e.ass_pr, 1, 1e-12);
  EXPECT_NEAR(e.hota, std::sqrt(0.5), 1e-12);
  EXPECT_EQ(e.switches, 1);
  EXPECT_NEAR(e.mota, 0.75, 1e-12);
  EXPECT_EQ(e.id_right, 2);
  EXPECT_EQ(e.id_missed, 2);
  EXPECT_EQ(e.id_wrong, 2);
  EXPECT_NEAR(e.id_f1, 0.5, 1e-12);
  EXPECT_EQ(e.fragments, 0);
}

TEST(TrackError, LostAndFoundUnderTheSameIdIsAFragmentAndNoSwitch) {
  // The frame without the object has another detection, since TrackEval skips frames without any.
  std::vector<ScoredFrame> frames = one_object({5, 5, 5, 5, 5});
  frames[2] = {{1}, {9}, {0.0}};
  const TrackErrors e = track_errors(frames);
  EXPECT_EQ(e.fragments, 1);
  EXPECT_EQ(e.switches, 0);
  EXPECT_EQ(e.missed, 1);
  EXPECT_EQ(e.wrong, 1);
  EXPECT_NEAR(e.mota, (4.0 - 1) / 5, 1e-12);
  EXPECT_EQ(e.partly_tracked, 1);  // 80 % is not more than 80 %
  EXPECT_NEAR(e.det_a, 4.0 / 6, 1e-12);
}

TEST(TrackError, ASwitchCountsAlsoAfterAGap) {
  EXPECT_EQ(track_errors(one_object({5, 0, 0, 8})).switches, 1);
}

TEST(TrackError, IouDecidesAtWhichThresholdsMasksCount) {
  const TrackErrors e = track_errors(one_object({5, 5}, 0.6));
  EXPECT_NEAR(e.det_a, 12.0 / 19, 1e-12);  // .05 … .60
  EXPECT_NEAR(e.motp, 0.6, 1e-12);
  EXPECT_NEAR(e.mota, 1, 1e-12);
  const TrackErrors below = track_errors(one_object({5, 5}, 0.49));
  EXPECT_NEAR(below.det_a, 9.0 / 19, 1e-12);
  EXPECT_NEAR(below.mota, -1, 1e-12);
  EXPECT_EQ(below.mostly_lost, 1);
  EXPECT_EQ(below.id_right, 0);
}

TEST(TrackError, AnEmptySideScoresZero) {
  const TrackErrors none = track_errors({{{1, 2}, {}, {}}});
  EXPECT_EQ(none.missed, 2);
  EXPECT_EQ(none.mostly_lost, 2);
  EXPECT_EQ(none.hota, 0);
  EXPECT_EQ(none.mota, 0);
  const TrackErrors phantoms = track_errors({{{}, {4}, {}}});
  EXPECT_EQ(phantoms.wrong, 1);
  EXPECT_EQ(phantoms.id_wrong, 1);
  EXPECT_EQ(phantoms.mota, 0);
  EXPECT_EQ(track_errors({}).hota, 0);
}

TEST(TrackError, AnExistingMatchIsKeptOverABetterFit) {
  // In the second frame another one fits better, but the first one still fits well enough.
  const std::vector<ScoredFrame> frames{{{1}, {5, 6}, {0.9, 0.0}}, {{1}, {5, 6}, {0.6, 0.8}}};
  EXPECT_EQ(clear_matches(frames), (std::vector<std::vector<int>>{{0}, {0}}));
  EXPECT_EQ(track_errors(frames).switches, 0);
}

/// The best sum over all assignments.
double best_sum(const std::vector<std::vector<double>>& scores, std::size_t row, std::vector<char>& taken) {
  if (row == scores.size()) return 0;
  double best = best_sum(scores, row + 1, taken);
  for (std::size_t column = 0; column < taken.size(); ++column) {
    if (taken[column] != 0) continue;
    taken[column] = 1;
    best = std::max(best, scores[row][column] + best_sum(scores, row + 1, taken));
    taken[column] = 0;
  }
  return best;
}

TEST(TrackError, TheAssignmentIsOptimal) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> similarity(0.5, 1);
  for (int round = 0; round < 200; ++round) {
    const std::size_t n = 1 + random() % 6;
    const std::size_t m = 1 + random() % 6;
    ScoredFrame frame;
    std::vector<std::vector<double>> scores(n, std::vector<double>(m));
    for (std::size_t i = 0; i < n; ++i) frame.truth.push_back(static_cast<std::int64_t>(i));
    for (std::size_t j = 0; j < m; ++j) frame.ours.push_back(static_cast<std::int64_t>(j));
    for (auto& row : scores) {
      for (double& score : row) {
        score = similarity(random);
        frame.similarity.push_back(score);
      }
    }
    std::vector<char> taken(m, 0);
    const TrackErrors e = track_errors({frame});
    EXPECT_NEAR(e.motp * e.right, best_sum(scores, 0, taken), 1e-9);
  }
}

TEST(OracleIds, TheBestMatchGetsTheTrueIdAndOthersNewOnes) {
  const std::vector<ScoredFrame> frames =
      oracle_ids({{{7, 8}, {1, 2, 3}, {0.3, 0.6, 0.0, 0.1, 0.0, 0.0}}, {{7}, {1}, {0.9}}});
  EXPECT_EQ(frames[0].ours, (Ids{-1, 7, -2}));  // the first one overlaps 7, too, but less
  EXPECT_EQ(frames[1].ours, (Ids{7}));
}

TEST(OracleIds, LeaveNoSwitch) {
  EXPECT_EQ(track_errors(oracle_ids(one_object({5, 8, 9, 5}))).switches, 0);
  EXPECT_NEAR(track_errors(oracle_ids(one_object({5, 8, 9, 5}))).ass_a, 1, 1e-12);
}

/// An image of 10×1 px.
template <class T>
Image<T> row(const std::vector<int>& values) {
  Image<T> image({static_cast<int>(values.size()), 1});
  for (std::size_t x = 0; x < values.size(); ++x) image(static_cast<int>(x), 0) = static_cast<T>(values[x]);
  return image;
}

TEST(ScoredFrame, CountsPixelsOutsideDontCare) {
  const auto ours = row<TrackId>({4, 4, 4, 4, 0, 0, 0, 9, 9, 9});
  const auto truth = row<TruthId>({1, 1, 1, 0, -1, 2, 2, 2, -1, 0});
  const ScoredFrame frame = scored_frame(ours, truth, {2, false});
  EXPECT_EQ(frame.truth, (Ids{1, 2}));
  EXPECT_EQ(frame.ours, (Ids{4, 9}));
  EXPECT_EQ(frame.similarity, (std::vector<double>{0.75, 0, 0, 0.25}));
}

TEST(ScoredFrame, IgnoresObjectsMostlyOnDontCare) {
  const auto ours = row<TrackId>({4, 4, 4, 5, 5, 6, 6, 6, 0, 0});
  // 4: two thirds on a small object; 5: half on don't-care; 6: on unlabelled pixels.
  const auto truth = row<TruthId>({1, 1, 0, -1, 3, 0, 0, 3, 3, 3});
  EXPECT_EQ(scored_frame(ours, truth, {3, false}).ours, (Ids{5, 6}));
  EXPECT_EQ(scored_frame(ours, truth, {3, true}).ours, (Ids{5}));
  EXPECT_EQ(scored_frame(ours, truth, {3, true}).truth, (Ids{3}));
}

TEST(Steadiness, CountsFragmentsWhileInView) {
  std::vector<ScoredFrame> frames = one_object({5, 0, 5, 0});  // lost at the end: not found again
  frames.push_back({{}, {}, {}});                              // out of view
  for (const ScoredFrame& frame : one_object({0, 5, 5}, 0.8)) frames.push_back(frame);
  const Steadiness s = steadiness(frames);
  EXPECT_EQ(s.object_frames, 7);
  EXPECT_EQ(s.found, 4);
  EXPECT_EQ(s.found_again, 1);
  EXPECT_EQ(s.pairs, 5);
  EXPECT_NEAR(s.iou_difference, (1 + 1 + 1 + 0.8 + 0) / 5, 1e-12);
  EXPECT_TRUE(std::isnan(steadiness({}).iou_difference));
}

TEST(SquaredMahalanobis, IsTheErrorInSigmas) {
  EXPECT_NEAR(squared_mahalanobis({0.1, 0.4, 0}, {0.01, 0, 0, 0, 0.04, 0, 0, 0, 1}), 1 + 4, 1e-12);
  // Turned by 45°: variances 2 and 1 along the diagonals.
  EXPECT_NEAR(squared_mahalanobis({1, 1, 0}, {1.5, 0.5, 0, 0.5, 1.5, 0, 0, 0, 1}), 1, 1e-12);
  EXPECT_TRUE(std::isnan(squared_mahalanobis({1, 0, 0}, {})));
  EXPECT_TRUE(std::isnan(squared_mahalanobis({1, 0, 0}, {1, 2, 0, 2, 1, 0, 0, 0, 1})));
}

// ---- TrackEval's own scores ----

using Json = nlohmann::json;

std::filesystem::path golden() {
  return collection() / "real/sequences/anchors/hota/trackeval_golden.json";
}

std::vector<ScoredFrame> frames_of(const Json& list) {
  std::vector<ScoredFrame> frames;
  for (const Json& one : list) {
    ScoredFrame frame{one.at("gt_ids"), one.at("tracker_ids"), {}};
    for (const Json& row_of_truth : one.at("similarity")) {
      for (const Json& value : row_of_truth) frame.similarity.push_back(value);
    }
    frames.push_back(std::move(frame));
  }
  return frames;
}

std::map<std::string, double> figures(const TrackErrors& e) {
  return {{"HOTA", e.hota},         {"DetA", e.det_a},     {"AssA", e.ass_a},     {"DetRe", e.det_re},
          {"DetPr", e.det_pr},      {"AssRe", e.ass_re},   {"AssPr", e.ass_pr},   {"LocA", e.loc_a},
          {"MOTA", e.mota},         {"MOTP", e.motp},      {"CLR_TP", e.right},   {"CLR_FN", e.missed},
          {"CLR_FP", e.wrong},      {"IDSW", e.switches},  {"Frag", e.fragments}, {"MT", e.mostly_tracked},
          {"PT", e.partly_tracked}, {"ML", e.mostly_lost}, {"IDF1", e.id_f1},     {"IDR", e.id_recall},
          {"IDP", e.id_precision},  {"IDTP", e.id_right},  {"IDFN", e.id_missed}, {"IDFP", e.id_wrong}};
}

TEST(TrackError, EqualsTrackEval) {
  if (!std::filesystem::exists(golden())) GTEST_SKIP() << "no scores at " << golden() << " (CAIRN_DATA)";
  const Json cases = Json::parse(std::ifstream(golden()));
  EXPECT_EQ(cases.size(), 4U);
  for (const auto& [name, one] : cases.items()) {
    std::map<std::string, double> ours = figures(track_errors(frames_of(one.at("frames"))));
    const Json& expected = one.at("expected");
    EXPECT_EQ(expected.size(), ours.size()) << name;
    for (const auto& [figure, value] : expected.items()) {
      ASSERT_TRUE(ours.contains(figure)) << figure;
      EXPECT_NEAR(ours.at(figure), value.get<double>(), 1e-4) << name << ": " << figure;
    }
  }
}

}  // namespace
}  // namespace cairn
