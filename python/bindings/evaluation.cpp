// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <pybind11/operators.h>

#include <cairn/evaluation/disparity_error.hpp>
#include <cairn/evaluation/object_error.hpp>

#include "bindings.hpp"
#include "define.hpp"

namespace cairn::python {
namespace {

DisparityErrors compare_disparities(const Floats& ours_px, const Floats& truth_px, const Mask& excluded,
                                    int skip_left) {
  if (skip_left < 0) throw Error("skip_left: found " + std::to_string(skip_left) + ", expected 0 or more");
  return released(
      [&] { return disparity_errors(ours_px.view(), truth_px.view(), excluded.view(), skip_left); });
}

ObjectErrors compare_objects(const Labels& ours, const Labels& truth, int min_area,
                             float boundary_tolerance) {
  if (min_area < 0 || !(boundary_tolerance >= 0 && boundary_tolerance <= 100)) {
    throw Error("object_errors: found min_area " + std::to_string(min_area) + ", boundary_tolerance " +
                std::to_string(boundary_tolerance) + ", expected at least 0, and 0 … 100");
  }
  for (int y = 0; y < ours.size().height; ++y) {
    for (int x = 0; x < ours.size().width; ++x) {
      if (ours.view()(x, y) >= 0 && truth.view()(x, y) >= -1) continue;
      throw Error("object_errors: found a negative id at x " + std::to_string(x) + ", y " +
                  std::to_string(y) + ", expected ids from 0 on (truth: -1 = don't care)");
    }
  }
  return released([&] {
    return object_errors(ours.as<ObjectId>(), truth.as<TruthId>(),
                         {.min_area = min_area, .boundary_tolerance = boundary_tolerance});
  });
}

template <double (DisparityErrors::*share)(std::size_t) const>
std::map<float, double> by_threshold(const DisparityErrors& self) {
  std::map<float, double> shares;
  for (std::size_t t = 0; t < kBadThresholdsPx.size(); ++t) shares[kBadThresholdsPx[t]] = (self.*share)(t);
  return shares;
}

ObjectSummary summary_of(const std::vector<ObjectErrors>& frames) {
  std::vector<FrameObjects> all;
  for (const ObjectErrors& errors : frames) all.push_back({errors, false});
  return summarise(all);
}

}  // namespace

void bind_evaluation(py::module_& m) {
  using py::literals::operator""_a;
  Class<DisparityErrors>(
      m, "DisparityErrors",
      "Counts over the pixels whose true disparity is known. Several frames' add up with +=.")
      .shows("known", &DisparityErrors::known, "pixels with truth")
      .shows("matched", &DisparityErrors::matched, "of these, pixels with a disparity of ours")
      .shows("density", &DisparityErrors::density, "0 to 1: matched / known")
      .shows("bad_of_matched", &by_threshold<&DisparityErrors::bad_of_matched>,
             "by threshold in px: share of the matched pixels with a larger error")
      .shows("bad_of_known", &by_threshold<&DisparityErrors::bad_of_known>,
             "the same of the known; a hole counts as bad")
      .shows("mean_absolute_px", &DisparityErrors::mean_absolute_px,
             "mean of |ours - truth| over the matched, px; NaN where no pixel is matched")
      .shows("root_mean_square_px", &DisparityErrors::root_mean_square_px,
             "root of the mean square of the same, px; NaN where no pixel is matched")
      .shows("sigma_px", &DisparityErrors::sigma_px,
             "the same over errors of at most 1 px: sigma of a correct match")
      .def(py::self += py::self);
  Class<TrueObjectScore>(m, "TrueObjectScore", "How well one true object was found.")
      .shows("id", &TrueObjectScore::id, "its number in the truth, from 1 on")
      .shows("pixel_count", &TrueObjectScore::pixel_count, "its area, px")
      .shows("found", &TrueObjectScore::found, "our object of greatest IoU; 0 = none")
      .shows("iou", &TrueObjectScore::iou,
             "0 to 1: intersection over union with `found`; 0 where they do not overlap")
      .shows("boundary_f", &TrueObjectScore::boundary_f,
             "0 to 1: how much of both outlines lies within the tolerance of the other")
      .shows("over_segmented", &TrueObjectScore::over_segmented,
             "two or more of ours lie mostly on it and cover more than half of it")
      .shows("under_segmented", &TrueObjectScore::under_segmented,
             "more than half of it lies in one of ours that holds more than half of another, too")
      .shows("error", &TrueObjectScore::error,
             "the paper's E, Eq. 5: 1 / IoU - 1; inf where they do not overlap");
  Class<FoundObjectScore>(m, "FoundObjectScore", "How well one object of ours lies on a true one.")
      .shows("id", &FoundObjectScore::id, "its number among ours, from 1 on")
      .shows("pixel_count", &FoundObjectScore::pixel_count, "its area outside don't-care, px")
      .shows("best", &FoundObjectScore::best, "the true object of greatest IoU; 0 = none")
      .shows("iou", &FoundObjectScore::iou,
             "0 to 1: intersection over union with `best`; 0 where they do not overlap")
      .shows("phantom", &FoundObjectScore::phantom, "large enough, and hardly on any true object");
  Class<ObjectErrors>(m, "ObjectErrors", "One frame against its truth.")
      .shows("truth", &ObjectErrors::truth, "a list of TrueObjectScore")
      .shows("ours", &ObjectErrors::ours, "a list of FoundObjectScore");
  Class<ObjectSummary>(m, "ObjectSummary", "Many frames as one: counts, and means over all their objects.")
      .shows("frames", &ObjectSummary::frames, "number of frames")
      .shows("true_objects", &ObjectSummary::true_objects, "that were scored")
      .shows("our_objects", &ObjectSummary::our_objects, "all of ours but those mostly on don't-care")
      .shows("phantoms", &ObjectSummary::phantoms, "reported objects that hardly overlap a true one")
      .shows("mean_error", &ObjectSummary::mean_error, "of the paper's E, each capped at 2; 0 is best")
      .shows("median_error", &ObjectSummary::median_error, "of the same, 0 to 2")
      .shows("mean_iou", &ObjectSummary::mean_iou, "over all scored objects, 0 to 1")
      .shows("mean_boundary_f", &ObjectSummary::mean_boundary_f, "over all scored objects, 0 to 1")
      .shows("recall_50", &ObjectSummary::recall_50, "share of the true objects found with IoU >= 0.5")
      .shows("precision_50", &ObjectSummary::precision_50, "share of ours with IoU >= 0.5");

  define(m, "disparity_errors",
         "Compares two disparity maps, (H, W) float32 in px, NaN = a hole, no truth. excluded: (H, W) uint8, "
         "pixels that "
         "are not 0 are left out; columns x < skip_left are left out, too.",
         &compare_disparities, "ours_px"_a, "truth_px"_a, "excluded"_a = py::none(), "skip_left"_a = 0);
  define(m, "object_errors",
         "Compares a map of objects with the truth of the same size: (H, W) integers, 0 = none; truth -1 = "
         "don't care. "
         "min_area: px, smaller true objects are not scored; boundary_tolerance: % of the image's diagonal.",
         &compare_objects, "ours"_a, "truth"_a, "min_area"_a = ObjectErrorConfig{}.min_area,
         "boundary_tolerance"_a = ObjectErrorConfig{}.boundary_tolerance);
  define(m, "summarise", "A summary of many frames' object_errors().", &summary_of, "frames"_a);
}

}  // namespace cairn::python
