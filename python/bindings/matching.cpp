// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/matching/epipolar_correction.hpp>
#include <cairn/matching/semi_global.hpp>
#include <cairn/matching/subpixel.hpp>

#include "bindings.hpp"
#include "define.hpp"

namespace cairn::python {
namespace {

/// Two images of the same size, valid for the configuration. The source of the ground is irrelevant here.
StereoPair pair_of(const Picture& left, const Picture& right, const Call& call) {
  auto pair = StereoPair::from(left.gray(), right.gray(), left.rgb());
  Config any_ground = call.config;
  any_ground.ground = {};
  validate(any_ground, pair.size(), true);
  return pair;
}

EpipolarOffset make_offset(float rows, float rows_per_px) {
  constexpr float kMostRows = 1024;
  if (!(rows >= -kMostRows && rows <= kMostRows) || !(rows_per_px >= -1 && rows_per_px <= 1)) {
    throw Error("epipolar offset: found rows " + std::to_string(rows) + ", rows_per_px " +
                std::to_string(rows_per_px) + ", expected at most ±1024 and ±1");
  }
  return {rows, rows_per_px, 0, 0, EpipolarOutcome::corrected};
}

}  // namespace

void bind_matching(py::module_& m) {
  using py::literals::operator""_a;

  Class<EpipolarOffset>(
      m, "EpipolarOffset",
      "How far the right image's rows are off: what the left one shows in row y is in column x of "
      "the right one at row y + rows + rows_per_px * (x - (width - 1) / 2).")
      .made_by({}, "rows: -1024 to 1024; rows_per_px: -1 to 1. For shift_rows().", &make_offset,
               "rows"_a = 0.0F, "rows_per_px"_a = 0.0F)
      .shows("rows", &EpipolarOffset::rows, "rows, in the middle column")
      .shows("rows_per_px", &EpipolarOffset::rows_per_px, "tangent of the roll")
      .shows("points", &EpipolarOffset::points, "textured points found again in the right image")
      .shows("agreeing", &EpipolarOffset::agreeing, "those of them within half a row of this offset")
      .shows(
          "outcome", [](const EpipolarOffset& self) { return choice_name(self.outcome, kEpipolarOutcomes); },
          "'off', 'too few textured points', 'the points do not agree', 'aligned' or 'corrected'");
  Class<EpipolarCorrection>(m, "EpipolarCorrection", "Result of correct_epipolar().")
      .shows("offset", &EpipolarCorrection::offset, "an EpipolarOffset: what was found")
      .may_show("right", &EpipolarCorrection::right,
                "(H, W) uint8, the right image moved; None where the pair is to be matched as it is");
  Class<Matches>(
      m, "Matches",
      "Outcome of the correlation for each pixel of the left image (best_right: of the right one). Arrays "
      "(H, W), read-only; row_offset is None without match.row_band.")
      .shows("best", &Matches::best, "int16, disparity of least cost in px; NO_MATCH = none")
      .may_show("best_right", &Matches::best_right, "int16, the same seen from the right image")
      .may_show("row_offset", &Matches::row_offset, "int8, row of the match minus y")
      .shows("cost", &Matches::cost, "float32, of best; inf where there is no match")
      .may_show("runner_up", &Matches::runner_up, "float32, least cost with |d - best| > 1; inf = none")
      .may_show("mean_cost", &Matches::mean_cost, "float32, over all candidates of the pixel")
      .may_show("cost_before", &Matches::cost_before, "float32, at best - 1; inf = no such candidate")
      .may_show("cost_after", &Matches::cost_after, "float32, at best + 1; inf = no such candidate");
  m.attr("NO_MATCH") = int{kNoMatch};

  stage(
      m, "find_epipolar_offset", {"epipolar_correction", "match"},
      "Finds how far the right image's rows are off, from textured points all over it. left, right: (H, W) "
      "or (H, W, "
      "3) uint8 of one size.",
      [](const Call& call, const Picture& left, const Picture& right) {
        return find_epipolar_offset(pair_of(left, right, call), call.config.match,
                                    call.config.epipolar_correction, call.exec);
      },
      "left"_a, "right"_a);
  stage(
      m, "shift_rows", {},
      "The right image, (H, W) uint8, moved back by `offset`, so that its rows are the left one's.",
      [](const Call& call, const Picture& right, const EpipolarOffset& offset) {
        return shift_rows(right.gray(), offset, call.exec);
      },
      "right"_a, "offset"_a);
  stage(
      m, "correct_epipolar", {"epipolar_correction", "match"},
      "Both: compensates a small misalignment of the cameras, as vibration makes it, before the matching.",
      [](const Call& call, const Picture& left, const Picture& right) {
        return correct_epipolar(pair_of(left, right, call), call.config.match,
                                call.config.epipolar_correction, call.exec);
      },
      "left"_a, "right"_a);
  stage(
      m, "match", {"match", "semi_global"},
      "Matches every pixel of the left image with its candidates in the same row of the right one; the "
      "winner takes "
      "all. left, right: (H, W) or (H, W, 3) uint8 of one size, rectified: what is at (x, y) on the left is "
      "at (x - d, "
      "y) on the right.",
      [](const Call& call, const Picture& left, const Picture& right) {
        return match(pair_of(left, right, call), call.config.match, call.config.semi_global, call.exec);
      },
      "left"_a, "right"_a);
  stage(
      m, "match_windows", {"match"},
      "match() with method='window', whatever the configuration says: a square window for every pixel, on "
      "its own.",
      [](const Call& call, const Picture& left, const Picture& right) {
        return match_windows(pair_of(left, right, call), call.config.match, call.exec);
      },
      "left"_a, "right"_a);
  constexpr auto kSemiGlobal = +[](Config& config) { config.match.method = MatchMethod::semi_global; };
  define(
      m, "match_semi_global", Options{Keywords::of_stage, {"match", "semi_global"}, kSemiGlobal},
      "match() with method='semi_global', whatever the configuration says: neighbours vote along four paths "
      "(Hirschmueller 2008). Of the group match only min_disparity and num_disparities count.",
      [](const Call& call, const Picture& left, const Picture& right) {
        return match_semi_global(pair_of(left, right, call), call.config.match, call.config.semi_global,
                                 call.exec);
      },
      "left"_a, "right"_a);
  stage(
      m, "refine_subpixel", {"subpixel"},
      "Where the curve through each winner's cost and its neighbours' is lowest: (H, W) float32, px; NaN "
      "where there "
      "is no match.",
      [](const Call& call, const Matches& matches) {
        return refine_subpixel(matches, call.config.subpixel, call.exec);
      },
      "matches"_a);
}

}  // namespace cairn::python
