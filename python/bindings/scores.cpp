// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <pybind11/operators.h>

#include <atomic>
#include <cairn/diagnosis/diagnose.hpp>
#include <cairn/diagnosis/given_disparity.hpp>
#include <cairn/diagnosis/synchrony.hpp>
#include <cairn/evaluation/disparity_error.hpp>
#include <cairn/evaluation/object_error.hpp>
#include <cairn/io/dataset.hpp>
#include <cairn/io/disparity_files.hpp>
#include <cairn/output/diagnosis_json.hpp>
#include <cairn/output/tuning_json.hpp>
#include <cairn/tuning/tune.hpp>
#include <thread>

#include "bindings.hpp"
#include "frame.hpp"

namespace cairn::python {

CAIRN_MEMBERS(DisparityErrors, known, matched, _bad, _absolute_sum, _square_sum, _square_sum_within_1)
CAIRN_MEMBERS(TrueObjectScore, id, pixel_count, found, iou, boundary_f, over_segmented, under_segmented)
CAIRN_MEMBERS(FoundObjectScore, id, pixel_count, best, iou, _share_on_objects, _mostly_dont_care, phantom)
CAIRN_MEMBERS(ObjectErrors, truth, ours, _boundary_tolerance)
CAIRN_MEMBERS(ObjectSummary, frames, true_objects, _found_50, _found_75, _missed, _over_segmented,
              _under_segmented, mean_error, median_error, mean_iou, mean_boundary_f, _mean_boundary_f_found,
              _complete_frames, our_objects, _right_50, _right_75, phantoms)
CAIRN_MEMBERS(RowAlignment, _points, _offset, _slope, _agreeing, _left_over, _histogram)
CAIRN_MEMBERS(Exposure, _black, _white, _contrast, _border)
CAIRN_MEMBERS(BrightnessDifference, _points, _gain, _offset, _median)
CAIRN_MEMBERS(Sharpness, _edges, _edge)
CAIRN_MEMBERS(PairMeasures, size, identical, _textured_points, _rows, _disparities, _nearer_below,
              _vertical_rows, _brightness, _left_exposure, _right_exposure, _left_sharpness, _right_sharpness)
CAIRN_MEMBERS(LagChange, _from, _before, _after, _motion)
CAIRN_TUPLE(TuneConfig, options, budget_s, evaluations, holdout, seed)
CAIRN_MEMBERS(Synchrony, _frames, _motion, _agreement, _left_repeats, _right_repeats, _change)

namespace {

// ---- evaluation ----

template <double (DisparityErrors::*share)(std::size_t) const>
std::map<float, double> by_threshold(const DisparityErrors& self) {
  std::map<float, double> shares;
  for (std::size_t t = 0; t < kBadThresholdsPx.size(); ++t) shares[kBadThresholdsPx[t]] = (self.*share)(t);
  return shares;
}

ObjectSummary summary_of(const std::vector<ObjectErrors>& frames, bool partial) {
  std::vector<FrameObjects> all;
  for (const ObjectErrors& errors : frames) all.push_back({errors, partial});
  return summarise(all);
}

// ---- diagnosis ----

Synchrony synchrony_of(const std::vector<std::pair<const LoadedImage*, const LoadedImage*>>& pictures,
                       const Exec& exec) {
  std::vector<StereoPair> pairs;
  for (const auto& [left, right] : pictures) pairs.push_back(StereoPair::from(left->gray(), right->gray()));
  return measure_synchrony(pairs, exec);
}

/// Name, default, unit, help, lowest and highest of each limit, and whether it is a whole number.
py::list diagnosis_limits() {
  DiagnosisConfig config;
  py::list all;
  fields(config, [&](const char* name, auto& limit, const char* unit, const char* help, const auto& range) {
    all.append(py::make_tuple(name, limit, unit, help, range.lowest, range.highest,
                              std::is_integral_v<std::remove_reference_t<decltype(limit)>>));
  });
  return all;
}

std::vector<std::string> faults_of(const PairMeasures& measures, const PyCalibration& calibration,
                                   const PyConfig& config, const std::map<std::string, double>& limits) {
  calibration.check(measures.size);
  DiagnosisConfig judged;
  fields(judged, [&](const char* name, auto& limit, const auto&...) {
    const auto given = limits.find(name);
    if (given != limits.end()) limit = static_cast<std::remove_reference_t<decltype(limit)>>(given->second);
  });
  const MatchConfig range = config.suited(calibration.calibration).config.match;
  std::vector<std::string> all;
  for (const Finding& finding : diagnose(measures, calibration.rig(), range, judged))
    all.push_back(output::finding_json(finding, {}));
  return all;
}

/// Of a given disparity, compared with the pair.
std::optional<std::string> fault_of_given(const LoadedImage& left, const LoadedImage& right,
                                          const DisparityMap& map, const PyCalibration& calibration,
                                          const Exec& exec) {
  const auto finding = check_given_disparity(map.disparity_px, StereoPair::from(left.gray(), right.gray()),
                                             calibration.rig(), exec);
  return finding ? std::optional(output::finding_json(*finding, {})) : std::nullopt;
}

std::optional<std::string> fault_of(const Synchrony& measured) {
  const auto finding = diagnose(measured);
  return finding ? std::optional(output::finding_json(*finding, {})) : std::nullopt;
}

// ---- tuning ----

/// What a TuningFrame holds, of a frame's files.
py::dict read_frame(const io::FrameFiles& files, bool truth) {
  if (!files.right) throw Error(files.folder.string() + ": found no right image, expected a pair");
  py::dict made;
  io::LoadedPair pair = io::load_pair(files.left, *files.right);
  made["left"] = std::move(pair.left);
  made["right"] = std::move(pair.right);
  if (files.calib)
    made["rig"] = PyCalibration{io::load_calibration(*files.calib, files.grey_cameras), *files.calib};
  made["name"] = files.name;
  if (!truth) return made;
  const io::TruthFiles known = io::find_truth(files);
  if (known.objects) made["objects"] = io::truth_ids(io::load_labels(*known.objects));
  if (known.disparity) made["truth_px"] = io::load_disparity(*known.disparity);
  if (known.occlusion) made["hidden"] = io::load_hidden(*known.occlusion);
  made["partial"] = known.partial;
  return made;
}

/// A frame as tune() borrows it.
TuningFrame frame_of(const std::string& name, const py::object& frame, const PyConfig& config) {
  const auto& left = frame.attr("_left").cast<const LoadedImage&>();
  const auto& right = frame.attr("_right").cast<const LoadedImage&>();
  const auto& calibration = frame.attr("_calibration").cast<const PyCalibration&>();
  const auto pair = StereoPair::from(left.gray(), right.gray(), left.rgb());
  calibration.check(pair.size());
  TuningFrame made{name, pair, calibration.rig(), config.suited(calibration.calibration).config};
  made.objects = frame.attr("objects").cast<View<const TruthId>>();
  made.truth_px = frame.attr("truth_px").cast<View<const float>>();
  made.hidden = frame.attr("hidden").cast<View<const std::uint8_t>>();
  made.partial = frame.attr("partial").cast<bool>();
  return made;
}

/// Handles Ctrl-C and exceptions of progress(). KeyboardInterrupt ends the search, which keeps the best
/// result so far; other exceptions propagate to the caller.
class Interrupts {
 public:
  /// On any thread; signals reach the caller's only.
  bool asked() {
    if (std::this_thread::get_id() != caller_) return stopped_;
    const py::gil_scoped_acquire lock;
    if (PyErr_CheckSignals() != 0) take();
    return stopped_;
  }
  /// After a failed call into Python, with the GIL held.
  void take() {
    if (PyErr_ExceptionMatches(PyExc_KeyboardInterrupt) == 0) throw py::error_already_set();
    PyErr_Clear();
    stopped_ = true;
  }

