// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <pybind11/operators.h>

#include <cairn/core/error.hpp>
#include <cairn/evaluation/disparity_error.hpp>
#include <cairn/evaluation/object_error.hpp>
#include <string>

#include "bindings.hpp"
#include "options.hpp"
#include "pickling.hpp"
#include "whole.hpp"

namespace cairn::python {
namespace {

template <class Id>
View<const Id> as_ids(View<const std::int32_t> labels) {
  return {reinterpret_cast<const Id*>(labels.data()), labels.size(), labels.stride()};
}

DisparityErrors compare_disparities(const FloatsArgument& ours_px, const FloatsArgument& truth_px,
                                    const MaskArgument& excluded, Whole leftmost) {
  const int skip_left = leftmost.value;
  const Borrowed<float> ours(ours_px, "ours_px");
  const Borrowed<float> truth(truth_px, "truth_px");
  const BorrowedMask mask(excluded, "excluded");
  expect_size(ours.size(), "ours_px", truth.size(), "truth_px");
  if (!mask.view().empty()) expect_size(mask.view().size(), "excluded", truth.size(), "truth_px");
  if (skip_left < 0) throw Error("skip_left: found " + std::to_string(skip_left) + ", expected 0 or more");
  return released([&] { return disparity_errors(ours.view(), truth.view(), mask.view(), skip_left); });
}

ObjectErrors compare_objects(const LabelsArgument& ours, const LabelsArgument& truth, Whole least_area,
                             float boundary_tolerance) {
  const int min_area = least_area.value;
  const Borrowed<std::int32_t> found(ours, "ours");
  const Borrowed<std::int32_t> known(truth, "truth");
  expect_size(found.size(), "ours", known.size(), "truth");
  if (min_area < 0 || !(boundary_tolerance >= 0 && boundary_tolerance <= 100)) {
    throw Error("object_errors: found min_area " + std::to_string(min_area) + ", boundary_tolerance " +
                std::to_string(boundary_tolerance) + ", expected at least 0, and 0 … 100");
  }
  for (int y = 0; y < found.size().height; ++y) {
    for (int x = 0; x < found.size().width; ++x) {
      if (found.view()(x, y) < 0 || known.view()(x, y) < -1) {
        throw Error("object_errors: found a negative id at x " + std::to_string(x) + ", y " +
                    std::to_string(y) + ", expected ids from 0 on (truth: -1 = don't care)");
      }
    }
  }
  return released([&] {
    return object_errors(as_ids<ObjectId>(found.view()), as_ids<TruthId>(known.view()),
                         {.min_area = min_area, .boundary_tolerance = boundary_tolerance});
  });
}

template <double (DisparityErrors::*share)(std::size_t) const>
py::dict by_threshold(const DisparityErrors& self) {
  py::dict shares;
  for (std::size_t t = 0; t < kBadThresholdsPx.size(); ++t)
    shares[py::float_(kBadThresholdsPx[t])] = (self.*share)(t);
  return shares;
}

std::string percent(double share) {
  return py::str("{:.1%}").format(share).cast<std::string>();
}

ObjectSummary summary_of(const std::vector<ObjectErrors>& frames) {
  std::vector<FrameObjects> all;
  all.reserve(frames.size());
  for (const ObjectErrors& errors : frames) all.push_back({errors, false});
  return summarise(all);
}

}  // namespace

void bind_evaluation(py::module_& m) {
  using py::literals::operator""_a;
  py::class_<DisparityErrors>(
      m, "DisparityErrors",
      "Counts over the pixels whose true disparity is known. Several frames' add up with +=.")
      .def_readonly("known", &DisparityErrors::known, "pixels with truth")
      .def_readonly("matched", &DisparityErrors::matched, "of these, pixels with a disparity of ours")
      .def_property_readonly("density", &DisparityErrors::density, "0 to 1: matched / known")
      .def_property_readonly("bad_of_matched", &by_threshold<&DisparityErrors::bad_of_matched>,
                             "by threshold in px: share of the matched that is off by more")
      .def_property_readonly("bad_of_known", &by_threshold<&DisparityErrors::bad_of_known>,
                             "the same of the known; a hole counts as bad")
      .def_property_readonly("mean_absolute_px", &DisparityErrors::mean_absolute_px,
                             "mean of |ours - truth| over the matched, px; NaN where nothing is")
      .def_property_readonly("root_mean_square_px", &DisparityErrors::root_mean_square_px,
                             "root of the mean square of the same, px; NaN where nothing is matched")
      .def_property_readonly("sigma_px", &DisparityErrors::sigma_px,
                             "the same over those that are off by 1 px at most: sigma of a right match")
      .def(py::self += py::self)
      .def("__repr__",
           [](const DisparityErrors& self) {
             return "<cairn.DisparityErrors density " + percent(self.density()) + ", off by more than 1 px " +
                    percent(self.bad_of_matched(1)) + " of the matched>";
           })
      .def(pickled<DisparityErrors>());
  py::class_<TrueObjectScore>(m, "TrueObjectScore", "How well one true object was found.")
      .def_property_readonly(
          "id", [](const TrueObjectScore& self) { return number(self.id); },
          "its number in the truth, from 1 on")
      .def_readonly("pixel_count", &TrueObjectScore::pixel_count, "its area, px")
      .def_property_readonly(
          "found", [](const TrueObjectScore& self) { return number(self.found); },
          "our object of greatest IoU; 0 = none")
      .def_readonly("iou", &TrueObjectScore::iou,
                    "0 to 1: intersection over union with `found`; 0 where nothing overlaps")
      .def_readonly("boundary_f", &TrueObjectScore::boundary_f,
                    "0 to 1: how much of both outlines lies within the tolerance of the other")
      .def_readonly("over_segmented", &TrueObjectScore::over_segmented,
                    "two or more of ours lie mostly on it and cover more than half of it")
      .def_readonly("under_segmented", &TrueObjectScore::under_segmented,
                    "more than half of it lies in one of ours that holds more than half of another, too")
      .def_property_readonly("error", &TrueObjectScore::error,
                             "the paper's E, Eq. 5: 1 / IoU - 1; inf where nothing overlaps")
      .def("__repr__",
           [](const TrueObjectScore& self) {
             return "<cairn.TrueObjectScore " + std::to_string(number(self.id)) + ": IoU " +
                    std::to_string(self.iou) + " with our " + std::to_string(number(self.found)) + ">";
           })
      .def(pickled<TrueObjectScore>());
  py::class_<FoundObjectScore>(m, "FoundObjectScore", "What became of one object of ours.")
      .def_property_readonly(
          "id", [](const FoundObjectScore& self) { return number(self.id); },
          "its number among ours, from 1 on")
      .def_readonly("pixel_count", &FoundObjectScore::pixel_count, "its area outside don't-care, px")
      .def_property_readonly(
          "best", [](const FoundObjectScore& self) { return number(self.best); },
          "the true object of greatest IoU; 0 = none")
      .def_readonly("iou", &FoundObjectScore::iou,
                    "0 to 1: intersection over union with `best`; 0 where nothing overlaps")
      .def_readonly("phantom", &FoundObjectScore::phantom, "large enough, and hardly on any true object")
      .def("__repr__",
           [](const FoundObjectScore& self) {
             return "<cairn.FoundObjectScore " + std::to_string(number(self.id)) + ": IoU " +
                    std::to_string(self.iou) + (self.phantom ? ", a phantom>" : ">");
           })
      .def(pickled<FoundObjectScore>());
  py::class_<ObjectErrors>(m, "ObjectErrors", "One frame against its truth.")
      .def_readonly("truth", &ObjectErrors::truth, "a list of TrueObjectScore")
      .def_readonly("ours", &ObjectErrors::ours, "a list of FoundObjectScore")
      .def("__repr__",
           [](const ObjectErrors& self) {
             return "<cairn.ObjectErrors " + std::to_string(self.truth.size()) + " true objects, " +
                    std::to_string(self.ours.size()) + " of ours>";
           })
      .def(pickled<ObjectErrors>());
  py::class_<ObjectSummary>(m, "ObjectSummary",
                            "Many frames as one: counts, and means over all their objects.")
      .def_readonly("frames", &ObjectSummary::frames, "how many were summarised")
      .def_readonly("true_objects", &ObjectSummary::true_objects, "that were scored")
      .def_readonly("our_objects", &ObjectSummary::our_objects, "all of ours but those mostly on don't-care")
      .def_readonly("phantoms", &ObjectSummary::phantoms, "objects of ours that hardly lie on a true one")
      .def_readonly("mean_error", &ObjectSummary::mean_error, "of the paper's E, each capped at 2; 0 is best")
      .def_readonly("median_error", &ObjectSummary::median_error, "of the same, 0 to 2")
      .def_readonly("mean_iou", &ObjectSummary::mean_iou, "over all scored objects, 0 to 1")
      .def_readonly("mean_boundary_f", &ObjectSummary::mean_boundary_f, "over all scored objects, 0 to 1")
      .def_property_readonly("recall_50", &ObjectSummary::recall_50,
                             "share of the true objects found with IoU >= 0.5")
      .def_property_readonly("precision_50", &ObjectSummary::precision_50, "share of ours with IoU >= 0.5")
      .def("__repr__",
           [](const ObjectSummary& self) {
             return "<cairn.ObjectSummary " + std::to_string(self.frames) + " frames: recall " +
                    percent(self.recall_50()) + ", precision " + percent(self.precision_50()) + ", mean E " +
                    percent(self.mean_error) + ">";
           })
      .def(pickled<ObjectSummary>());

  m.def("disparity_errors", &compare_disparities, "ours_px"_a, "truth_px"_a, "excluded"_a = py::none(),
        "skip_left"_a = 0,
        "Compares two disparity maps, (H, W) float32 in px, NaN = a hole, no truth. excluded: (H, W) uint8, "
        "pixels that are "
        "not 0 are left out; columns x < skip_left are left out, too.");
  m.def("object_errors", &compare_objects, "ours"_a, "truth"_a, "min_area"_a = ObjectErrorConfig{}.min_area,
        "boundary_tolerance"_a = ObjectErrorConfig{}.boundary_tolerance,
        "Compares a map of objects with the truth of the same size: (H, W) integers, 0 = none; truth -1 = "
        "don't care. "
        "min_area: px, smaller true objects are not scored; boundary_tolerance: % of the image's diagonal.");
  m.def("summarise", &summary_of, "frames"_a, "A summary of many frames' object_errors().");
}

}  // namespace cairn::python
