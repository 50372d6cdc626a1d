// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/error.hpp>
#include <cairn/matching/epipolar_correction.hpp>
#include <cairn/matching/semi_global.hpp>
#include <cairn/matching/subpixel.hpp>
#include <string>

#include "bindings.hpp"
#include "options.hpp"
#include "pickling.hpp"

namespace cairn::python {
namespace {

/// Two pictures of one size. Where the ground comes from is no affair of theirs.
struct Pair {
  Picture left;
  Picture right;
  StereoPair pair;

  Pair(const ImageArgument& l, const ImageArgument& r, bool bgr, const Config& config, const Exec& exec)
      : left(l, "left", bgr, exec.pool),
        right(r, "right", bgr, exec.pool),
        pair(StereoPair::from(left.gray(), right.gray(), left.rgb())) {
    Config any_ground = config;
    any_ground.ground = {};
    validate(any_ground, pair.size(), true);
  }
};

EpipolarOffset find_offset(const Config& config, const Exec& exec, const ImageArgument& left,
                           const ImageArgument& right, bool bgr) {
  const Pair in(left, right, bgr, config, exec);
  return released(
      [&] { return find_epipolar_offset(in.pair, config.match, config.epipolar_correction, exec); });
}

EpipolarCorrection correct(const Config& config, const Exec& exec, const ImageArgument& left,
                           const ImageArgument& right, bool bgr) {
  const Pair in(left, right, bgr, config, exec);
  return released([&] { return correct_epipolar(in.pair, config.match, config.epipolar_correction, exec); });
}

Matches match_pair(const Config& config, const Exec& exec, const ImageArgument& left,
                   const ImageArgument& right, bool bgr) {
  const Pair in(left, right, bgr, config, exec);
  return released([&] { return match(in.pair, config.match, config.semi_global, exec); });
}

Matches match_by_windows(const Config& config, const Exec& exec, const ImageArgument& left,
                         const ImageArgument& right, bool bgr) {
  const Pair in(left, right, bgr, config, exec);
  return released([&] { return match_windows(in.pair, config.match, exec); });
}

Matches match_along_paths(const Config& config, const Exec& exec, const ImageArgument& left,
                          const ImageArgument& right, bool bgr) {
  const Pair in(left, right, bgr, config, exec);
  return released([&] { return match_semi_global(in.pair, config.match, config.semi_global, exec); });
}

ArrayOf<Gray> shift(const Config&, const Exec& exec, const ImageArgument& right, const EpipolarOffset& offset,
                    bool bgr) {
  const Picture in(right, "right", bgr, exec.pool);
  return array_from(released([&] { return shift_rows(in.gray(), offset, exec); }));
}

ArrayOf<float> refine(const Config& config, const Exec& exec, const Matches& matches) {
  return array_from(released([&] { return refine_subpixel(matches, config.subpixel, exec); }));
}

std::string outcome(const EpipolarOffset& self) {
  return std::string(kEpipolarOutcomes.at(static_cast<std::size_t>(self.outcome)).name);
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

  py::class_<EpipolarOffset>(
      m, "EpipolarOffset",
      "How far the right picture's rows are off: what the left one shows in row y stands in "
      "column x of the right one at row y + rows + rows_per_px * (x - (width - 1) / 2).")
      .def(py::init(&make_offset), "rows"_a = 0.0F, "rows_per_px"_a = 0.0F,
           "rows: -1024 to 1024; rows_per_px: -1 to 1. For shift_rows().")
      .def_readonly("rows", &EpipolarOffset::rows, "rows, in the middle column")
      .def_readonly("rows_per_px", &EpipolarOffset::rows_per_px, "tangent of the roll")
      .def_readonly("points", &EpipolarOffset::points, "textured points found again in the right picture")
      .def_readonly("agreeing", &EpipolarOffset::agreeing, "those of them within half a row of this offset")
      .def_property_readonly(
          "outcome", &outcome,
          "'off', 'too few textured points', 'the points do not agree', 'aligned' or 'corrected'")
      .def("__repr__",
           [](const EpipolarOffset& self) {
             return "<cairn.EpipolarOffset " + outcome(self) + ": " + std::to_string(self.rows) + " rows, " +
                    std::to_string(self.rows_per_px) + " rows per px, " + std::to_string(self.agreeing) +
                    " of " + std::to_string(self.points) + " points agree>";
           })
      .def(pickled<EpipolarOffset>());
  py::class_<EpipolarCorrection>(m, "EpipolarCorrection", "What correct_epipolar() makes.")
      .def_readonly("offset", &EpipolarCorrection::offset, "an EpipolarOffset: what was found")
      .def_property_readonly(
          "right", shown(&EpipolarCorrection::right),
          "(H, W) uint8, the right picture moved; None where the pair is to be matched as it is")
      .def("__repr__",
           [](const EpipolarCorrection& self) {
             return "<cairn.EpipolarCorrection " + outcome(self.offset) +
                    (self.right.empty() ? ", the pair as it is>" : ", the right picture moved>");
           })
      .def(pickled<EpipolarCorrection>());

  py::class_<Matches>(m, "Matches",
                      "The outcome of correlation for each pixel of the left picture (best_right: of the "
                      "right one). Arrays (H, W), "
                      "read-only; row_offset is None without match.row_band.")
      .def_property_readonly("best", always_shown(&Matches::best),
                             "int16, disparity of least cost in px; NO_MATCH = none")
      .def_property_readonly("best_right", shown(&Matches::best_right),
                             "int16, the same seen from the right picture")
      .def_property_readonly("row_offset", shown(&Matches::row_offset), "int8, row of the match minus y")
      .def_property_readonly("cost", always_shown(&Matches::cost),
                             "float32, of best; inf where there is no match")
      .def_property_readonly("runner_up", shown(&Matches::runner_up),
                             "float32, least cost with |d - best| > 1; inf = none")
      .def_property_readonly("mean_cost", shown(&Matches::mean_cost),
                             "float32, over all candidates of the pixel")
      .def_property_readonly("cost_before", shown(&Matches::cost_before),
                             "float32, at best - 1; inf = no such candidate")
      .def_property_readonly("cost_after", shown(&Matches::cost_after),
                             "float32, at best + 1; inf = no such candidate")
      .def("__repr__", [](const Matches& self) { return "<cairn.Matches " + text(self.best.size()) + ">"; })
      .def(pickled<Matches>());
  m.attr("NO_MATCH") = int{kNoMatch};

  def_stage(m, "find_epipolar_offset", {"epipolar_correction", "match"},
            "Finds how far the right picture's rows are off, from textured points all over it. left, right: "
            "(H, W) or "
            "(H, W, 3) uint8 of one size.",
            &find_offset, "left"_a, "right"_a, py::kw_only(), "bgr"_a = false);
  def_stage(m, "shift_rows", {},
            "The right picture, (H, W) uint8, moved back by `offset`, so that its rows are the left one's.",
            &shift, "right"_a, "offset"_a, py::kw_only(), "bgr"_a = false);
  def_stage(
      m, "correct_epipolar", {"epipolar_correction", "match"},
      "Both: compensates a small misalignment of the cameras, as vibration makes it, before the matching.",
      &correct, "left"_a, "right"_a, py::kw_only(), "bgr"_a = false);
  def_stage(m, "match", {"match", "semi_global"},
            "Matches every pixel of the left picture with its candidates in the same row of the right one; "
            "the winner "
            "takes all. left, right: (H, W) or (H, W, 3) uint8 of one size, rectified: what stands at (x, y) "
            "on the left "
            "stands at (x - d, y) on the right.",
            &match_pair, "left"_a, "right"_a, py::kw_only(), "bgr"_a = false);
  def_stage(m, "match_windows", {"match"},
            "match() with method='window', whatever the configuration says: a square window for every pixel, "
            "on its own.",
            &match_by_windows, "left"_a, "right"_a, py::kw_only(), "bgr"_a = false);
  def_stage(
      m, "match_semi_global", {"match", "semi_global"},
      +[](Config& config) { config.match.method = MatchMethod::semi_global; },
      "match() with method='semi_global', whatever the configuration says: neighbours vote along four paths "
      "(Hirschmueller 2008). Of the group match only min_disparity and num_disparities count.",
      &match_along_paths, "left"_a, "right"_a, py::kw_only(), "bgr"_a = false);
  def_stage(m, "refine_subpixel", {"subpixel"},
            "Where the curve through each winner's cost and its neighbours' is lowest: (H, W) float32, px; "
            "NaN where "
            "there is no match.",
            &refine, "matches"_a, py::kw_only());
}

}  // namespace cairn::python