 private:
  std::thread::id caller_ = std::this_thread::get_id();
  std::atomic<bool> stopped_ = false;
};

/// The command's report, and the configuration to use.
std::pair<std::string, PyConfig> tuned(const std::vector<std::pair<std::string, py::object>>& frames,
                                       const PyConfig& base, const Exec& exec, const TuneConfig& search,
                                       const py::object& progress) {
  std::vector<TuningFrame> borrowed;
  std::vector<std::string> names;
  for (const auto& [name, frame] : frames) {
    TuningFrame made = frame_of(name, frame, base);
    made.follows = !borrowed.empty() && shows_the_same(borrowed.back().pair.left(), made.pair.left());
    borrowed.push_back(std::move(made));
    names.push_back(name);
  }
  Interrupts interrupts;
  const auto tell = [&](const TuneProgress& now) {
    (void)interrupts.asked();
    constexpr std::array kGoals{"objects", "disparities", "consistency"};
    const py::gil_scoped_acquire lock;
    if (progress.is_none()) return;
    const py::dict words(py::arg("goal") = kGoals.at(static_cast<std::size_t>(now.goal)),
                         py::arg("evaluations") = now.evaluations, py::arg("seconds") = now.seconds,
                         py::arg("share") = now.share, py::arg("before") = now.before,
                         py::arg("best") = now.best);
    if (!py::reinterpret_steal<py::object>(PyObject_CallOneArg(progress.ptr(), words.ptr())))
      interrupts.take();
  };
  const Tuning found = released([&] {
    return tune(borrowed, search, exec, {[&] { return interrupts.asked(); }, tell});
  });
  if (found.before.empty()) {  // there is no best result yet
    PyErr_SetNone(PyExc_KeyboardInterrupt);
    throw py::error_already_set();
  }
  PyConfig best = base;
  best.config = with_settings(base.config, found.settings());
  for (const Setting& setting : found.settings())
    best.range_given |= setting.option == "match.num_disparities";
  return {output::tuning_json(found, names, search.seed), std::move(best)};
}

void bind_evaluation(py::module_& m) {
  auto disparities = value_class<DisparityErrors>(m, "DisparityErrors");
  disparities.def(py::self += py::self);
  shows(disparities, "density", &DisparityErrors::density);
  shows(disparities, "bad_of_matched", &by_threshold<&DisparityErrors::bad_of_matched>);
  shows(disparities, "bad_of_known", &by_threshold<&DisparityErrors::bad_of_known>);
  shows(disparities, "mean_absolute_px", &DisparityErrors::mean_absolute_px);
  shows(disparities, "root_mean_square_px", &DisparityErrors::root_mean_square_px);
  shows(disparities, "sigma_px", &DisparityErrors::sigma_px);
  auto score = value_class<TrueObjectScore>(m, "TrueObjectScore");
  shows(score, "error", &TrueObjectScore::error);
  value_class<FoundObjectScore>(m, "FoundObjectScore");
  value_class<ObjectErrors>(m, "ObjectErrors");
  auto summary = value_class<ObjectSummary>(m, "ObjectSummary");
  shows(summary, "recall_50", &ObjectSummary::recall_50);
  shows(summary, "precision_50", &ObjectSummary::precision_50);
  m.def("disparity_errors", &disparity_errors, Released());
  m.def(
      "object_errors",
      [](View<const ObjectId> ours, View<const TruthId> truth, int min_area, float tolerance) {
        return object_errors(ours, truth, {.min_area = min_area, .boundary_tolerance = tolerance});
      },
      Released());
  m.def("summarise", &summary_of);
}

void bind_diagnosis(py::module_& m) {
  auto measures = value_class<PairMeasures>(m, "PairMeasures");
  shows(measures, "disparities_px",
        [](const PairMeasures& self) { return Numbers<float>{self.disparities_px}; });
  measures.def("_disparity", &PairMeasures::disparity_px);
  measures.def("_json", &output::measures_json);
  auto synchrony = value_class<Synchrony>(m, "Synchrony");
  shows(synchrony, "tells", &Synchrony::tells);
  synchrony.def("_json", [](const Synchrony& self) { return output::synchrony_json(self, {}); });
  m.def(
      "measure_pair",
      [](const LoadedImage& left, const LoadedImage& right, const Exec& exec) {
        return measure_pair(StereoPair::from(left.gray(), right.gray()), exec);
      },
      Released());
  m.def("measure_synchrony", &synchrony_of, Released());
  m.def("diagnosis_limits", &diagnosis_limits);
  m.def("faults_of", &faults_of);
  m.def("fault_of", &fault_of);
  m.def("fault_of_given", &fault_of_given, Released());
}

void bind_tuning(py::module_& m) {
  m.def("tuning_frames", [](const std::filesystem::path& folder, bool truth) {
    std::vector<py::dict> frames;
    for (const io::FrameFiles& files : io::find_frames(folder)) frames.push_back(read_frame(files, truth));
    return frames;
  });
  const TuneConfig tuning;
  const ObjectErrorConfig scoring;
  m.attr("DEFAULTS") = py::dict(
      py::arg("budget_s") = tuning.budget_s, py::arg("evaluations") = tuning.evaluations,
      py::arg("holdout") = tuning.holdout, py::arg("seed") = tuning.seed,
      py::arg("min_area") = scoring.min_area, py::arg("boundary_tolerance") = scoring.boundary_tolerance);
  m.def("tunables", [](const std::vector<std::string>& patterns) {
    std::vector<std::string> names;
    for (const Tunable& tunable : tunables(patterns)) names.push_back(tunable.name);
    return names;
  });
  m.def("tune", &tuned);
}

}  // namespace

void bind_scores(py::module_& m) {
  bind_evaluation(m);
  bind_diagnosis(m);
  bind_tuning(m);
}

}  // namespace cairn::python
